// The detector on rendered views whose corners are known exactly.
#include "calibration/core/target/board_detector.h"

#include <gmock/gmock.h>

#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "support/board_renderer.h"

namespace vismem {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

CameraIntrinsics lensOf(double fov_deg, double k1 = 0.0) {
  CameraIntrinsics lens = intrinsicsFromFieldOfView(640, 480, fov_deg * kDegree);
  lens.k1 = k1;
  return lens;
}

Eigen::Vector3d centreOf(const BoardSpec& board) {
  return {0.5 * board.columns * board.square_m.x(), 0.5 * board.rows * board.square_m.y(), 0.0};
}

BoardScene sceneAt(const CameraIntrinsics& lens, double distance_m, double slant_deg, double turn_deg,
                   double roll_deg, const Eigen::Vector2d& pixel = {319.5, 239.5}) {
  BoardScene scene;
  scene.T_camera_board = boardPose(lens, centreOf(scene.board), pixel, distance_m, slant_deg * kDegree,
                                   turn_deg * kDegree, roll_deg * kDegree);
  return scene;
}

/// Corners inside the image with a margin in which a window fits.
int cornersWellInside(const CameraIntrinsics& lens, const BoardScene& scene, double margin_px) {
  int count = 0;
  for (int id = 0; id < scene.board.corners(); ++id) {
    const auto px = trueCorner(lens, scene, id);
    count += px && px->x() > margin_px && px->y() > margin_px && px->x() < lens.width - 1 - margin_px &&
             px->y() < lens.height - 1 - margin_px;
  }
  return count;
}

struct Errors {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  double normalised = 0.0;
  double worst = 0.0;
  int count = 0;

