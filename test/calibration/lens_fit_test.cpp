// Fits to exact corners with known noise: the truth is the projection of common/geometry.
#include "calibration/core/lens/lens_fit.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "calibration/core/lens/board_pose.h"
#include "calibration/core/lens/projection_grid.h"
#include "support/lens_trials.h"

namespace vismem {
namespace {

using ::testing::HasSubstr;

CameraIntrinsics lens60() {
  CameraIntrinsics lens = intrinsicsFromFieldOfView(640, 480, 1.047);
  lens.cx += 6.0;
  lens.cy -= 4.0;
  lens.fy *= 1.003;
  lens.k1 = -0.2;
  lens.k2 = 0.03;
  return lens;
}

std::vector<BoardView> viewsOf(const CameraIntrinsics& lens, const BoardSpec& board, int count,
                               double sigma_px, std::mt19937& random, double bow_m = 0.0) {
  std::vector<BoardView> views;
  const PixelGrid places = pixelGrid(lens.width, lens.height, 5, 5);
  for (int i = 0; i < count; ++i) {
    BoardScene scene =
        drawScene(lens, board, places.px[static_cast<std::size_t>(7 * i) % places.px.size()], random);
    scene.bow_m = bow_m;
    views.push_back(projectedView(lens, scene, sigma_px, random));
  }
  return views;
}

TEST(LensModel, ProjectsAsTheProjectsCamera) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 50; ++i) {
    CameraIntrinsics lens = lens60();
    lens.p1 = 0.002 * unit(random);
    lens.p2 = 0.002 * unit(random);
    lens.k3 = 0.1 * unit(random);
    const Eigen::Vector3d p(unit(random), 0.7 * unit(random), 1.5);
    Eigen::Vector2d px;
    projectThroughLens(lensVector(lens).data(), p.data(), px.data());
    EXPECT_LT((px - distortPixel(lens, *projectToIdeal(lens, p))).norm(), 1e-9);
    EXPECT_EQ(lensFrom(lensVector(lens), 640, 480), lens);
  }
}

TEST(BoardPose, ComesFromFourOrMoreCornersOnly) {
  std::mt19937 random(2);
  const BoardSpec board;
  const CameraIntrinsics lens = lens60();
  const BoardScene scene = drawScene(lens, board, {320, 240}, random);
  BoardView view = projectedView(lens, scene, 0.0, random);
  const auto pose = boardPoseFrom(lens, board, view);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation() - scene.T_camera_board.translation()).norm(), 1e-3);
  EXPECT_LT((pose->linear() - scene.T_camera_board.linear()).norm(), 1e-2);
  // Corners of one row only.
  std::erase_if(view.corners, [&](const BoardCorner& corner) { return corner.id >= board.cornerColumns(); });
  EXPECT_FALSE(boardPoseFrom(lens, board, view));
  view.corners.resize(std::min<std::size_t>(3, view.corners.size()));
  EXPECT_FALSE(boardPoseFrom(lens, board, view));
}

TEST(LensFit, FindsTheLensFromExactCorners) {
  std::mt19937 random(3);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  const auto views = viewsOf(truth, board, 12, 0.0, random);
  const auto result = fitLens(board, views, 640, 480, {LensModel::kFull, false, std::nullopt});
  ASSERT_TRUE(result.fit) << result.problem;
  EXPECT_LT(projectionDifference(truth, result.fit->lens, pixelGrid(640, 480)).worst_px, 0.02);
  EXPECT_LT(result.fit->rms_px, 1e-3);
  EXPECT_NEAR(result.fit->lens.fx, truth.fx, 0.1);
}

TEST(LensFit, StartsByItselfForEveryDrawnLens) {
  const BoardSpec board;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(100 + seed);
    const CameraIntrinsics truth = drawLens(random);
    const auto views = viewsOf(truth, board, 20, 0.05, random);
    const auto result = fitLens(board, views, 640, 480, {LensModel::kTangential, false, std::nullopt});
    ASSERT_TRUE(result.fit) << "seed " << seed << ": " << result.problem;
    // Narrow lenses are known to 0.25 px in the worst place by 20 such views.
    EXPECT_LT(projectionDifference(truth, result.fit->lens, pixelGrid(640, 480)).worst_px, 0.8)
        << "seed " << seed << ", k1 " << truth.k1 << ", fx " << truth.fx;
    EXPECT_LT(result.fit->rms_px, 0.09) << "seed " << seed;
  }
}

// Normalised errors over many draws of the noise: mean of e' P^-1 e over its dimensions is 1.
TEST(LensFit, ReportsAnHonestCovariance) {
  std::mt19937 random(4);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  double sum = 0.0;
  constexpr int kDraws = 25;
  constexpr int kFree = 8;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto views = viewsOf(truth, board, 15, 0.1, random);
    const auto result = fitLens(board, views, 640, 480, {LensModel::kTangential, true, truth});
    ASSERT_TRUE(result.fit);
    const LensVector error = lensVector(result.fit->lens) - lensVector(truth);
    const Eigen::Matrix<double, kFree, kFree> P = result.fit->P_lens.topLeftCorner<kFree, kFree>();
    sum += error.head<kFree>().dot(P.inverse() * error.head<kFree>()) / kFree;
  }
  // The mean of 25 * 8 squares of normal numbers has a standard deviation of 0.1.
  EXPECT_NEAR(sum / kDraws, 1.0, 0.3);
}

