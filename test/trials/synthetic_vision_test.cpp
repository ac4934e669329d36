#include "experiments/trials/synthetic_vision.h"

#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "experiments/trials/gaussian.h"
#include "experiments/trials/vision_statistics.h"

namespace vismem {
namespace {

const CameraIntrinsics kIntrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));

/// 0.45 m above the floor, looking along x and a little down.
Pose3 camera() {
  return cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-15.0));
}

/// Nothing stands in the way, and what lies to the left of x axis' direction is brighter.
std::optional<SeenSurface> openFloor(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (direction.z() >= -1e-6) return std::nullopt;
  const double range = -origin.z() / direction.z();
  return SeenSurface{range, origin.y() + range * direction.y() > 0.0 ? 0.9 : 0.1};
}

SegmentMap lines() {
  SegmentMap map;
  map.segments = {{{{1.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, -0.5, 0.0}, {2.0, 0.5, 0.0}}, "door_foot", 0.0},
                  {{{-1.0, 0.0, 0.0}, {-3.0, 0.0, 0.0}}, "skirting", 0.0}};
  return map;
}

TEST(VisiblePieces, AreTheProjectionsOfWhatIsInViewBrightSideLeft) {
  const auto pieces = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  ASSERT_EQ(pieces.size(), 2u);  // the third line lies behind
  const auto whole = projectSegment(kIntrinsics, camera(), lines().segments[0].world);
  ASSERT_TRUE(whole);
  EXPECT_EQ(pieces[0].edge, 0);
  EXPECT_NEAR((pieces[0].px.a - whole->a).norm(), 0.0, 1e-6);
  EXPECT_NEAR((pieces[0].px.b - whole->b).norm(), 0.0, 1e-6);
}

TEST(VisiblePieces, TurnSoThatTheBrighterSideIsLeft) {
  SegmentMap turned = lines();
  std::swap(turned.segments[0].world.a, turned.segments[0].world.b);
  const auto as_drawn = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  const auto reversed = visiblePieces(turned, kIntrinsics, camera(), openFloor);
  EXPECT_NEAR((as_drawn[0].px.a - reversed[0].px.a).norm(), 0.0, 1e-6);
}

TEST(VisiblePieces, EndWhereSomethingStandsBeforeThem) {
  // A post covers the middle third of the cross line at x = 2: rays with |y / x| < 0.0833 end at 1.5 m.
  const CastRay post = [](const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction) -> std::optional<SeenSurface> {
    if (std::abs(direction.y() / direction.x()) < 1.0 / 12.0) return SeenSurface{1.5, 0.5};
    return openFloor(origin, direction);
  };
  SegmentMap cross;
  cross.segments = {lines().segments[1]};
  const auto pieces = visiblePieces(cross, kIntrinsics, camera(), post);
  ASSERT_EQ(pieces.size(), 2u);
  const auto whole = projectSegment(kIntrinsics, camera(), cross.segments[0].world);
  const double third = whole->length() / 3.0;
  // Within the step of the rays.
  EXPECT_NEAR(pieces[0].px.length(), third, 4.0);
  EXPECT_NEAR(pieces[1].px.length(), third, 4.0);
}

TEST(SyntheticVision, WithoutErrorsIsTheTruth) {
  VisionErrors none;
  none.found = 1.0;
  none.half_px = -1e3;
  none.across_floor = none.across_upright = none.along_upright = {};
  none.along_floor = {};
  none.along_floor_median_px = none.along_upright_mean_px = none.border_px = 0.0;
  none.floor_broken_every_px = none.upright_broken_every_px = none.unknown = none.false_per_image = 0.0;
  SyntheticVision vision(lines(), none, {}, 1);
  const auto image = vision.look(0.0, kIntrinsics, camera(), openFloor);
  const auto pieces = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  ASSERT_EQ(image.size(), pieces.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    EXPECT_NEAR((image[i].px.a - pieces[i].px.a).norm(), 0.0, 1e-9);
    EXPECT_NEAR((image[i].px.b - pieces[i].px.b).norm(), 0.0, 1e-9);
    EXPECT_EQ(image[i].label, lines().segments[static_cast<std::size_t>(pieces[i].edge)].label);
  }
}

