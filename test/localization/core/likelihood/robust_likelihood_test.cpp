// Tests L12, B2.
#include "localization/core/likelihood/robust_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/corner_scene.h"

namespace vismem {
namespace {

TEST(RobustLikelihood, OnlyEndsFixThePositionAlongALine) {
  // Of the wall x = 1 the map has two metres; the robot sees half a metre of it with one of its ends, and
  // stands 3 cm beside where it believes to be.
  SegmentMap one;
  one.segments = {wall(1, -1, 1, 1)};
  const MapIndex map(one, {});
  const double half = 0.25;
  const double px = half * 277.13 / std::sqrt(2.0);
  const Pose2 truth{0.0, -0.75, 0.0};
  const LikelihoodParams params;
  const auto refined = [&](const ObservationParams& observed) {
    const RobustLikelihood likelihood(map, params);
    const FloorObservation observation = observeImage(lineAhead(159.5 - px, 159.5 + px), map, observed);
    Matrix5d prior = Matrix5d::Identity();
    prior.diagonal() << 1.0, 1.0, 1e6, 1e8, 1e8;
    return likelihood.refine(observation, {{0.0, truth.y - 0.03, 0.0}}, prior, 1.0, 5, 0.0).placement;
  };
  EXPECT_NEAR(refined({}).T_world_robot.y, truth.y, 5e-3);
  ObservationParams without;
  without.end_metres = 0.0;
  EXPECT_GT(std::abs(refined(without).T_world_robot.y - truth.y), 0.01);
}

TEST(RobustLikelihood, AMemoryWithoutInfluenceIsRatedAndDoesNotMoveThePose) {
  const MapIndex map = cornerMap();
  const LikelihoodParams params;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation = observeMemory(snapshotOf({remembered(0, 1, 2, 1)}), map, {});
  const Pose2 off{1.0, -0.95, 0.0};
  ASSERT_LT(
      std::abs(
          likelihood.refine(observation, {off}, Matrix5d::Zero(), 1.0, 5, 0.0).placement.T_world_robot.y +
          1.0),
      0.01);
  observation.memory_influence = 0.0;
  const auto refined = likelihood.refine(observation, {off}, Matrix5d::Zero(), 1.0, 5, 0.0);
  EXPECT_EQ(refined.placement.T_world_robot.y, off.y);
  EXPECT_LT(refined.rating.log_likelihood, -1.0);
}

TEST(RobustLikelihood, ATopThatLooksLikeItsFootFitsAtItsHeight) {
  // The camera, 1 m above the robot's middle, sees a line that would lie 1 m ahead on the floor: the top of
  // the skirting on the wall x = 1, 0.08 m high, from x = 0.08.
  SegmentMap foot;
  foot.segments = {wall(1, -3, 1, 3)};
  SegmentMap both = foot;
  both.segments.push_back({{{1, -3, 0.08}, {1, 3, 0.08}}, "skirting_top", 0.0});
  const MapIndex only_foot(foot, {});
  const MapIndex with_top(both, {});
  const LikelihoodParams params;
  const ImageAnalysis image = lineAhead(60, 260);
  const Placement at_top{{0.08, 0.0, 0.0}};
  const auto explained = [&](const MapIndex& map, const Placement& at) {
    return RobustLikelihood(map, params).rate(observeImage(image, map, {}), at).explained;
  };
  EXPECT_GT(explained(with_top, at_top), 0.99);
  EXPECT_LT(explained(only_foot, at_top), 0.1);
  EXPECT_GT(explained(with_top, {}), 0.99);  // it may be the foot as well

  Matrix5d prior = Matrix5d::Identity();
  prior.diagonal() << 1.0, 1e6, 1e6, 1e8, 1e8;
  const auto refined = RobustLikelihood(with_top, params)
                           .refine(observeImage(image, with_top, {}), {{0.07, 0.0, 0.0}}, prior, 1.0, 5, 0.0);
  EXPECT_NEAR(refined.placement.T_world_robot.x, 0.08, 1e-3);
}

TEST(RobustLikelihood, HandWorkedExample) {
  const MapIndex map = cornerMap();
  LikelihoodParams params;
  params.outlier_share = 0.05;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation;
  // 0.06 m from the wall at sigma 0.06 m: exp(-1/2) = 0.60653; log(0.95 * 0.60653 + 0.05) = log(0.62620) =
  // -0.46808.
  observation.points = {{{1.0, 0.06}, 0.0, 0, 0.06, 1.0}};
  EXPECT_NEAR(likelihood.rate(observation, {}).log_likelihood, -0.46808, 1e-4);
  EXPECT_NEAR(likelihood.rate(observation, {}).explained, 0.60653, 1e-4);
}

TEST(RobustLikelihood, ExplainedSharesAllowForMapError) {
  const MapIndex map = cornerMap();
  LikelihoodParams params;
  params.outlier_share = 0.05;
  params.explained_sigma_m = 0.06;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation;
  // 0.06 m from the wall at sigma 0.02 m: exp(-4.5) = 0.011109; log(0.95 * 0.011109 + 0.05) = log(0.060554) =
  // -2.80421. It is explained as by 0.06 m: exp(-1/2).
  observation.points = {{{1.0, 0.06}, 0.0, 0, 0.02, 1.0}};
  EXPECT_NEAR(likelihood.rate(observation, {}).log_likelihood, -2.80421, 1e-4);
  EXPECT_NEAR(likelihood.rate(observation, {}).explained, 0.60653, 1e-4);
  std::vector<Individual> place{{{}, 0.0}};
  likelihood.explain(observation, place, 0.0, 0.1);
  EXPECT_NEAR(place[0].health, 0.60653, 1e-4);
  // A point that is itself no better known than that: as in the example above.
  observation.points = {{{1.0, 0.06}, 0.0, 0, 0.06, 1.0}};
  EXPECT_NEAR(likelihood.rate(observation, {}).explained, 0.60653, 1e-4);
  EXPECT_NEAR(likelihood.rate(observation, {}).log_likelihood, -0.46808, 1e-4);
}

TEST(RobustLikelihood, AnyOutlierCostsAtMostLogEpsilon) {
  const MapIndex map = cornerMap();
  const LikelihoodParams params;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation;
  observation.points = {{{1.0, 0.0}, 0.0, 0, 0.06, 1.0}};
  const double clean = likelihood.rate(observation, {}).log_likelihood;
  observation.points.push_back({{500.0, 500.0}, 0.0, 0, 0.06, 1.0});
  const double dirty = likelihood.rate(observation, {}).log_likelihood;
  EXPECT_NEAR(dirty - clean, std::log(params.outlier_share), 1e-9);
}

TEST(RobustLikelihood, PointsOfAnotherDirectionDoNotMatch) {
  const MapIndex map = cornerMap();
  const LikelihoodParams params;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation;
  observation.points = {{{2.0, 0.0}, degToRad(90), 0, 0.06, 1.0}};  // on the wall along x, but across it
  EXPECT_LT(likelihood.rate(observation, {}).explained, 0.01);
}

/// 40 points along both walls, seen from (1, 1): a search's rating is the whole one at good poses, and 0 at
/// poor ones.
TEST(RobustLikelihood, ASearchRatesGoodPosesExactlyAndDropsPoorOnes) {
  const MapIndex map = cornerMap();
  const LikelihoodParams params;
  const RobustLikelihood likelihood(map, params);
  FloorObservation observation;
  for (int i = 0; i < 20; ++i) {
    observation.points.push_back({{0.1 * i - 0.5, -1.0}, 0.0, 0, 0.06, 1.0});
    observation.points.push_back({{-1.0, 0.1 * i - 0.5}, degToRad(90), 0, 0.06, 0.5});
  }
  constexpr double kBlur_m = 0.15;
  constexpr double kLeast = 0.3;
  std::vector<Individual> places{{{500.0, 500.0, 0.0}, 1.0}};
  for (double x = 0.0; x <= 3.0; x += 0.25) {
    for (double theta = -3.0; theta <= 3.0; theta += 0.2) places.push_back({{x, 1.0, theta}, 0.0});
  }
  likelihood.explain(observation, places, kBlur_m, kLeast);
  EXPECT_EQ(places[0].health, 0.0);
  int good = 0;
  for (const Individual& place : places) {
    const double whole = likelihood.rate(observation, {place.T_world_robot}, kBlur_m).explained;
    if (place.health > 0.0 || whole >= 2.0 * kLeast) {
      EXPECT_NEAR(place.health, whole, 1e-12) << place.T_world_robot.x << " " << place.T_world_robot.theta;
    }
    good += whole >= 2.0 * kLeast ? 1 : 0;
  }
  EXPECT_GT(good, 0);
  likelihood.explain({}, places, kBlur_m, kLeast);
  for (const Individual& place : places) EXPECT_EQ(place.health, 0.0);
}

TEST(RobustLikelihood, RefinementFindsThePoseDespiteFalseSegments) {
  const MapIndex map = cornerMap();
  const LikelihoodParams params;
  const RobustLikelihood likelihood(map, params);
  const Pose2 truth{1.0, 1.2, 0.4};
  const Pose2 T_odom_world = inverse(truth);  // the robot stands at odom's origin
  std::vector<MemorySegment> segments;
  for (const Segment2& w : {Segment2{{0.2, 0}, {2.5, 0}}, Segment2{{0, 0.2}, {0, 2.5}}}) {
    const Segment2 odom = transform(T_odom_world, w);
    segments.push_back(remembered(odom.a.x(), odom.a.y(), odom.b.x(), odom.b.y()));
  }
  segments.push_back(remembered(0.3, 0.3, 1.0, 0.9));  // false ones
  segments.push_back(remembered(-1.0, 0.5, -0.2, 1.4));
  const FloorObservation observation = observeMemory(snapshotOf(segments), map, {});
  const Pose2 start{1.08, 1.13, 0.47};
  const auto refined = likelihood.refine(observation, {start}, Matrix5d::Zero(), 1.0, 10, 0.0);
  // Bilinear values on a 5 cm grid: a centimetre and a degree.
  EXPECT_NEAR(refined.placement.T_world_robot.x, truth.x, 0.01);
  EXPECT_NEAR(refined.placement.T_world_robot.y, truth.y, 0.01);
  EXPECT_NEAR(refined.placement.T_world_robot.theta, truth.theta, degToRad(1.0));
}

TEST(RobustLikelihood, ALongLineHasNoInformationAlongItself) {
  SegmentMap one;
  one.segments = {wall(-50, 0, 50, 0)};
  const MapIndex map(one, {});
  LikelihoodParams params;
  params.memory_shift_m = 0.0;
  params.memory_turn_rad = 0.0;
  const RobustLikelihood likelihood(map, params);
  const FloorObservation observation = observeMemory(snapshotOf({remembered(-2, 1, 2, 1)}), map, {});
  const Pose2 start{3.0, -0.95, 0.0};
  const auto refined = likelihood.refine(observation, {start}, Matrix5d::Zero(), 1.0, 5, 0.0);
  EXPECT_NEAR(refined.placement.T_world_robot.y, -1.0, 0.005);
  EXPECT_NEAR(refined.placement.T_world_robot.x, 3.0, 1e-6);
  EXPECT_NEAR(refined.information(0, 0), 0.0, 1e-6);
  EXPECT_GT(refined.information(1, 1), 100.0);
}

TEST(RobustLikelihood, MemoryShiftAndTurnBoundTheInformation) {
  const MapIndex map = cornerMap();
  const FloorObservation observation =
      observeMemory(snapshotOf({remembered(0.2, 0, 2.5, 0), remembered(0, 0.2, 0, 2.5)}), map, {});
  LikelihoodParams params;
  params.memory_shift_m = 0.0;
  params.memory_turn_rad = 0.0;
  const Matrix5d prior = Matrix5d::Zero();
  const auto rigid = RobustLikelihood(map, params).refine(observation, {}, prior, 1.0, 0, 0.0);
  params.memory_shift_m = 0.05;
  params.memory_turn_rad = degToRad(4);
  const auto loose = RobustLikelihood(map, params).refine(observation, {}, prior, 1.0, 0, 0.0);
  const auto variances = [](const RobustLikelihood::Refined& refined) {
    return Eigen::Vector3d(refined.information.topLeftCorner<3, 3>().inverse().diagonal());
  };
  // Independent errors add up.
  EXPECT_NEAR(variances(loose)[0] - variances(rigid)[0], 0.05 * 0.05, 1e-6);
  EXPECT_NEAR(variances(loose)[1] - variances(rigid)[1], 0.05 * 0.05, 1e-6);
  EXPECT_NEAR(variances(loose)[2] - variances(rigid)[2], degToRad(4) * degToRad(4), 1e-6);
}

/// A camera 0.45 m above the floor that looks 20 degrees down and along one wall of a corridor, whose walls
/// stand 1 m to each side; the robot stands at the origin and looks along it.
class TiltedCamera : public testing::Test {
 protected:
  static constexpr double kTilt_rad = degToRad(1.0);
  static MapIndex corridor() {
    SegmentMap map;
    map.segments = {wall(-5, 1, 5, 1), wall(-5, -1, 5, -1), wall(4, -1, 4, 1)};
    MapIndex::Params params;
    params.direction_gate_rad = degToRad(20);
    return MapIndex(map, params);
  }
  /// What the camera sees when it really looks `tilt` further down than the robot believes.
  static FloorObservation look(const MapIndex& map, double pan, double tilt) {
    CameraMount mount;
    mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
    ImageAnalysis analysis;
    analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60));
    analysis.T_robot_camera = cameraPose(mount, pan, degToRad(-20));
    Pose3 T_robot_real = analysis.T_robot_camera;
    T_robot_real.linear() =
        Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix() * T_robot_real.linear();
    for (const double y : {-1.0, 1.0}) {
      const Segment3 edge{{0.5, y, 0.0}, {3.5, y, 0.0}};
      if (const auto px = projectSegment(analysis.intrinsics, T_robot_real, edge)) {
        analysis.observed.push_back({*px, "skirting", 30.0});
      }
    }
    return observeImage(analysis, map, {});
  }
};