TEST(LensFit, LeavesOutCornersThatAreWrong) {
  std::mt19937 random(5);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  auto views = viewsOf(truth, board, 12, 0.05, random);
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].corners[3 + i % 5].pixel += Eigen::Vector2d(4.0, -3.0);
  const auto result = fitLens(board, views, 640, 480, {LensModel::kTangential, false, std::nullopt});
  ASSERT_TRUE(result.fit) << result.problem;
  EXPECT_GE(result.fit->outliers, 12);
  EXPECT_LE(result.fit->outliers, 15);
  for (std::size_t i = 0; i < views.size(); ++i) EXPECT_FALSE(result.fit->views[i].is_used[3 + i % 5]);
  EXPECT_LT(projectionDifference(truth, result.fit->lens, pixelGrid(640, 480)).worst_px, 0.5);
}

TEST(LensFit, ABentBoardIsEstimated) {
  std::mt19937 random(6);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  const auto views = viewsOf(truth, board, 20, 0.05, random, 0.002);
  const auto bent = fitLens(board, views, 640, 480, {LensModel::kTangential, false, std::nullopt});
  ASSERT_TRUE(bent.fit);
  EXPECT_NEAR(bent.fit->bow_m.x(), 0.002, 0.0003);
  EXPECT_NEAR(bent.fit->bow_m.y(), 0.0, 0.0003);
  EXPECT_LT(projectionDifference(truth, bent.fit->lens, pixelGrid(640, 480)).worst_px, 0.5);
  const auto flat = fitLens(board, views, 640, 480, {LensModel::kTangential, true, std::nullopt});
  ASSERT_TRUE(flat.fit);
  EXPECT_GT(flat.fit->rms_px, 2.0 * bent.fit->rms_px);
}

TEST(LensFit, SaysWhyThereIsNone) {
  std::mt19937 random(7);
  const BoardSpec board;
  auto views = viewsOf(lens60(), board, 3, 0.05, random);
  EXPECT_THAT(fitLens(board, {views[0], views[1]}, 640, 480, {}).problem,
              HasSubstr("2 views of the board (at least 3"));
  views[1].corners.resize(5);
  EXPECT_THAT(fitLens(board, views, 640, 480, {}).problem, HasSubstr("view 1 has 5 corners (at least 6"));
}

TEST(FitPoses, GivesTheErrorOfViewsThatDidNotFitTheLens) {
  std::mt19937 random(8);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  const auto views = viewsOf(truth, board, 8, 0.1, random);
  const auto good = fitPoses(truth, Eigen::Vector2d::Zero(), board, views);
  ASSERT_TRUE(good);
  // Two coordinates of 0.1 px each, less the six unknowns of a pose in some 35 corners.
  EXPECT_NEAR(rmsOf(*good), 0.1414, 0.02);
  CameraIntrinsics wrong = truth;
  wrong.k1 = 0.0;
  const auto bad = fitPoses(wrong, Eigen::Vector2d::Zero(), board, views);
  ASSERT_TRUE(bad);
  EXPECT_GT(rmsOf(*bad), 0.5);
}

TEST(ProjectionUncertainty, IsTheSpreadOfTheDifferenceToTheTruth) {
  std::mt19937 random(9);
  const BoardSpec board;
  const CameraIntrinsics truth = lens60();
  const PixelGrid grid = pixelGrid(640, 480);
  constexpr int kDraws = 25;
  double squares = 0.0;
  double variance = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto views = viewsOf(truth, board, 15, 0.1, random);
    const auto result = fitLens(board, views, 640, 480, {LensModel::kTangential, true, truth});
    ASSERT_TRUE(result.fit);
    const auto difference = projectionDifference(truth, result.fit->lens, grid);
    const auto uncertainty = projectionUncertainty(result.fit->lens, result.fit->P_lens, grid);
    for (std::size_t i = 0; i < grid.px.size(); ++i) {
      squares += difference.difference_px[i].squaredNorm();
      variance += uncertainty.P_px[i].trace();
    }
    // Corners of the image are the worst known.
    const Eigen::Vector2d& worst = grid.px[uncertainty.worst];
    EXPECT_GT((worst - Eigen::Vector2d(319.5, 239.5)).norm(), 250.0);
  }
  EXPECT_NEAR(std::sqrt(squares / variance), 1.0, 0.25);
}

TEST(ProjectionDifference, ATurnOfTheCameraIsNoDifferenceOfLenses) {
  const CameraIntrinsics first = intrinsicsFromFieldOfView(640, 480, 0.8);
  CameraIntrinsics second = first;
  // A pixel of the principal point is nearly a turn by 1 / f.
  second.cx += 1.0;
  const PixelGrid grid = pixelGrid(640, 480);
  EXPECT_NEAR(projectionDifference(first, second, grid, false).worst_px, 1.0, 1e-9);
  EXPECT_LT(projectionDifference(first, second, grid).worst_px, 0.3);
  // A focal length longer by 1 % moves the left border by 3.195 px, and the corner by 3.99 px.
  second = first;
  second.fx *= 1.01;
  second.fy *= 1.01;
  EXPECT_NEAR(projectionDifference(first, second, grid).worst_px, 0.01 * std::hypot(319.5, 239.5), 1e-6);
}

}  // namespace
}  // namespace vismem
