#include "common/kinematics/kinematics_config.h"

#include <algorithm>

#include "common/geometry/angles.h"

namespace vismem {

void readBaseParams(ConfigReader r, BaseParams& p) {
  r.describe({basic("MaximumSpeed_mps", "highest speed"),
              basic("MaximumTurnRate_degps", "highest rate of turning"),
              basic("Watchdog_s", "it brakes so long after the last command"),
              basic("Acceleration_mps2", "on the way to a commanded speed"),
              basic("TurnAcceleration_degps2", "on the way to a commanded rate of turning"),
              basic("EmergencyDeceleration_mps2", "of the watchdog's braking, and at the end of the process"),
              basic("EmergencyTurnDeceleration_degps2", "the same when it turns"),
              basic("Radius_m", "of the robot's disc, which stops before obstacles"),
              basic("WheelBase_m", "distance of the wheels")});
  p.limits.max_speed_mps = r.real("MaximumSpeed_mps", p.limits.max_speed_mps, 0.01, 5.0);
  p.limits.max_turn_rate_radps =
      degToRad(r.real("MaximumTurnRate_degps", radToDeg(p.limits.max_turn_rate_radps), 1.0, 720.0));
  p.limits.watchdog_s = r.real("Watchdog_s", p.limits.watchdog_s, 0.05, 60.0);
  p.acceleration_mps2 = r.real("Acceleration_mps2", p.acceleration_mps2, 0.01, 50.0);
  p.turn_acceleration_radps2 =
      degToRad(r.real("TurnAcceleration_degps2", radToDeg(p.turn_acceleration_radps2), 1.0, 10000.0));
  p.emergency_deceleration_mps2 =
      r.real("EmergencyDeceleration_mps2", p.emergency_deceleration_mps2, 0.01, 50.0);
  p.emergency_turn_deceleration_radps2 = degToRad(r.real(
      "EmergencyTurnDeceleration_degps2", radToDeg(p.emergency_turn_deceleration_radps2), 1.0, 10000.0));
  p.radius_m = r.real("Radius_m", p.radius_m, 0.01, 2.0);
  p.wheel_base_m = r.real("WheelBase_m", p.wheel_base_m, 0.01, 2.0);
}

void readPanTiltParams(ConfigReader r, PanTiltParams& p) {
  r.describe({basic("Pan.Maximum_deg", "limit to the left"), basic("Pan.Minimum_deg", "limit to the right"),
              basic("Tilt.Maximum_deg", "limit upwards"), basic("Tilt.Minimum_deg", "limit downwards"),
              basic("Pan.Rate_degps", "highest speed"), basic("Tilt.Rate_degps", "highest speed"),
              basic("Pan.Backlash_deg", "play between the motor, whose angle is reported, and the head"),
              basic("Tilt.Backlash_deg", "as Pan.Backlash_deg"),
              basic("Acceleration_degps2", "of both joints")});
  PanTiltLimits& l = p.limits;
  l.max_pan_rad = r.angleDeg("Pan.Maximum_deg", radToDeg(l.max_pan_rad), 0.0, 180.0);
  l.min_pan_rad = r.angleDeg("Pan.Minimum_deg", radToDeg(l.min_pan_rad), -180.0, 0.0);
  l.max_tilt_rad = r.angleDeg("Tilt.Maximum_deg", radToDeg(l.max_tilt_rad), 0.0, 90.0);
  l.min_tilt_rad = r.angleDeg("Tilt.Minimum_deg", radToDeg(l.min_tilt_rad), -90.0, 0.0);
  l.max_pan_rate_radps = degToRad(r.real("Pan.Rate_degps", radToDeg(l.max_pan_rate_radps), 1.0, 2000.0));
  l.max_tilt_rate_radps = degToRad(r.real("Tilt.Rate_degps", radToDeg(l.max_tilt_rate_radps), 1.0, 2000.0));
  p.backlash_rad.pan_rad = r.angleDeg("Pan.Backlash_deg", radToDeg(p.backlash_rad.pan_rad), 0.0, 10.0);
  p.backlash_rad.tilt_rad = r.angleDeg("Tilt.Backlash_deg", radToDeg(p.backlash_rad.tilt_rad), 0.0, 10.0);
  p.acceleration_radps2 =
      degToRad(r.real("Acceleration_degps2", radToDeg(p.acceleration_radps2), 1.0, 100000.0));
}

void readOdometryErrorParams(ConfigReader r, OdometryErrorParams& p) {
  r.describe(
      {basic("Preset", "values of the other keys of the group; empty: those of the robot"),
       expert("RadiusError", "relative standard deviation of the wheels' radii, drawn once a run"),
       expert("BaseError", "the same of the distance of the wheels"),
       expert("TravelNoise_m", "standard deviation of a wheel's travel after 1 m"),
       expert("Tick_m", "step of a wheel's encoder"),
       expert("Stage", "widths of the relative errors of travel and turning, drawn once a run"),
       expert("Thrun",
              "alpha1..alpha4: variances of turn by turn, turn by travel, travel by travel, travel by turn"),
       basic("Slip.PerMetre", "rare slips of a wheel, on the average"),
       basic("Slip.Size_m", "of a slip, times 0.5 to 1.5")});
  using Preset = OdometryErrorParams (*)();
  // Without the key, the robot's default applies.
  const OdometryErrorParams given = p;
  const Preset preset = r.choice<Preset>("Preset", nullptr,
                                         {{"none", noOdometryError},
                                          {"default", defaultOdometryError},
                                          {"stage", stageOdometryError},
                                          {"thrun", thrunOdometryError}});
  p = preset != nullptr ? preset() : given;
  p.radius_sigma = r.real("RadiusError", p.radius_sigma, 0.0, 0.2);
  p.base_sigma = r.real("BaseError", p.base_sigma, 0.0, 0.2);
  p.travel_sigma_sqrtm = r.real("TravelNoise_m", p.travel_sigma_sqrtm, 0.0, 0.2);
  p.tick_m = r.real("Tick_m", p.tick_m, 0.0, 0.1);
  const auto stage = r.reals("Stage", {p.stage_forward, p.stage_turn}, 0.0, 1.0);
  p.stage_forward = stage[0];
  p.stage_turn = stage[1];
  const auto thrun = r.reals("Thrun", {p.thrun.begin(), p.thrun.end()}, 0.0, 10.0);
  std::copy(thrun.begin(), thrun.end(), p.thrun.begin());
  p.slips_per_m = r.real("Slip.PerMetre", p.slips_per_m, 0.0, 100.0);
  p.slip_m = r.real("Slip.Size_m", p.slip_m, 0.0, 1.0);
}

}  // namespace vismem
