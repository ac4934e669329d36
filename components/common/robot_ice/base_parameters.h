/// @file What of a served base may change while the component runs.
#pragma once

#include <memory>

#include "common/process/parameter_table.h"
#include "common/robot_ice/base_ice.h"

namespace vismem {

/// Lists "Base.MaximumSpeed_mps" and "Base.MaximumTurnRate_degps", up to the base's own limits. A base that
/// does not know its limits yet gets none.
void listBaseParameters(ParameterTable& table, const MobileBase& base,
                        const std::shared_ptr<BaseServant>& servant);

}  // namespace vismem
