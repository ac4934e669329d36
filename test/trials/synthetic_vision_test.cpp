#include "experiments/trials/synthetic_vision.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <utility>

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

/// A post covers the middle third of the cross line at x = 2: rays with |y / x| < 0.0833 end at 1.5 m.
std::optional<SeenSurface> floorBehindAPost(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (std::abs(direction.y() / direction.x()) < 1.0 / 12.0) return SeenSurface{1.5, 0.5};
  return openFloor(origin, direction);
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
  SegmentMap cross;
  cross.segments = {lines().segments[1]};
  const auto pieces = visiblePieces(cross, kIntrinsics, camera(), floorBehindAPost);
  ASSERT_EQ(pieces.size(), 2u);
  const auto whole = projectSegment(kIntrinsics, camera(), cross.segments[0].world);
  const double third = whole->length() / 3.0;
  EXPECT_NEAR(pieces[0].px.length(), third, 0.5);
  EXPECT_NEAR(pieces[1].px.length(), third, 0.5);
  for (const VisiblePiece& piece : pieces) EXPECT_NE(piece.hidden_a, piece.hidden_b);
}

/// Images of errors from the camera that stands still; several runs.
VisionStatistics statisticsOf(const SegmentMap& map, const VisionErrors& errors, int runs, int images,
                              const CastRay& cast = openFloor) {
  VisionStatistics statistics;
  for (int run = 0; run < runs; ++run) {
    SyntheticVision vision(map, errors, {}, static_cast<std::uint64_t>(run + 1), 1);
    statistics.beginRun();
    for (int i = 0; i < images; ++i) {
      statistics.add(0.1 * i, kIntrinsics, map, visiblePieces(map, kIntrinsics, camera(), cast),
                     vision.look(0.1 * i, kIntrinsics, camera(), cast));
    }
  }
  return statistics;
}

VisionErrors withoutMisses() {
  VisionErrors errors;
  errors.found = 1.0;
  errors.half_px = -1e3;
  errors.floor_broken_every_px = errors.upright_broken_every_px = 0.0;
  errors.unknown = errors.false_per_image = 0.0;
  return errors;
}

/// A block of walls with its corner at (2, 0), and a wall across at x = 5 behind it.
std::optional<SeenSurface> blockBeforeAWall(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const double to_front = (2.0 - origin.x()) / direction.x();
  const Eigen::Vector3d front = origin + to_front * direction;
  if (front.y() <= 0.0 && front.z() > 0.0) return SeenSurface{to_front, 0.9};
  const double to_back = (5.0 - origin.x()) / direction.x();
  if ((origin + to_back * direction).z() > 0.0) return SeenSurface{to_back, 0.9};
  return SeenSurface{-origin.z() / direction.z(), 0.2};
}

