// Tests M6.
#include "active_visual_memory/core/estimation/measurement_models.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "active_visual_memory/core/tilted_camera.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

const Pose3 T_robot_camera = cameraPose(mount(), 0.0, -0.35);
const TiltView kView(T_robot_camera, 0.0);

/// A line from (1, 0.5) to (2, 0.8), seen `aside_m` to its left.
FloorSegment seen(double aside_m) {
  const Segment2 line{{1.0, 0.5}, {2.0, 0.8}};
  const Eigen::Vector2d aside = aside_m * turned90(Eigen::Vector2d((line.b - line.a).normalized()));
  FloorSegment segment;
  segment.place({line.a + aside, line.b + aside});
  for (FloorEnd* end : {&segment.a, &segment.b}) {
    end->P = 1e-4 * Eigen::Matrix2d::Identity();
    end->D = kView.derivativeAt(end->p);
  }
  return segment;
}

constexpr double kEndInflation = 2.0;
constexpr double kMaxEndShift_m = 0.15;

std::vector<LineResidual> allResidualsOf(const FloorLine& line, const FloorSegment& observed, double slack_m,
                                         double noise) {
  std::vector<LineResidual> residuals;
  addLineResiduals(7, line, observed, kView, slack_m, noise, kEndInflation, kMaxEndShift_m, residuals);
  return residuals;
}

/// Those across the line.
std::vector<LineResidual> residualsOf(const FloorLine& line, const FloorSegment& observed, double slack_m,
                                      double noise) {
  auto residuals = allResidualsOf(line, observed, slack_m, noise);
  std::erase_if(residuals, [](const LineResidual& residual) { return residual.line == 0; });
  return residuals;
}

TEST(MeasurementModels, ALineSeenAsideGivesThatDistanceAtBothEnds) {
  const FloorLine line(seen(0.0), {});
  for (const FloorSegment& observed : {seen(0.02), reversed(seen(0.02))}) {
    const auto residuals = residualsOf(line, observed, 0.0, 1.0);
    ASSERT_EQ(residuals.size(), 2U);
    for (const LineResidual& residual : residuals) {
      EXPECT_EQ(residual.line, 7U);
      EXPECT_NEAR(residual.residual_m, 0.02, 1e-9);
      EXPECT_NEAR(residual.direction.dot(line.normal()), 1.0, 1e-12);
      EXPECT_NEAR(residual.variance_m2, 1e-4, 1e-12);
    }
  }
}

TEST(MeasurementModels, ATrueEndMeasuresAlongTheLine) {
  const FloorLine line(seen(0.0), {});
  const auto ends = [&](double further_m, bool censored) {
    FloorSegment observed = seen(0.0);
    observed.b.p += further_m * line.along();
    observed.b.censored = censored;
    auto residuals = allResidualsOf(line, observed, 0.0, 1.0);
    std::erase_if(residuals, [](const LineResidual& residual) { return residual.line != 0; });
    return residuals;
  };
  const auto both = ends(0.03, false);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(both[0].residual_m, 0.0, 1e-9);
  EXPECT_NEAR(both[1].residual_m, 0.03, 1e-9);
  EXPECT_NEAR(both[1].direction.dot(line.along()), 1.0, 1e-12);
  EXPECT_NEAR(both[1].variance_m2, kEndInflation * kEndInflation * 2e-4, 1e-10) << "seen and known";
  EXPECT_EQ(ends(0.03, true).size(), 1U) << "a cut end says nothing";
  EXPECT_EQ(ends(2.0 * kMaxEndShift_m, false).size(), 1U) << "another end";
}

TEST(MeasurementModels, SlackAddsToTheVarianceAndNoiseScalesIt) {
  const auto residuals = residualsOf(FloorLine(seen(0.0), {}), seen(0.0), 0.01, 4.0);
  EXPECT_NEAR(residuals.front().variance_m2, 4.0 * (1e-4 + 1e-4), 1e-12);
}

TEST(MeasurementModels, TheCommonPitchOfAnImageIsNoErrorOfItsEnds) {
  FloorSegment observed = seen(0.0);
  observed.pitch_sigma_rad = degToRad(0.34);
  for (FloorEnd* end : {&observed.a, &observed.b}) {
    const Eigen::Matrix2d D = end->D.rightCols<2>();
    end->P += observed.pitch_sigma_rad * observed.pitch_sigma_rad * D * D.transpose();
  }
  for (const LineResidual& residual : residualsOf(FloorLine(seen(0.0), {}), observed, 0.0, 1.0)) {
    EXPECT_NEAR(residual.variance_m2, 1e-4, 1e-10);
  }
}

TEST(MeasurementModels, DerivativesAreThoseOfATiltedCamera) {
  const std::vector<Segment3> world{{{1.0, 0.5, 0.0}, {2.0, 0.8, 0.0}}};
  const FloorLine line(seen(0.0), {});
  constexpr double kTilt_rad = 0.002;
  for (int axis = 0; axis < 4; ++axis) {
    const auto offsets = [&](double tilt_rad) {
      std::mt19937_64 random(3);
      const auto floor = seenTilted(world, T_robot_camera, tilt_rad * CameraTilt::Unit(axis), random);
      const FloorSegment observed = runningAlong(line.along(), floor.front());
      return residualsOf(line, observed, 0.0, 1.0);
    };
    const auto one = offsets(kTilt_rad);
    const auto other = offsets(-kTilt_rad);
    for (std::size_t i = 0; i < one.size(); ++i) {
      // The camera looks lower than believed: what it sees lies nearer than where it is placed.
      const double measured = (one[i].residual_m - other[i].residual_m) / (2.0 * kTilt_rad);
      EXPECT_NEAR(measured, -one[i].d_tilt[axis], 0.05) << axis << ", end " << i;
    }
  }
}

}  // namespace
}  // namespace vismem
