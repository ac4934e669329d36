// Tests E5, E6.
#include "experiments/trials/synthetic_vision.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "experiments/trials/visible_scene.h"
#include "experiments/trials/vision_statistics.h"

namespace vismem {
namespace {

/// Images of errors from the camera that stands still; several runs.
VisionStatistics statisticsOf(const SegmentMap& map, const VisionErrors& errors, int runs, int images,
                              const CastRay& cast = openFloor) {
  VisionStatistics statistics;
  for (int run = 0; run < runs; ++run) {
    SyntheticVision vision(map, errors, {}, static_cast<std::uint64_t>(run + 1), 1);
    statistics.beginRun();
    for (int i = 0; i < images; ++i) {
      statistics.add(0.1 * i, kIntrinsics, map, visiblePieces(map, kIntrinsics, camera(), cast),
                     vision.observe(0.1 * i, kIntrinsics, camera(), cast));
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
                   vision.observe(0.1 * i, kIntrinsics, cameraBesideTheCorner(), blockBeforeAWall));
  }
  EXPECT_NEAR(statistics.outlinesPerImage(), 1.0, 1e-9);
  EXPECT_NEAR(statistics.outlinesFound(), 0.7, 0.035);
  for (const double share : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(statistics.atOutline(true).quantile(share), kMeasuredOutlineFoot.at(share), 0.15);
    EXPECT_NEAR(statistics.atOutline(false).quantile(share), kMeasuredOutlineTop.at(share), 0.15);
  }
  // Segments on an outline are not false.
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
  const auto image = vision.observe(0.0, kIntrinsics, camera(), openFloor);
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
                   vision.observe(0.1 * i, kIntrinsics, camera(), openFloor));
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
                     vision.observe(0.1 * i, kIntrinsics, camera(), openFloor));
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
  for (int i = 0; i < 2000; ++i) seen += vision.observe(0.1 * i, kIntrinsics, camera(), openFloor).size();
  EXPECT_NEAR(static_cast<double>(seen) / 4000.0, 0.5, 0.03);
}

}  // namespace
}  // namespace vismem