Pose3 cameraBesideTheCorner() {
  return cameraPose({poseFromXyzRpy(0, -0.3, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-15.0));
}

SegmentMap corner() {
  SegmentMap map;
  map.segments = {{{{2.0, -1.0, 0.0}, {2.0, 0.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, 0.0, 0.0}, {4.0, 0.0, 0.0}}, "skirting", 0.0}};
  return map;
}

TEST(VisibleOutlines, RiseFromACornerAsFarAsFloorIsSeenBehindIt) {
  const auto outlines = visibleOutlines(corner(), kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall);
  ASSERT_EQ(outlines.size(), 1u);
  // The line of sight over (2, 0, h) from 0.45 m meets the floor at x = 5 when h = 0.45 (1 - 2 / 5).
  const auto expected =
      projectSegment(kIntrinsics, cameraBesideTheCorner(), {{2.0, 0.0, 0.0}, {2.0, 0.0, 0.27}});
  ASSERT_TRUE(expected);
  EXPECT_TRUE(outlines[0].is_outline);
  // Brighter on the left: the wall lies to the right of it in the image, so it runs down.
  EXPECT_NEAR((outlines[0].px.a - expected->b).norm(), 0.0, 1.0);
  EXPECT_NEAR((outlines[0].px.b - expected->a).norm(), 0.0, 1.0);
}

TEST(VisibleOutlines, AreNoneWhereTheMapHasTheUprightEdgeOrNoFloorIsSeen) {
  SegmentMap with_upright = corner();
  with_upright.segments.push_back({{{2.0, 0.0, 0.0}, {2.0, 0.0, 2.0}}, "door_jamb", 0.0});
  EXPECT_TRUE(visibleOutlines(with_upright, kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall).empty());
  EXPECT_TRUE(visibleOutlines(corner(), kIntrinsics, cameraBesideTheCorner(), openFloor).empty());
}

TEST(SyntheticVision, SeesOutlinesOfWallsAsTheirFoot) {
  VisionErrors errors;
  errors.false_per_image = 0.0;
  errors.outlines_found = 0.7;
  errors.persistence = 0.0;
  SyntheticVision vision(corner(), errors, {}, 1, 1);
  VisionStatistics statistics;
  auto visible = visiblePieces(corner(), kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall);
  const auto outlines = visibleOutlines(corner(), kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall);
  visible.insert(visible.end(), outlines.begin(), outlines.end());
  for (int i = 0; i < 2000; ++i) {
    statistics.add(0.1 * i, kIntrinsics, corner(), visible,
                   vision.look(0.1 * i, kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall));
  }
  EXPECT_NEAR(statistics.outlinesPerImage(), 1.0, 1e-9);
  EXPECT_NEAR(statistics.outlinesFound(), 0.7, 0.035);
  for (const double share : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(statistics.atOutline(true).quantile(share), kMeasuredOutlineFoot.at(share), 0.15);
    EXPECT_NEAR(statistics.atOutline(false).quantile(share), kMeasuredOutlineTop.at(share), 0.15);
  }
  // What is explained by an outline is not false.
  EXPECT_LT(statistics.falsePerImage(), 0.02);
}

TEST(SyntheticVision, FalseSegmentsHaveLabelsOfTheFloorAsOftenAsAsked) {
  SegmentMap map = corner();
  map.segments.push_back({{{3.0, 1.0, 0.0}, {3.0, 1.0, 2.0}}, "door_jamb", 0.0});
  VisionErrors errors = withoutMisses();
  errors.false_per_image = 1.0;
  errors.false_on_floor = 0.3;
  const VisionStatistics statistics = statisticsOf(map, errors, 1, 3000);
  EXPECT_NEAR(statistics.falseOnFloorShare(), 0.3, 0.03);
}

TEST(SyntheticVision, WithoutErrorsIsTheTruth) {
  VisionErrors none;
  none.found = 1.0;
  none.half_px = -1e3;
  none.across_floor = none.along_floor = {};
  none.across_upright = none.along_upright = {};
  none.hidden_end = {};
  none.along_upright_mean_px = none.border_px = 0.0;
  none.floor_broken_every_px = none.upright_broken_every_px = none.unknown = none.false_per_image = 0.0;
  SyntheticVision vision(lines(), none, {}, 1, 1);
  const auto image = vision.look(0.0, kIntrinsics, camera(), openFloor);
  const auto pieces = visiblePieces(lines(), kIntrinsics, camera(), openFloor);
  ASSERT_EQ(image.size(), pieces.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    EXPECT_NEAR((image[i].px.a - pieces[i].px.a).norm(), 0.0, 1e-9);
    EXPECT_NEAR((image[i].px.b - pieces[i].px.b).norm(), 0.0, 1e-9);
    EXPECT_EQ(image[i].label, lines().segments[static_cast<std::size_t>(pieces[i].edge)].label);
  }
}

/// Of normal variables with this correlation, that of their ranks.
double spearman(double correlation) {
  return 6.0 / std::numbers::pi * std::asin(0.5 * correlation);
}

TEST(ErrorQuantiles, AreTheErrorsAtTheirSharesAndBetweenThemInProportion) {
  const ErrorQuantiles& errors = kMeasuredAlongFloor[1];
  for (std::size_t i = 0; i < ErrorQuantiles::kShares.size(); ++i) {
    EXPECT_DOUBLE_EQ(errors.at(ErrorQuantiles::kShares[i]), errors.px[i]);
  }
  EXPECT_DOUBLE_EQ(errors.at(0.625), 0.5 * (errors.px[5] + errors.px[6]));
  EXPECT_EQ(errors.at(0.0), errors.px.front());
  EXPECT_EQ(errors.at(1.0), errors.px.back());
}

TEST(SyntheticVision, ItsErrorsAreThoseItWasAskedFor) {
  VisionErrors errors;
  errors.found = 0.8;
  errors.half_px = 0.0;
  errors.soft_px = 1.0;
  errors.persistence = 0.0;
  errors.floor_broken_every_px = errors.upright_broken_every_px = 0.0;
  errors.unknown = 0.0;
  errors.false_per_image = 0.4;
  const VisionStatistics statistics = statisticsOf(lines(), errors, 1, 3000);
  // Two pieces an image, 6000 draws: three standard deviations of 0.8 are 0.016.
  EXPECT_NEAR(1.0 - statistics.missed(), 0.8, 0.016);
  EXPECT_NEAR(statistics.missedAgain(), statistics.missed(), 0.04);
  // Some false ones leave the image at once and become too short: a little less than asked.
  EXPECT_GT(statistics.falsePerImage(), 0.3);
  EXPECT_LT(statistics.falsePerImage(), 0.42);
  EXPECT_LT(statistics.wrongSideShare(), 0.01);
}

TEST(SyntheticVision, EndsErrAsMeasuredSkewAndTailsAndAll) {
  VisionErrors errors = withoutMisses();
  errors.across_floor.same = errors.along_floor.same = {};
  const VisionStatistics statistics = statisticsOf(lines(), errors, 1, 8000);
  std::size_t bins = 0;
  for (std::size_t bin = 0; bin < VisionStatistics::kRanges_m.size(); ++bin) {
    const LastingError& along = statistics.alongByRange()[bin];
    const LastingError& across = statistics.acrossByRange()[bin];
    if (along.count() == 0) continue;
    ++bins;
    for (std::size_t i = 0; i < ErrorQuantiles::kShares.size(); ++i) {
      const double share = ErrorQuantiles::kShares[i];
      // A quantile of n errors lies between those of shares that differ by three standard deviations.
      const double off = 3.0 * std::sqrt(share * (1.0 - share) / along.count());
      for (const auto& [is, asked] : {std::pair(along.quantile(share), kMeasuredAlongFloor[bin]),
                                      std::pair(across.quantile(share), kMeasuredAcrossFloor[bin])}) {
        EXPECT_GE(is, asked.at(share - off) - 0.03) << "bin " << bin << ", share " << share;
        EXPECT_LE(is, asked.at(share + off) + 0.03) << "bin " << bin << ", share " << share;
      }
    }
  }
  EXPECT_GE(bins, 1u);
}

TEST(SyntheticVision, ErrorsLastAsLongAsAskedAndThoseOfTheMapInEveryRun) {
  SegmentMap many;
  for (int i = 0; i < 30; ++i) {
    const double y = -0.6 + 0.04 * i;
    many.segments.push_back({{{1.6, y, 0.0}, {2.2, y, 0.0}}, "skirting", 0.0});
  }
  VisionErrors errors = withoutMisses();
  errors.along_floor.same = {0.4, 0.3, 2.0};
  errors.across_floor.same = {0.5, 0.0, 1.0};
  // Neighbours may be taken for each other where ends err by much.
  for (ErrorQuantiles& range : errors.along_floor.px) range = errors.hidden_end;
  for (ErrorQuantiles& range : errors.across_floor.px) range = kMeasuredAcrossFloor[2];
  const VisionStatistics statistics = statisticsOf(many, errors, 4, 300);
  const LastingError& along = statistics.along(true);
  // 60 ends have each one value of the map's error: a standard deviation of its variance is a fifth.
  EXPECT_NEAR(along.correlation(0), spearman(0.4 + 0.3 * std::exp(-0.05)), 0.1);
  EXPECT_NEAR(along.correlation(1), spearman(0.4 + 0.3 * std::exp(-0.5)), 0.1);
  EXPECT_NEAR(along.correlation(3), spearman(0.4), 0.1);
  EXPECT_NEAR(along.correlationBetweenRuns(), spearman(0.4), 0.1);
  EXPECT_GT(along.correlation(0), along.correlation(1) + 0.05);
  EXPECT_GT(along.correlation(1), along.correlation(3) + 0.05);
  EXPECT_NEAR(statistics.across(true).correlation(0), spearman(0.5), 0.15);
  EXPECT_NEAR(statistics.across(true).correlationBetweenRuns(), spearman(0.5), 0.15);
}

TEST(SyntheticVision, AnEndThatIsHiddenErrsAsHiddenEndsDo) {
  SegmentMap cross;
  cross.segments = {lines().segments[1]};
  const VisionStatistics statistics = statisticsOf(cross, withoutMisses(), 1, 3000, floorBehindAPost);
  EXPECT_EQ(statistics.atHidden().count(), 6000);
  EXPECT_EQ(statistics.along(true).count(), 6000);
  EXPECT_NEAR(statistics.atHidden().quantile(0.5), kMeasuredHidden.at(0.5), 0.2);
  EXPECT_NEAR(statistics.atHidden().quantile(0.9), kMeasuredHidden.at(0.9), 0.25);
}

TEST(SyntheticVision, MissesPersist) {
  VisionErrors errors;
  errors.found = 0.5;
  errors.half_px = 0.0;
  errors.soft_px = 1.0;
  errors.persistence = 0.9;
  errors.false_per_image = 0.0;
  SyntheticVision vision(lines(), errors, {}, 1, 1);
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
    SyntheticVision vision(lines(), errors, {.false_share = share}, 1, 1);
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
  SyntheticVision vision(lines(), errors, {.lost_share = 0.5}, 1, 1);
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
