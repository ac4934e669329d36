#include "calibration/core/target/board_detector.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <opencv2/imgproc.hpp>

#include "calibration/core/target/saddle_fit.h"

namespace vismem {
namespace {

/// Where a corner is expected: mean over those who expect it.
struct Expectation {
  SaddleGuess guess;
  int voices = 0;

  void add(const SaddleGuess& one) {
    const double share = 1.0 / ++voices;
    guess.px += share * (one.px - guess.px);
    guess.right += share * (one.right - guess.right);
    guess.up += share * (one.up - guess.up);
    guess.is_upper_right_white = one.is_upper_right_white;
  }
};
using Expectations = std::map<int, Expectation>;

struct FoundCorner {
  SaddleFit fit;
  SaddleGuess guess;  ///< its directions
};
using FoundCorners = std::map<int, FoundCorner>;

bool upperRightIsWhite(const BoardSpec& board, int column, int row) {
  return board.isWhite(column + 1, row + 1);
}

/// Corners of a tag's square, from the tag's homography (tag coordinates: -1..1, y down).
void expectAround(const BoardSpec& board, int tag, const Eigen::Matrix3d& H, Expectations& expected) {
  const Eigen::Vector2i square = board.squareOf(tag);
  // Apriltag counts pixels from the corner of the first one.
  const auto at = [&](double x, double y) -> Eigen::Vector2d {
    return (H * Eigen::Vector3d(x, y, 1.0)).hnormalized() - Eigen::Vector2d::Constant(0.5);
  };
  constexpr double kSquare = 1.0 / BoardSpec::kTagSide;
  constexpr double kStep = 0.2;
  for (const int right : {0, 1}) {
    for (const int up : {0, 1}) {
      const int column = square.x() - 1 + right;
      const int row = square.y() - 1 + up;
      if (column < 0 || row < 0 || column >= board.cornerColumns() || row >= board.cornerRows()) continue;
      const double x = right ? kSquare : -kSquare;
      const double y = up ? -kSquare : kSquare;
      SaddleGuess guess;
      guess.px = at(x, y);
      guess.right = (at(x + kStep, y) - at(x - kStep, y)) * (kSquare / kStep);
      guess.up = (at(x, y - kStep) - at(x, y + kStep)) * (kSquare / kStep);
      guess.is_upper_right_white = upperRightIsWhite(board, column, row);
      expected[board.cornerId(column, row)].add(guess);
    }
  }
}

/// Expects what lies beside found corners, by the steps between them.
Expectations expectBeside(const BoardSpec& board, const FoundCorners& found) {
  Expectations expected;
  const auto corner = [&](int column, int row) -> const FoundCorner* {
    if (column < 0 || row < 0 || column >= board.cornerColumns() || row >= board.cornerRows()) return nullptr;
    const auto one = found.find(board.cornerId(column, row));
    return one == found.end() ? nullptr : &one->second;
  };
  for (const auto& [id, here] : found) {
    const int column = id % board.cornerColumns();
    const int row = id / board.cornerColumns();
    for (const auto& [dx, dy] : std::array<std::pair<int, int>, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
      const int to_column = column + dx;
      const int to_row = row + dy;
      if (to_column < 0 || to_row < 0 || to_column >= board.cornerColumns() || to_row >= board.cornerRows())
        continue;
      const int to = board.cornerId(to_column, to_row);
      if (found.contains(to)) continue;
      SaddleGuess guess = here.guess;
      // The step from the corner before, if that is known: it has the perspective.
      const FoundCorner* before = corner(column - dx, row - dy);
      const Eigen::Vector2d step = before ? Eigen::Vector2d(here.fit.px - before->fit.px)
                                          : Eigen::Vector2d(dx * here.guess.right + dy * here.guess.up);
      guess.px = here.fit.px + step;
      guess.is_upper_right_white = upperRightIsWhite(board, to_column, to_row);
      expected[to].add(guess);
    }
  }
  return expected;
}

/// The board's directions at a found corner, from its found neighbours where there are any.
void refineDirections(const BoardSpec& board, FoundCorners& found) {
  const auto place = [&](int column, int row) -> const Eigen::Vector2d* {
    if (column < 0 || row < 0 || column >= board.cornerColumns() || row >= board.cornerRows()) return nullptr;
    const auto one = found.find(board.cornerId(column, row));
    return one == found.end() ? nullptr : &one->second.fit.px;
  };
  const auto step = [](const Eigen::Vector2d* before, const Eigen::Vector2d& here,
                       const Eigen::Vector2d* after, Eigen::Vector2d& direction) {
    if (before && after)
      direction = 0.5 * (*after - *before);
    else if (after)
      direction = *after - here;
    else if (before)
      direction = here - *before;
  };
  for (auto& [id, corner] : found) {
    const int column = id % board.cornerColumns();
    const int row = id / board.cornerColumns();
    step(place(column - 1, row), corner.fit.px, place(column + 1, row), corner.guess.right);
    step(place(column, row - 1), corner.fit.px, place(column, row + 1), corner.guess.up);
  }
}

/// @return the number of new corners.
std::size_t fitExpected(const cv::Mat& grey, const Expectations& expected, FoundCorners& found) {
  const std::size_t before = found.size();
  for (const auto& [id, expectation] : expected) {
    if (found.contains(id)) continue;
    if (const auto fit = fitSaddle(grey, expectation.guess))
      found.emplace(id, FoundCorner{*fit, expectation.guess});
  }
  return found.size() - before;
}

/// Two corners in one place: one of them is a mistake, and nobody knows which.
void dropDoubles(FoundCorners& found) {
  constexpr double kSame_px = 2.0;
  std::vector<int> doubles;
  for (auto a = found.begin(); a != found.end(); ++a) {
    for (auto b = std::next(a); b != found.end(); ++b) {
      if ((a->second.fit.px - b->second.fit.px).norm() < kSame_px)
        doubles.insert(doubles.end(), {a->first, b->first});
    }
  }
  for (const int id : doubles) found.erase(id);
}

}  // namespace

/// Libapriltag's detector with its family.
class BoardDetector::Tags {
 public:
  Tags() : family_(tag36h11_create()), detector_(apriltag_detector_create()) {
    apriltag_detector_add_family_bits(detector_, family_, 1);
    detector_->nthreads = 1;
  }
  ~Tags() {
    apriltag_detector_destroy(detector_);
    tag36h11_destroy(family_);
  }
  Tags(const Tags&) = delete;
  Tags& operator=(const Tags&) = delete;

