/// @file Bodies of simulated robots: corner observations by a camera model. Tests B5.
#include "calibration/core/body/body_estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/core/body/body_costs.h"
#include "calibration/core/body/body_start.h"
#include "calibration/simulated_board_robot.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

BodyEstimatorParams described() {
  BodyEstimatorParams params;
  params.mount = describedMount();
  params.wheel_base_m = kDescribedBase_m;
  return params;
}

BodyDriveParams shortDrive() {
  BodyDriveParams params;
  params.rig.mount = describedMount();
  params.rounds = 2;
  return params;
}

BodyRecord recordOf(const TrueRobot& truth, std::uint64_t seed,
                    const BodyDriveParams& params = shortDrive()) {
  SimulatedBoardRobot robot(truth, seed);
  BodyDrive drive(params);
  BodyRecord record = robot.run(drive);
  EXPECT_EQ(drive.phase(), BodyDrivePhase::kDone) << drive.whyStopped();
  return record;
}

double valueOf(const BodyEstimate& estimate, std::size_t index) {
  return parameterOf(estimate.parameters, index);
}

std::optional<double> sigmaOf(const BodyEstimate& estimate, std::size_t index) {
  for (const auto& row : estimate.rows) {
    if (row.index == index) return row.sigma;
  }
  return std::nullopt;
}

// The figures of B5: .05 and .15 degrees, 2 and 3 mm, .1 %, 2 and 10 ms.
TEST(BodyEstimator, FindsADrawnRobotWithHonestDeviations) {
  const TrueRobot truth = drawnRobot(7);
  const BodyEstimate estimate = estimateBody(recordOf(truth, 7), described());
  const BodyErrors e = errorsOf(estimate.parameters, truth);
  EXPECT_LT(e.place.head<2>().cwiseAbs().maxCoeff(), 0.003);
  EXPECT_LT(std::abs(e.place[2]), 0.002);
  EXPECT_LT(std::abs(e.place[3]), degToRad(0.1));
  EXPECT_LT(std::abs(e.place[4]), degToRad(0.05));
  EXPECT_LT(std::abs(e.place[5]), degToRad(0.15));
  EXPECT_LT(std::abs(e.pan_scale), 0.001);
  EXPECT_LT(std::abs(e.tilt_scale), 0.002);
  EXPECT_LT(std::abs(e.joint_delay_s), 0.002);
  EXPECT_LT(std::abs(e.odometry_delay_s), 0.01);
  EXPECT_LT(e.ring_m, 0.2 * e.ring_before_m);
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(estimate.place[i].sigma) << cameraPlaceInfos()[i].name;
    EXPECT_LT(std::abs(e.place[static_cast<Eigen::Index>(i)]), 4.0 * *estimate.place[i].sigma)
        << cameraPlaceInfos()[i].name;
  }
  ASSERT_TRUE(sigmaOf(estimate, kJointDelay));
  EXPECT_LT(std::abs(e.joint_delay_s), 4.0 * *sigmaOf(estimate, kJointDelay));
  EXPECT_NEAR(estimate.fit.rms_px, 0.2, 0.01);
  EXPECT_THAT(estimate.unknown, testing::IsEmpty());
  EXPECT_THAT(estimate.warnings, testing::Each(testing::HasSubstr("backlash")));
}

// Without noise, errors are those of the model: a sweep speeds up and turns back during an image of 25 ms.
TEST(BodyEstimator, AHeadThatTurnsBackDuringARollingImageLeavesNoError) {
  TrueRobot truth = drawnRobot(101);
  truth.corner_sigma_px *= 0.01;
  truth.repeatability_rad *= 0.01;
  truth.wheel_noise_sqrtm *= 0.01;
  truth.row_time_s = 50e-6;
  truth.backlash_rad = {degToRad(0.4), degToRad(0.4)};
  BodyDriveParams once = shortDrive();
  once.rounds = 1;
  const BodyEstimate estimate = estimateBody(recordOf(truth, 101, once), described());
  const BodyErrors e = errorsOf(estimate.parameters, truth);
  EXPECT_LT(std::abs(e.row_time_s), 0.1e-6);
  EXPECT_LT(std::abs(e.place[2]), 1e-4) << "height";
  EXPECT_LT(std::abs(e.tilt_scale), 1e-4);
  EXPECT_LT(e.backlash_rad.cwiseAbs().maxCoeff(), degToRad(0.001));
  EXPECT_NEAR(valueOf(estimate, lensParameter(kFx)), truth.intrinsics.fx, 0.05);
}

