#include "common/robot_ice/base_parameters.h"

#include <string>

#include "common/geometry/angles.h"

namespace vismem {

void listBaseParameters(ParameterTable& table, const MobileBase& base,
                        const std::shared_ptr<BaseServant>& servant) {
  const BaseLimits limits = base.limits();
  if (limits.max_speed_mps > 0.0) {
    table.add({"Base.MaximumSpeed_mps", "m/s", 0.0, limits.max_speed_mps, false, limits.max_speed_mps,
               "Faster commands are brought to this speed"},
              [servant](double speed_mps) {
                servant->limitSpeed(speed_mps);
                return std::string();
              });
  }
  if (limits.max_turn_rate_radps > 0.0) {
    const double highest_degps = radToDeg(limits.max_turn_rate_radps);
    table.add({"Base.MaximumTurnRate_degps", "deg/s", 0.0, highest_degps, false, highest_degps,
               "Faster turns are brought to this rate"},
              [servant](double turn_rate_degps) {
                servant->limitTurnRate(degToRad(turn_rate_degps));
                return std::string();
              });
  }
}

}  // namespace vismem