TEST_F(TiltedCamera, MovesFloorPointsByTheDerivative) {
  const MapIndex map = corridor();
  const FloorObservation tilted = look(map, 0.4, kTilt_rad);
  ASSERT_FALSE(tilted.points.empty());
  // Put right by the derivative, the points of the tilted camera lie on the walls again, but for second
  // order.
  for (const FloorPoint& point : tilted.points) {
    const Eigen::Vector2d corrected = point.p_robot + point.d_tilt * Eigen::Vector2d(kTilt_rad, 0.0);
    const double before = std::abs(std::abs(point.p_robot.y()) - 1.0);
    const double after = std::abs(std::abs(corrected.y()) - 1.0);
    EXPECT_GT(before, 0.005);
    EXPECT_LT(after, 0.2 * before);
  }
}

TEST_F(TiltedCamera, OfOneImageIsFoundFromPointsFarBeyondTheirSigmas) {
  // The trunk of a walking robot: the pose is known to 2 cm and 0.2 degrees, the tilt of an image to 1.
  const MapIndex map = corridor();
  LikelihoodParams params;
  params.frame_tilt_rad = degToRad(1.0);
  const RobustLikelihood likelihood(map, params);
  Vector5d std;
  std << 0.02, 0.02, degToRad(0.2), 1e-3, 1e-3;
  const Matrix5d prior = std.cwiseProduct(std).cwiseInverse().asDiagonal();
  for (const double tilt : {-1.5, -1.0, 1.0, 1.5}) {
    const FloorObservation observation = look(map, 0.4, degToRad(tilt));
    ASSERT_LT(likelihood.rate(observation, {}).explained, 0.6) << tilt;
    const auto refined = likelihood.refine(observation, {}, prior, 1.0, 3, 0.0);
    EXPECT_GT(refined.rating.explained, 0.9) << tilt;
    EXPECT_LT(std::abs(refined.placement.T_world_robot.theta), degToRad(0.5)) << tilt;
    EXPECT_NEAR(refined.placement.frame_tilt.x(), degToRad(tilt), degToRad(0.4)) << tilt;
  }
}