// The lens is known to a pixel, its distortion too: half a pixel at the corner of the image is no error of
// fx.
TEST(BodyEstimator, AnErrorOfTheStatedDistortionStaysInTheDistortion) {
  TrueRobot truth = drawnRobot(7);
  truth.intrinsics = boardCamera();
  truth.intrinsics.k1 = -0.1;
  truth.stated = truth.intrinsics;
  truth.stated.k1 = -0.097;
  truth.corner_sigma_px = 0.07;
  BodyDriveParams once = shortDrive();
  once.rounds = 1;
  const BodyEstimate estimate = estimateBody(recordOf(truth, 7, once), described());
  const BodyParameters sought = soughtParameters(truth);
  for (const LensIndex i : {kFx, kFy, kCx, kCy, kK1, kK2, kP1, kP2, kK3}) {
    const std::size_t index = lensParameter(i);
    ASSERT_TRUE(sigmaOf(estimate, index)) << parameterInfos()[index].name;
    EXPECT_LT(std::abs(valueOf(estimate, index) - parameterOf(sought, index)),
              3.5 * *sigmaOf(estimate, index))
        << parameterInfos()[index].name;
  }
  EXPECT_LT(*sigmaOf(estimate, lensParameter(kK1)), 0.001) << "a third of its error";
}

TEST(BodyEstimator, FindsTheBacklashOfBothJoints) {
  TrueRobot truth = drawnRobot(8);
  truth.backlash_rad = {degToRad(0.4), degToRad(0.2)};
  const BodyEstimate estimate = estimateBody(recordOf(truth, 8), described());
  const BodyErrors e = errorsOf(estimate.parameters, truth);
  EXPECT_LT(e.backlash_rad.cwiseAbs().maxCoeff(), degToRad(0.03));
  for (const std::size_t j : {0, 1}) {
    ASSERT_TRUE(sigmaOf(estimate, kPanBacklash + j));
    EXPECT_LT(std::abs(e.backlash_rad[static_cast<Eigen::Index>(j)]),
              4.0 * *sigmaOf(estimate, kPanBacklash + j));
  }
  EXPECT_LT(std::abs(e.place[4]), degToRad(0.05)) << "tilt";
  EXPECT_LT(std::abs(e.place[5]), degToRad(0.15)) << "yaw";
  EXPECT_THAT(estimate.warnings, testing::ElementsAre(testing::HasSubstr("a pan backlash of 0."),
                                                      testing::HasSubstr("a tilt backlash of 0.")));
}

TEST(BodyEstimator, ARobotWithoutBacklashReadsNone) {
  TrueRobot truth = drawnRobot(8);
  truth.backlash_rad = {0.0, 0.0};
  const BodyEstimate estimate = estimateBody(recordOf(truth, 8), described());
  EXPECT_TRUE(estimate.isObservable(kPanBacklash));
  EXPECT_TRUE(estimate.isObservable(kTiltBacklash));
  EXPECT_LT(std::abs(valueOf(estimate, kPanBacklash)), degToRad(0.02));
  EXPECT_LT(std::abs(valueOf(estimate, kTiltBacklash)), degToRad(0.02));
  EXPECT_THAT(estimate.warnings, testing::IsEmpty());
}

// A tilt that always came from below: its backlash and its zero cannot be told apart.
TEST(BodyEstimator, ViewsFromOneSideDoNotShowTheBacklash) {
  BodyRecord record = recordOf(drawnRobot(8), 8);
  const JointPath joints(record.joints);
  const auto still = stillViews(record, joints, WheelPath(record.odometry, kDescribedBase_m));
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < still.size(); ++i) {
    const double time_s = toSeconds(record.views[i].stamp_us);
    const MotorLead lead = joints.leadAt(time_s, Eigen::Vector2d::Zero())[1];
    if (still[i] && lead.lead(1.0, 0.0, 0.0, joints.at(time_s)[1]) > 0.8)
      views.push_back(record.views[i]);  // a joint swings back a little
  }
  ASSERT_GT(views.size(), 20U);
  record.views = views;
  const BodyEstimate estimate = estimateBody(record, described());
  EXPECT_TRUE(estimate.isObservable(kPanBacklash));
  EXPECT_FALSE(estimate.isObservable(kTiltBacklash));
  ASSERT_TRUE(estimate.place[4].sigma);
  EXPECT_GT(*estimate.place[4].sigma, degToRad(0.1)) << "nor is the zero of the tilt known better";
}