  void add(const CameraIntrinsics& lens, const BoardScene& scene, const BoardView& view) {
    for (const BoardCorner& corner : view.corners) {
      const Eigen::Vector2d error = corner.pixel - *trueCorner(lens, scene, corner.id);
      sum += error;
      squares += error.cwiseAbs2();
      normalised += 0.5 * error.squaredNorm() / (corner.sigma_px * corner.sigma_px);
      worst = std::max(worst, error.norm());
      ++count;
    }
  }
  Eigen::Vector2d bias() const { return sum / count; }
  Eigen::Vector2d scatter() const { return (squares / count - bias().cwiseAbs2()).cwiseSqrt(); }
};

// The trap: pixel centres on integers, as the project's camera model has them, or half a pixel off, as in
// OpenCV 4.6's ChArUco and AprilTag's own corners.
TEST(BoardDetector, CornersHaveNoBiasAndLittleScatter) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Errors errors;
  for (const double k1 : {0.0, -0.25}) {
    const BoardRenderer renderer(lensOf(60.0, k1));
    BoardDetector detector(BoardSpec{});
    for (int i = 0; i < 10; ++i) {
      // In an order of their own: compilers order the arguments of a call as they like.
      const double distance_m = 0.35 + 0.25 * unit(random);
      const double slant_deg = 40.0 * unit(random);
      const double turn_deg = 360.0 * unit(random);
      const double roll_deg = 60.0 * unit(random) - 30.0;
      const BoardScene scene = sceneAt(renderer.lens(), distance_m, slant_deg, turn_deg, roll_deg);
      const BoardDetection found = detector.detect(renderer.render(scene, random), i);
      EXPECT_EQ(found.view.stamp_us, i);
      EXPECT_GE(static_cast<double>(found.view.corners.size()),
                0.95 * cornersWellInside(renderer.lens(), scene, 11.0))
          << "view " << i;
      errors.add(renderer.lens(), scene, found.view);
    }
  }
  RecordProperty("corners", errors.count);
  std::cout << errors.count << " corners, bias " << errors.bias().transpose() << " px, scatter "
            << errors.scatter().transpose() << " px, worst " << errors.worst << " px, normalised "
            << errors.normalised / errors.count << "\n";
  EXPECT_LT(errors.bias().cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT(errors.scatter().maxCoeff(), 0.05);
  EXPECT_LT(errors.worst, 0.4);
  // The reported sigma is honest.
  EXPECT_GT(errors.normalised / errors.count, 0.5);
  EXPECT_LT(errors.normalised / errors.count, 2.0);
}

TEST(BoardDetector, SeesAPartOfTheBoard) {
  std::mt19937 random(2);
  const BoardRenderer renderer(lensOf(60.0));
  BoardDetector detector(BoardSpec{});
  // The board's middle lies in a corner of the image.
  const BoardScene scene = sceneAt(renderer.lens(), 0.4, 20.0, 45.0, 10.0, {600.0, 440.0});
  const int inside = cornersWellInside(renderer.lens(), scene, 11.0);
  ASSERT_GT(inside, 4);
  ASSERT_LT(inside, 25);
  const BoardDetection found = detector.detect(renderer.render(scene, random), 0);
  EXPECT_GE(static_cast<int>(found.view.corners.size()), inside);
  Errors errors;
  errors.add(renderer.lens(), scene, found.view);
  EXPECT_LT(errors.worst, 0.3);
}

// Hidden tags cost the corners beside them only where the corners are hidden too.
TEST(BoardDetector, FindsCornersBesideTagsThatCannotBeRead) {
  std::mt19937 random(3);
  const BoardRenderer renderer(lensOf(60.0));
  BoardDetector detector(BoardSpec{});
  const BoardScene scene = sceneAt(renderer.lens(), 0.4, 10.0, 0.0, 5.0);
  cv::Mat image = renderer.render(scene, random);
  // Spoils all tags but those of the lowest row, inside their borders.
  for (int tag = 4; tag < scene.board.tags(); ++tag) {
    const Eigen::Vector2i square = scene.board.squareOf(tag);
    const Eigen::Vector3d middle((square.x() + 0.5) * scene.board.square_m.x(),
                                 (square.y() + 0.5) * scene.board.square_m.y(), 0);
    const Eigen::Vector2d px = *projectToIdeal(renderer.lens(), scene.T_camera_board * middle);
    cv::circle(image, cv::Point2d(px.x(), px.y()), 8, cv::Scalar(200), cv::FILLED);
  }
  const BoardDetection found = detector.detect(image, 0);
  EXPECT_LE(found.tags, 6);
  EXPECT_EQ(static_cast<int>(found.view.corners.size()), scene.board.corners());
  Errors errors;
  errors.add(renderer.lens(), scene, found.view);
  EXPECT_LT(errors.worst, 0.3);
}

TEST(BoardDetector, AnotherBoardIsNotThisOne) {
  std::mt19937 random(4);
  const BoardRenderer renderer(lensOf(60.0));
  BoardScene scene = sceneAt(renderer.lens(), 0.4, 10.0, 0.0, 5.0);
  scene.board.first_tag = 100;
  BoardDetector detector(BoardSpec{});
  const BoardDetection found = detector.detect(renderer.render(scene, random), 0);
  EXPECT_EQ(found.tags, 0);
  EXPECT_TRUE(found.view.corners.empty());
}

TEST(BoardDetector, MeasuresBlurAndReadsColour) {
  std::mt19937 random(5);
  const BoardRenderer renderer(lensOf(60.0));
  BoardDetector detector(BoardSpec{});
  std::map<double, double> measured;
  for (const double blur_px : {0.7, 1.2}) {
    BoardScene scene = sceneAt(renderer.lens(), 0.4, 10.0, 0.0, 5.0);
    scene.blur_px = blur_px;
    cv::Mat colour;
    cv::cvtColor(renderer.render(scene, random), colour, cv::COLOR_GRAY2RGB);
    measured[blur_px] = detector.detect(colour, 0).blur_px;
  }
  // The pixel's own area adds 1/12 px^2.
  EXPECT_NEAR(measured[0.7], std::sqrt(0.49 + 1.0 / 12.0), 0.05);
  EXPECT_NEAR(measured[1.2], std::sqrt(1.44 + 1.0 / 12.0), 0.1);
}

TEST(BoardDetector, NothingIsFoundInNoiseAndInTinyImages) {
  BoardDetector detector(BoardSpec{});
  cv::Mat noise(480, 640, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 255);
  EXPECT_TRUE(detector.detect(noise, 0).view.corners.empty());
  EXPECT_TRUE(detector.detect(cv::Mat(16, 16, CV_8UC1, cv::Scalar(0)), 0).view.corners.empty());
}

}  // namespace
}  // namespace vismem
