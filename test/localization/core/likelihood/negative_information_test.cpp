// Tests L12.
#include "localization/core/likelihood/negative_information.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

const std::vector<std::string> kOpaque{"skirting", "*_foot"};

/// A wall ahead, and a marking on the floor before it.
class NegativeInformationTest : public testing::Test {
 protected:
  NegativeInformationTest() {
    both_.segments = {wall(2.5, -3, 2.5, 3), wall(1.5, -0.4, 1.5, 0.4, "line")};
    wall_only_.segments = {both_.segments[0]};
  }
  /// The penalty at the origin for an image of `shown`, with both segments in the map.
  double penalty(const SegmentMap& shown, NegativeInformation& negative) {
    const MemoryUpdate update = test::viewFrom(shown, {0, 0, 0}, kSecondUs, 0.0, degToRad(-15));
    negative.observe(*update.analysis, observeImage(*update.analysis, index_, {}));
    return negative.logPenalty({0, 0, 0});
  }

  SegmentMap both_;
  SegmentMap wall_only_;
  MapIndex index_{[] {
                    SegmentMap map;
                    map.segments = {wall(2.5, -3, 2.5, 3), wall(1.5, -0.4, 1.5, 0.4, "line")};
                    return map;
                  }(),
                  {}};
  NegativeInformation negative_{index_, {}, ObservationParams{}.image_range_m, kOpaque};
};

TEST_F(NegativeInformationTest, AnObservedSegmentHasNoPenalty) {
  EXPECT_NEAR(penalty(both_, negative_), 0.0, 1e-9);
}

TEST_F(NegativeInformationTest, AMissingSegmentCostsAtMostLogHalf) {
  penalty(both_, negative_);  // this camera can see lines
  const double missing = penalty(wall_only_, negative_);
  EXPECT_LT(missing, -0.3);
  EXPECT_GE(missing, std::log(0.5) - 1e-9);
}

TEST_F(NegativeInformationTest, ALabelNeverDetectedHasNoPenalty) {
  EXPECT_NEAR(penalty(wall_only_, negative_), 0.0, 1e-9);
}

TEST_F(NegativeInformationTest, AnOccludedCameraHasNoPenalty) {
  penalty(both_, negative_);
  EXPECT_EQ(penalty(SegmentMap{}, negative_), 0.0);
}

TEST_F(NegativeInformationTest, ASegmentOutsideTheImageHasNoPenalty) {
  penalty(both_, negative_);
  const MemoryUpdate update = test::viewFrom(wall_only_, {0, 0, 0}, kSecondUs, 0.0, degToRad(-15));
  negative_.observe(*update.analysis, observeImage(*update.analysis, index_, {}));
  // Looking the other way nothing of the map is in view.
  EXPECT_EQ(negative_.logPenalty({0, 0, degToRad(180)}), 0.0);
}

TEST_F(NegativeInformationTest, ASegmentBehindAnUnknownObjectHasNoPenalty) {
  penalty(both_, negative_);
  ImageAnalysis view = *test::viewFrom(wall_only_, {0, 0, 0}, kSecondUs, 0.0, degToRad(-15)).analysis;
  SegmentMap box;  // an object of unknown label 1 m ahead
  box.segments = {wall(1.0, -0.5, 1.0, 0.5, kUnknownLabel)};
  test::addMapSegments(view, box, {0, 0, 0});
  negative_.observe(view, observeImage(view, index_, {}));
  EXPECT_NEAR(negative_.logPenalty({0, 0, 0}), 0.0, 1e-9);
}

TEST_F(NegativeInformationTest, ASegmentBehindAWallHasNoPenalty) {
  SegmentMap map;
  map.segments = {wall(2.5, -3, 2.5, 3), wall(3.5, -1, 3.5, 1, "line")};
  const MapIndex index(map, {});
  NegativeInformation negative(index, {}, ObservationParams{}.image_range_m, kOpaque);
  SegmentMap line;
  line.segments = {map.segments[1]};
  for (const SegmentMap* shown : {&line, &wall_only_}) {  // first: lines can be seen
    const MemoryUpdate update = test::viewFrom(*shown, {0, 0, 0}, kSecondUs, 0.0, degToRad(-15));
    negative.observe(*update.analysis, observeImage(*update.analysis, index, {}));
  }
  EXPECT_NEAR(negative.logPenalty({0, 0, 0}), 0.0, 1e-9);
}

}  // namespace
}  // namespace vismem