TEST(SyntheticVision, ItsErrorsAreThoseItWasAskedFor) {
  VisionErrors errors;
  errors.found = 0.8;
  errors.half_px = 0.0;
  errors.soft_px = 1.0;
  errors.persistence = 0.0;
  errors.across_floor = {0.3, 0.4};
  errors.along_floor = {{}, 0.36, 6.0};
  errors.along_floor.scale_px.fill(0.6);
  errors.along_floor_median_px = -1.0;
  errors.lasting_s = 2.0;
  errors.floor_broken_every_px = errors.upright_broken_every_px = 0.0;
  errors.unknown = 0.0;
  errors.false_per_image = 0.4;
  SyntheticVision vision(lines(), errors, {}, 1);
  VisionStatistics statistics;
  constexpr int kImages = 3000;
  for (int i = 0; i < kImages; ++i) {
    statistics.add(0.1 * i, kIntrinsics, lines(), visiblePieces(lines(), kIntrinsics, camera(), openFloor),
                   vision.look(0.1 * i, kIntrinsics, camera(), openFloor));
  }
  // Two pieces an image, 6000 draws: three standard deviations of 0.8 are 0.016.
  EXPECT_NEAR(1.0 - statistics.missed(), 0.8, 0.016);
  EXPECT_NEAR(statistics.missedAgain(), statistics.missed(), 0.04);
  // The lasting part repeats over 2 s: 300 s hold some 150 independent values of each of it.
  EXPECT_NEAR(statistics.across(true).standardDeviation(), 0.5, 0.05);
  // 0.36 of the variance lasts, and e^-0.05 and e^-0.5 of that after 0.1 and 1 s.
  EXPECT_NEAR(statistics.across(true).correlation(0), 0.34, 0.08);
  EXPECT_NEAR(statistics.across(true).correlation(1), 0.22, 0.08);
  EXPECT_NEAR(statistics.across(true).correlation(3), 0.0, 0.1);
  // Of Student's t of two degrees of freedom half lie within 0.816, nine in ten within 2.92.
  EXPECT_NEAR(statistics.along(true).mean(), -1.0, 0.2);
  EXPECT_NEAR(statistics.along(true).within(0.5), 0.6 * 0.816, 0.05);
  EXPECT_NEAR(statistics.along(true).within(0.9), 0.6 * 2.92, 0.25);
  EXPECT_LE(statistics.along(true).within(1.0), 6.0 + 0.3);
  // Some false ones leave the image at once and become too short: a little less than asked.
  EXPECT_GT(statistics.falsePerImage(), 0.3);
  EXPECT_LT(statistics.falsePerImage(), 0.42);
  EXPECT_LT(statistics.wrongSideShare(), 0.01);
}

TEST(SyntheticVision, MissesPersist) {
  VisionErrors errors;
  errors.found = 0.5;
  errors.half_px = 0.0;
  errors.soft_px = 1.0;
  errors.persistence = 0.9;
  errors.false_per_image = 0.0;
  SyntheticVision vision(lines(), errors, {}, 1);
  VisionStatistics statistics;
  for (int i = 0; i < 3000; ++i) {
    statistics.add(0.1 * i, kIntrinsics, lines(), visiblePieces(lines(), kIntrinsics, camera(), openFloor),
                   vision.look(0.1 * i, kIntrinsics, camera(), openFloor));
  }
  // Two normals with correlation 0.9 are on one side of 0 with probability 1/2 + asin(0.9) / pi = 0.856.
  EXPECT_NEAR(statistics.missedAgain(), 0.856, 0.04);
}

TEST(SyntheticVision, FalseSegmentsHaveTheShareAskedFor) {
  VisionErrors errors;
  errors.false_per_image = 0.0;
  for (const double share : {0.3, 0.5}) {
    SyntheticVision vision(lines(), errors, {.false_share = share}, 1);
    VisionStatistics statistics;
    for (int i = 0; i < 3000; ++i) {
      statistics.add(0.1 * i, kIntrinsics, lines(), visiblePieces(lines(), kIntrinsics, camera(), openFloor),
                     vision.look(0.1 * i, kIntrinsics, camera(), openFloor));
    }
    EXPECT_NEAR(statistics.falseShare(), share, 0.03);
  }
}

TEST(SyntheticVision, SegmentsAreLostIndependently) {
  VisionErrors errors;
  errors.found = 1.0;
  errors.half_px = -1e3;
  errors.false_per_image = 0.0;
  errors.floor_broken_every_px = errors.upright_broken_every_px = 0.0;
  SyntheticVision vision(lines(), errors, {.lost_share = 0.5}, 1);
  std::size_t seen = 0;
  for (int i = 0; i < 2000; ++i) seen += vision.look(0.1 * i, kIntrinsics, camera(), openFloor).size();
  EXPECT_NEAR(static_cast<double>(seen) / 4000.0, 0.5, 0.03);
}

TEST(StandardNormal, HasMeanZeroAndVarianceOne) {
  RandomEngine engine(1);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) {
    const double value = standardNormal(engine);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.015);
}

}  // namespace
}  // namespace vismem