TEST(BodyEstimator, FindsHowFarCornersReallyScatter) {
  TrueRobot truth = drawnRobot(9);
  truth.corner_sigma_px = 0.5;  // the finder states 0.2
  const BodyEstimate estimate = estimateBody(recordOf(truth, 9), described());
  EXPECT_NEAR(estimate.noise.corners, 2.5, 0.1);
  EXPECT_NEAR(estimate.noise.repeatability_rad, truth.repeatability_rad, 0.2 * truth.repeatability_rad);
}

// A turning head alone: where it stands on the robot is not observable, and the wheels are not.
TEST(BodyEstimator, SaysWhatAHeadAloneDoesNotShow) {
  BodyDriveParams params = shortDrive();
  params.drive = false;
  const BodyEstimate estimate = estimateBody(recordOf(drawnRobot(2), 2, params), described());
  for (const std::size_t index :
       {std::size_t{kUnitX}, std::size_t{kUnitY}, std::size_t{kUnitYaw}, wheelParameter(kLeftScale),
        wheelParameter(kRightScale), wheelParameter(kBase), wheelParameter(kOdometryDelay)}) {
    EXPECT_FALSE(estimate.isObservable(index)) << parameterInfos()[index].name;
  }
  EXPECT_FALSE(estimate.place[0].sigma);
  EXPECT_FALSE(estimate.place[1].sigma);
  EXPECT_FALSE(estimate.place[5].sigma);
  EXPECT_TRUE(estimate.place[2].sigma) << "height from a board on the floor";
  EXPECT_TRUE(estimate.isObservable(kPanScale));
  EXPECT_TRUE(estimate.isObservable(kJointDelay));
  ASSERT_FALSE(estimate.unknown.empty());
  std::string all;
  for (const auto& direction : estimate.unknown) all += direction.text + "\n";
  EXPECT_THAT(all, testing::HasSubstr("unit x"));
  EXPECT_THAT(all, testing::HasSubstr("wheel base"));
}

// Planar motion before a board on a wall never gives the height, whatever the robot does.
TEST(BodyEstimator, ABoardOnAWallGivesNoHeight) {
  TrueRobot truth = drawnRobot(3);
  truth.start = {0.0, -1.3, degToRad(90.0)};
  SimulatedBoardRobot robot(truth, 3, BoardPlace::kWall);
  BodyDriveParams params = shortDrive();
  params.drive = false;
  BodyRecord record;
  for (const double way : {0.0, 0.25, -0.35}) {
    robot.move(way >= 0.0 ? 0.25 : -0.25, 0.0, std::abs(way) / 0.25);
    robot.move(0.0, way, 1.0);
    BodyDrive drive(params);
    record = robot.run(drive);
    ASSERT_EQ(drive.phase(), BodyDrivePhase::kDone) << drive.whyStopped();
  }
  const BodyEstimate estimate = estimateBody(record, described());
  EXPECT_FALSE(estimate.isObservable(kUnitZ));
  EXPECT_FALSE(estimate.isObservable(kBoardHeight));
  EXPECT_FALSE(estimate.place[2].sigma) << *estimate.place[2].sigma;
  EXPECT_TRUE(estimate.isObservable(kPanScale));
  std::string all;
  for (const auto& direction : estimate.unknown) all += direction.text + "\n";
  EXPECT_THAT(all, testing::HasSubstr("board height"));
}

