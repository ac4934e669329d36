// Choice of the model, evidence, and what is refused. Tests B5.
#include "calibration/core/lens/lens_calibration.h"

#include <gmock/gmock.h>

#include "support/lens_trials.h"

namespace vismem {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Three standard deviations of the worst place: 0.13 px with 25 views of corners good to 0.05 px.
constexpr double kWorst_px = 0.4;

CameraIntrinsics lensWith(double k1, double k2, double p1) {
  CameraIntrinsics lens = intrinsicsFromFieldOfView(640, 480, 1.1);
  lens.k1 = k1;
  lens.k2 = k2;
  lens.p1 = p1;
  return lens;
}

/// Views spread over the image. @param change share by which the focal length of a view differs.
std::vector<BoardView> viewsOf(const CameraIntrinsics& lens, const BoardSpec& board, unsigned seed,
                               double change = 0.0, double bow_m = 0.0) {
  std::mt19937 random(seed);
  const PixelGrid places = pixelGrid(lens.width, lens.height, 5, 5);
  std::vector<BoardView> views;
  constexpr int kViews = 25;
  for (int i = 0; i < kViews; ++i) {
    CameraIntrinsics now = lens;
    const double factor = 1.0 + change * (static_cast<double>(i % 5) - 2.0);
    now.fx *= factor;
    now.fy *= factor;
    BoardScene scene =
        drawScene(now, board, places.px[static_cast<std::size_t>(7 * i) % places.px.size()], random);
    scene.bow_m = bow_m;
    views.push_back(projectedView(now, scene, 0.05, random));
  }
  return views;
}

LensCalibration calibrated(const CameraIntrinsics& lens, unsigned seed) {
  auto result = calibrateLens(BoardSpec{}, viewsOf(lens, BoardSpec{}, seed), 640, 480);
  EXPECT_TRUE(result.calibration) << result.refusal;
  return result.calibration.value_or(LensCalibration{});
}

/// The chosen model; its projection must be right within what it states.
LensModel chosenFor(const CameraIntrinsics& truth, unsigned seed) {
  const LensCalibration found = calibrated(truth, seed);
  if (found.scores.empty()) return LensModel::kPinhole;  // refused: reported above
  for (const ModelScore& score : found.scores) EXPECT_LE(found.held_out_rms_px, score.held_out_rms_px);
  const double error_px = projectionDifference(truth, found.fit.lens, pixelGrid(640, 480)).worst_px;
  EXPECT_LT(error_px, 4.0 * found.uncertainty.sigma_px[found.uncertainty.worst]) << nameOf(found.fit.model);
  return found.fit.model;
}

TEST(CalibrateLens, ChoosesAModelThatHoldsTheLens) {
  chosenFor(lensWith(0.0, 0.0, 0.0), 1);
  EXPECT_GE(chosenFor(lensWith(-0.25, 0.05, 0.0), 2), LensModel::kRadial);
  EXPECT_GE(chosenFor(lensWith(-0.25, 0.05, 0.002), 3), LensModel::kTangential);
  // Weak: 0.3 px in the corners of the image.
  EXPECT_GE(chosenFor(lensWith(-0.2, 0.02, 0.0005), 5), LensModel::kTangential);
}

TEST(CalibrateLens, GivesTheEvidence) {
  const CameraIntrinsics truth = lensWith(-0.25, 0.05, 0.0);
  int steps = 0;
  const auto views = viewsOf(truth, BoardSpec{}, 4);
  const auto result = calibrateLens(BoardSpec{}, views, 640, 480, [&](int done, int all) {
    EXPECT_LE(done, all);
    ++steps;
  });
  ASSERT_TRUE(result.calibration) << result.refusal;
  const LensCalibration& found = *result.calibration;
  EXPECT_GT(steps, 10);
  EXPECT_EQ(found.scores.size(), 4u);
  EXPECT_LT(found.heldOutRatio(), kMaxHeldOutRatio);
  EXPECT_GT(found.heldOutRatio(), 0.95);
  ASSERT_TRUE(found.halves);
  EXPECT_LT(found.halves->p90_px, found.halves->worst_px);
  EXPECT_LT(found.halves->worst_px, 1.0);
  EXPECT_GT(found.coverage, 0.7);
  EXPECT_EQ(found.focal_change, 0.0);
  EXPECT_THAT(found.warnings, IsEmpty());
  EXPECT_LT(projectionDifference(truth, found.fit.lens, pixelGrid(640, 480)).worst_px, kWorst_px);
}

// Printed at 97 %, and nobody typed it in: the lens does not depend on the board's size.
TEST(CalibrateLens, APrinterThatScalesBothWaysDoesNotMatter) {
  const CameraIntrinsics truth = lensWith(-0.25, 0.05, 0.0);
  BoardSpec printed;
  printed.square_m *= 0.97;
  const auto result = calibrateLens(BoardSpec{}, viewsOf(truth, printed, 5), 640, 480);
  ASSERT_TRUE(result.calibration) << result.refusal;
  EXPECT_LT(projectionDifference(truth, result.calibration->fit.lens, pixelGrid(640, 480)).worst_px,
            kWorst_px);
}

TEST(CalibrateLens, APrinterThatScalesOneWayIsNoticed) {
  BoardSpec printed;
  printed.square_m.x() *= 0.97;
  const auto views = viewsOf(lensWith(-0.25, 0.05, 0.0), printed, 6);
  const auto wrong = calibrateLens(BoardSpec{}, views, 640, 480);
  ASSERT_TRUE(wrong.calibration) << wrong.refusal;
  EXPECT_THAT(wrong.calibration->warnings, Contains(HasSubstr("measured both ways")));
  const auto right = calibrateLens(printed, views, 640, 480);
  ASSERT_TRUE(right.calibration) << right.refusal;
  EXPECT_THAT(right.calibration->warnings, IsEmpty());
}

TEST(CalibrateLens, ABentBoardIsNamed) {
  const CameraIntrinsics truth = lensWith(-0.25, 0.05, 0.0);
  const auto result = calibrateLens(BoardSpec{}, viewsOf(truth, BoardSpec{}, 7, 0.0, 0.002), 640, 480);
  ASSERT_TRUE(result.calibration) << result.refusal;
  EXPECT_THAT(result.calibration->warnings, Contains(HasSubstr("the board is bent by")));
  EXPECT_LT(projectionDifference(truth, result.calibration->fit.lens, pixelGrid(640, 480)).worst_px,
            kWorst_px);
}

TEST(CalibrateLens, RefusesAFocalLengthThatChanges) {
  const auto result =
      calibrateLens(BoardSpec{}, viewsOf(lensWith(-0.2, 0.03, 0.0), BoardSpec{}, 8, 0.01), 640, 480);
  EXPECT_FALSE(result.calibration);
  EXPECT_THAT(result.refusal, HasSubstr("switch off autofocus"));
}

TEST(CalibrateLens, RefusesLensesThatAreTooWide) {
  const CameraIntrinsics wide = intrinsicsFromFieldOfView(640, 480, 1.92);  // 110 degrees
  const auto result = calibrateLens(BoardSpec{}, viewsOf(wide, BoardSpec{}, 9), 640, 480);
  EXPECT_FALSE(result.calibration);
  EXPECT_THAT(result.refusal, HasSubstr("sees 110 degrees across: above 100 degrees"));
}

TEST(CalibrateLens, NeedsViews) {
  const auto result = calibrateLens(BoardSpec{}, {}, 640, 480);
  EXPECT_FALSE(result.calibration);
  EXPECT_THAT(result.refusal, HasSubstr("0 views"));
}

// (3^2 + 0.45^2) / 0.45 = 20.45 m a radian; 0.3 px of 554 are 0.5415 mrad: 11.07 mm.
TEST(FloorError, IsTheShiftOfAFloorPoint) {
  CameraIntrinsics lens = lensWith(0, 0, 0);
  lens.fx = lens.fy = 554.0;
  EXPECT_NEAR(floorError_m(lens, 0.3, 3.0, 0.45), 0.01107, 1e-5);
}

TEST(LensSession, AcceptsStillSharpAndNewViewsOnly) {
  std::mt19937 random(10);
  const CameraIntrinsics lens = lensWith(0, 0, 0);
  const BoardSpec board;
  LensSession session(board, 640, 480);
  EXPECT_THAT(session.progress().advice, HasSubstr("Show the board"));
  const BoardView view = projectedView(lens, drawScene(lens, board, {320, 240}, random), 0.0, random);
  EXPECT_EQ(session.offer({}, 0.0), ViewVerdict::kNoBoard);
  EXPECT_EQ(session.offer(view, 0.8), ViewVerdict::kMoving);
  BoardView moved = view;
  for (auto& corner : moved.corners) corner.pixel.x() += 1.0;
  EXPECT_EQ(session.offer(moved, 0.8), ViewVerdict::kMoving);
  for (auto& corner : moved.corners) corner.pixel.x() += 0.1;
  EXPECT_EQ(session.offer(moved, 3.0), ViewVerdict::kBlurred);
  EXPECT_EQ(session.offer(moved, 0.8), ViewVerdict::kAccepted);
  EXPECT_EQ(session.offer(moved, 0.8), ViewVerdict::kKnown);
  BoardView few = moved;
  few.corners.resize(5);
  EXPECT_EQ(session.offer(few, 0.8), ViewVerdict::kFewCorners);
  // Each reason reads differently.
  EXPECT_THAT(describe(ViewVerdict::kMoving), Not(describe(ViewVerdict::kKnown)));
}

TEST(LensSession, AdviceLeadsToEnough) {
  const CameraIntrinsics lens = lensWith(-0.2, 0.03, 0.0);
  const BoardSpec board;
  LensSessionParams params;
  params.max_motion_px = 0.0;
  LensSession session(board, 640, 480, params);
  BoardHolder holder(lens, board, false, 11);
  const int images = holder.hold(session, 80);
  EXPECT_TRUE(session.progress().is_enough) << session.progress().advice;
  EXPECT_GE(session.views().size(), 12u);
  EXPECT_LT(images, 60);
  EXPECT_THAT(session.progress().advice, HasSubstr("Enough"));
}

TEST(LensSession, FrontalViewsAreSentAslant) {
  const CameraIntrinsics lens = lensWith(0, 0, 0);
  const BoardSpec board;
  LensSessionParams params;
  params.max_motion_px = 0.0;
  LensSession session(board, 640, 480, params);
  std::mt19937 random(12);
  for (int i = 0; i < 6; ++i) {
    BoardScene scene;
    scene.T_camera_board =
        boardPose(lens, {0.126, 0.084, 0.0}, {200.0 + 50.0 * i, 240.0}, 0.5, 0.02, 0.0, 0.1 * i);
    session.offer(projectedView(lens, scene, 0.05, random), 0.8);
  }
  ASSERT_EQ(session.views().size(), 6u);
  EXPECT_FALSE(session.progress().is_enough);
  EXPECT_THAT(session.progress().advice, HasSubstr("Slant the board"));
}

}  // namespace
}  // namespace vismem
