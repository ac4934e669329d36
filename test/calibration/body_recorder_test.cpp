/// @file `calibrate body` on rendered images of the simulator, through the ports of a robot. Tests B5.
#include "calibration/app/body_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/app/body_files.h"
#include "calibration/simulated_body_trial.h"
#include "common/config/config_error.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(BodyRecorder, CalibratesADrawnRobotFromRenderedImages) {
  const TrueRobot truth = drawnForSimulator(3);
  BodyDriveParams params = driveInSimulator();
  params.rounds = 2;
  const SimulatedBodyTrial trial = runInSimulator(truth, 3, params);
  ASSERT_EQ(trial.drive.phase(), BodyDrivePhase::kDone) << trial.drive.whyStopped();
  EXPECT_LT(trial.farthest_m, params.fence_m);
  EXPECT_GT(trial.record.views.size(), 80U);
  BodyEstimatorParams how;
  how.mount = describedMount();
  how.wheel_base_m = kDescribedBase_m;
  const BodyEstimate estimate = estimateBody(trial.record, how);
  const BodyErrors e = errorsOf(estimate.parameters, truth);
  EXPECT_LT(std::abs(e.place[4]), degToRad(0.1)) << "tilt";
  EXPECT_LT(std::abs(e.place[5]), degToRad(0.3)) << "yaw";
  EXPECT_LT(e.place.head<3>().cwiseAbs().maxCoeff(), 0.005);
  EXPECT_LT(std::abs(e.joint_delay_s), 0.004);
  EXPECT_LT(std::abs(e.odometry_delay_s), 0.01);
  EXPECT_LT(e.backlash_rad.cwiseAbs().maxCoeff(), degToRad(0.03));
  EXPECT_LT(estimate.fit.rms_px, 0.3);
  std::cout << tableOf(estimate);
  // A record in a file gives the same estimate.
  const BodyRecord again = bodyRecordFrom(toJson(trial.record), "here");
  EXPECT_EQ(toJson(again), toJson(trial.record));
}

BodyDriveParams headOnly() {
  BodyDriveParams params = driveInSimulator();
  params.drive = false;
  return params;
}

TEST(BodyRecorder, GoesOnWhenCommandsAreLost) {
  const SimulatedBodyTrial trial = runInSimulator(drawnForSimulator(4), 4, headOnly(), [](int command) {
    return command % 7 == 3 || command % 100 < 10 ? HeadFault::kRefused : HeadFault::kNone;
  });
  EXPECT_EQ(trial.drive.phase(), BodyDrivePhase::kDone) << trial.drive.whyStopped();
  EXPECT_GT(trial.record.views.size(), 20U);
}

TEST(BodyRecorder, KeepsTheViewsOfADriveThatFails) {
  const SimulatedBodyTrial trial = runInSimulator(drawnForSimulator(4), 4, headOnly(), [](int command) {
    return command == 400 ? HeadFault::kThrows : HeadFault::kNone;
  });
  EXPECT_EQ(trial.drive.phase(), BodyDrivePhase::kStopped);
  EXPECT_EQ(trial.drive.whyStopped(), "the head is gone");
  EXPECT_GT(trial.record.views.size(), 5U);
}

TEST(BodyRecorder, NamesADamagedFile) {
  nlohmann::json json = toJson(BodyRecord{});
  json["lens"].erase("pinhole_px");
  EXPECT_THAT([&] { bodyRecordFrom(json, "out/body.json"); },
              testing::ThrowsMessage<ConfigError>(
                  testing::AllOf(testing::HasSubstr("out/body.json"), testing::HasSubstr("pinhole_px"))));
  json["version"] = 9;
  EXPECT_THAT([&] { bodyRecordFrom(json, "out/body.json"); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("version: 9 (must be 1)")));
}

}  // namespace
}  // namespace vismem