TEST(BodyEstimator, ViewsAtRestGiveNoTimes) {
  BodyRecord record = recordOf(drawnRobot(4), 4);
  const auto still =
      stillViews(record, JointPath(record.joints), WheelPath(record.odometry, kDescribedBase_m));
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < still.size(); ++i) {
    if (still[i]) views.push_back(record.views[i]);
  }
  ASSERT_GT(views.size(), 20U);
  record.views = views;
  const BodyEstimate estimate = estimateBody(record, described());
  EXPECT_FALSE(estimate.isObservable(kJointDelay));
  EXPECT_FALSE(estimate.isObservable(kRowTime));
  EXPECT_FALSE(estimate.isObservable(wheelParameter(kOdometryDelay)));
  EXPECT_TRUE(estimate.isObservable(kUnitX));
}

TEST(BodyEstimator, NoticesABoardThatIsNotFlatAlsoWithPlayInTheJoints) {
  TrueRobot truth = drawnRobot(5);
  truth.board_tilt_rad = {0.0, degToRad(0.5)};
  truth.backlash_rad = {degToRad(0.3), degToRad(0.3)};
  const BodyEstimate estimate = estimateBody(recordOf(truth, 5), described());
  EXPECT_NEAR(valueOf(estimate, kBoardPitch), degToRad(0.5), degToRad(0.05));
  EXPECT_THAT(estimate.warnings, testing::Contains(testing::HasSubstr("not flat on the floor")));
  EXPECT_LT(std::abs(errorsOf(estimate.parameters, truth).place[4]), degToRad(0.06));
}

// All lengths shrink with the board; only a tape measure shows it.
TEST(BodyEstimator, ATapeMeasureContradictsABoardOfTheWrongSize) {
  TrueRobot truth = drawnRobot(6);
  truth.board_scale = 0.97;
  const BodyRecord record = recordOf(truth, 6);
  const BodyEstimate alone = estimateBody(record, described());
  EXPECT_NEAR(alone.place[2].value / trueCameraPose(truth, {}).translation().z(), 1.0 / 0.97, 0.01);
  EXPECT_NEAR(alone.fit.normalised_rms, 1.0, 0.1) << "the images alone do not show it";
}

// The ways around the board need its distance long before the tilt is calibrated.
TEST(MiddleFromRobot, IsAsFarAsTheBoardsPlaneSaysWhateverTheDescribedTilt) {
  const BoardSpec board = a3Board();
  const Pose3 T_robot_camera = cameraPose(describedMount(), degToRad(20.0), degToRad(-20.0));
  const Pose3 T_robot_board = poseFromXyzRpy(1.0, 0.4, 0.0, 0.0, 0.0, degToRad(70.0));
  const Pose3 T_camera_board = T_robot_camera.inverse(Eigen::Isometry) * T_robot_board;
  const Eigen::Vector3d middle = T_robot_board * middlePosition(board);
  EXPECT_NEAR((middleFromRobot(T_robot_camera, T_camera_board, board, BoardPlace::kFloor) - middle).norm(),
              0.0, 1e-9);
  for (const double wrong_deg : {-8.0, 8.0}) {
    const Pose3 described = cameraPose(describedMount(), degToRad(20.0), degToRad(-20.0 + wrong_deg));
    const Eigen::Vector3d p = middleFromRobot(described, T_camera_board, board, BoardPlace::kFloor);
    EXPECT_NEAR(p.head<2>().norm(), middle.head<2>().norm(), 1e-9);
    EXPECT_GT(p.z() * wrong_deg, 0.0) << "the described camera aims too high or too low";
  }
}

TEST(BodyEstimator, RefusesARecordWithoutRest) {
  BodyRecord record;
  record.board = a3Board();
  record.intrinsics = boardCamera();
  EXPECT_THAT([&] { estimateBody(record, described()); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("no view of the board")));
  BoardView view;
  view.corners.push_back({0, {1.0, 1.0}, 0.2});
  view.corners.push_back({99, {1.0, 1.0}, 0.2});
  record.views.push_back(view);
  record.joints = {{0, 0, 0, 0}, {1'000'000, 1, 1.0, 0}};
  record.odometry = {{0, 0, {}, 0, 0}, {1'000'000, 1, {}, 0, 0}};
  EXPECT_THAT(
      [&] { estimateBody(record, described()); },
      testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("corner 99 is not on the board")));
  record.views.back().corners.pop_back();
  EXPECT_THAT([&] { estimateBody(record, described()); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("taken at rest")));
}

}  // namespace
}  // namespace vismem