  /// Tags with their homographies.
  std::map<int, Eigen::Matrix3d> read(const cv::Mat& grey) {
    constexpr float kMinMargin = 20.0F;
    constexpr int kLarge_px = 1000;
    detector_->quad_decimate = std::max(grey.cols, grey.rows) > kLarge_px ? 2.0F : 1.0F;
    image_u8_t image{grey.cols, grey.rows, static_cast<int>(grey.step), grey.data};
    zarray_t* all = apriltag_detector_detect(detector_, &image);
    std::map<int, Eigen::Matrix3d> tags;
    for (int i = 0; i < zarray_size(all); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(all, i, &tag);
      if (tag->decision_margin < kMinMargin) continue;
      tags[tag->id] = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tag->H->data);
    }
    apriltag_detections_destroy(all);
    return tags;
  }

 private:
  apriltag_family_t* family_;
  apriltag_detector_t* detector_;
};

BoardDetector::BoardDetector(const BoardSpec& board) : board_(board), tags_(std::make_unique<Tags>()) {}
BoardDetector::~BoardDetector() = default;

BoardDetection BoardDetector::detect(const cv::Mat& image, std::int64_t stamp_us) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
  BoardDetection detection;
  detection.view.stamp_us = stamp_us;
  Expectations expected;
  for (const auto& [tag, H] : tags_->read(grey)) {
    if (board_.squareOf(tag).x() < 0) continue;
    ++detection.tags;
    expectAround(board_, tag, H, expected);
  }
  FoundCorners found;
  for (bool more = fitExpected(grey, expected, found) > 0; more;) {
    refineDirections(board_, found);
    more = fitExpected(grey, expectBeside(board_, found), found) > 0;
  }
  dropDoubles(found);
  std::vector<double> blurs;
  for (const auto& [id, corner] : found) {
    detection.view.corners.push_back({id, corner.fit.px, corner.fit.sigma_px});
    blurs.push_back(corner.fit.blur_px);
  }
  if (!blurs.empty()) {
    std::nth_element(blurs.begin(), blurs.begin() + static_cast<std::ptrdiff_t>(blurs.size() / 2),
                     blurs.end());
    detection.blur_px = blurs[blurs.size() / 2];
  }
  return detection;
}

}  // namespace vismem