TEST_F(TiltedCamera, IsSeparatedFromTheHeadingByLookingToBothSides) {
  const MapIndex map = corridor();
  LikelihoodParams params;
  params.tilt_bias_rad = degToRad(1.0);
  params.frame_tilt_rad = 0.0;
  const auto headingAfterLooks = [&](double bias_rad) {
    const RobustLikelihood likelihood(map, params);
    Placement at;
    Vector5d std;
    std << 0.1, 0.1, 0.1, bias_rad, bias_rad;
    Matrix5d information = std.cwiseProduct(std).cwiseInverse().asDiagonal();
    double worst = 0.0;
    for (int i = 0; i < 12; ++i) {
      const auto refined =
          likelihood.refine(look(map, i % 2 ? 0.5 : -0.5, kTilt_rad), at, information, 1.0, 5, 0.0);
      at = refined.placement;
      information += refined.information;
      // The robot moves on and forgets a little of its pose, not how its camera is mounted.
      Matrix5d P = information.inverse();
      P.diagonal().head<3>().array() += 1e-3;
      information = P.inverse();
      if (i >= 6) worst = std::max(worst, std::abs(at.T_world_robot.theta));
    }
    if (bias_rad > 1e-3) {
      EXPECT_NEAR(at.tilt_bias.x(), kTilt_rad, degToRad(0.15));
    }
    return worst;
  };
  const double known = headingAfterLooks(1e-6);
  const double estimated = headingAfterLooks(degToRad(1.0));
  EXPECT_GT(known, degToRad(0.5));
  EXPECT_LT(estimated, degToRad(0.2));
}

}  // namespace
}  // namespace vismem
