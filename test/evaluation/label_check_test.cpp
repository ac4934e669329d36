// Detected segments find the map's edges that they lie on.
// Tests V3.
#include "evaluation/core/label_check.h"

#include <gtest/gtest.h>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A camera 0.5 m above the floor that looks along x, 20 degrees down.
const CameraIntrinsics kCamera = intrinsicsFromFieldOfView(320, 240, 1.0);
const Pose3 kPose =
    poseFromXyzRpy(0.0, 0.0, 0.5, 0.0, 0.35, 0.0) * poseFromXyzRpy(0, 0, 0, -M_PI_2, 0.0, -M_PI_2);
const Segment3 kFoot{{2.0, 0.5, 0.0}, {2.0, -0.5, 0.0}};
const Segment3 kTop{{2.0, 0.5, 0.08}, {2.0, -0.5, 0.08}};

SegmentMap skirting() {
  SegmentMap map;
  map.segments = {{kFoot, "foot"}, {kTop, "top"}, {{{1.0, 0.3, 0.0}, {1.0, -0.3, 0.0}}, kAnyLabel}};
  return map;
}

ImageSegment seen(const Segment3& edge, const Label& label, double lower_px = 0.0) {
  Segment2 px = *projectSegment(kCamera, kPose, edge);
  px.a.y() += lower_px;
  px.b.y() += lower_px;
  return {px, label, 50.0};
}

TEST(LabelCheck, CountsTheLengthOfEachFoundLabelByTheTrueOne) {
  LabelCheck check(skirting(), {});
  check.add({seen(kFoot, "foot", 0.5), seen(kTop, "foot"), seen(kTop, kUnknownLabel)}, kCamera, kPose);
  const LabelLengths& foot = check.lengths().at("foot");
  const LabelLengths& top = check.lengths().at("top");
  EXPECT_NEAR(foot.total_px(), seen(kFoot, "foot").px.length(), 1.0);
  EXPECT_DOUBLE_EQ(foot.share("foot"), 1.0);
  EXPECT_DOUBLE_EQ(top.share("top"), 0.0);
  EXPECT_NEAR(top.share("foot"), 0.5, 1e-9);
  EXPECT_NEAR(top.share(kUnknownLabel), 0.5, 1e-9);
}

TEST(LabelCheck, LeavesOutWhatLiesOnNoEdgeOrBetweenTwo) {
  LabelCheck check(skirting(), {});
  const double apart_px = seen(kFoot, "").px.a.y() - seen(kTop, "").px.a.y();
  ASSERT_GT(apart_px, 6.0);
  ASSERT_LT(apart_px, 14.0);
  check.add({seen(kFoot, "foot", 4.0), seen({{1.0, 0.3, 0.0}, {1.0, -0.3, 0.0}}, "foot")}, kCamera, kPose);
  EXPECT_TRUE(check.lengths().empty());
  LabelCheckParams wide;
  wide.distance_px = apart_px;
  LabelCheck between(skirting(), {}, wide);
  between.add({seen(kFoot, "foot", -0.5 * apart_px)}, kCamera, kPose);
  EXPECT_TRUE(between.lengths().empty());
}

TEST(LabelCheck, LeavesOutWhatABoxHides) {
  LabelCheck check(skirting(), {{{1.0, -0.6, 0.0}, {1.2, 0.6, 0.4}}});
  check.add({seen(kFoot, "foot")}, kCamera, kPose);
  EXPECT_TRUE(check.lengths().empty());
}

}  // namespace
}  // namespace vismem
