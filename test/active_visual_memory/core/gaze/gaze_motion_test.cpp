// Tests A4, A5.
#include "active_visual_memory/core/gaze/gaze_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(Saccade, SmallOnesHaveMinimumJerkWithinTheLimits) {
  const AxisLimits limits{degToRad(150.0), degToRad(1000.0)};
  for (double angle_deg = 1.0; angle_deg <= 300.0; angle_deg *= 1.3) {
    const PanTilt to{degToRad(angle_deg), 0.0};
    const Saccade saccade(0, {}, to, limits, limits, 1.25);
    const bool smooth = saccade.at(1, to).pan_rad < 0.5 * to.pan_rad;
    EXPECT_EQ(smooth, angle_deg < 45.0) << angle_deg;
    EXPECT_LE(saccade.duration_s(), 1.25 * fastestTurn_s(to.pan_rad, limits) + 1e-9);
    EXPECT_GE(saccade.duration_s(), fastestTurn_s(to.pan_rad, limits) - 1e-9);
    EXPECT_NEAR(saccade.at(saccade.end(), to).pan_rad, to.pan_rad, 1e-6);
    if (!smooth) continue;
    const StampUs dt = 1000;
    for (StampUs t = dt; t + dt <= saccade.end(); t += dt) {
      const double before = saccade.at(t - dt, to).pan_rad;
      const double here = saccade.at(t, to).pan_rad;
      const double after = saccade.at(t + dt, to).pan_rad;
      EXPECT_LE((after - here) / toSeconds(dt), limits.rate_radps * 1.001);
      EXPECT_LE(std::abs(after - 2.0 * here + before) / std::pow(toSeconds(dt), 2),
                limits.acceleration_radps2 * 1.01);
    }
  }
}

}  // namespace
}  // namespace vismem
