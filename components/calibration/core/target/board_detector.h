/// @file Corners of a calibration board in an image: tags give identity (AprilTag 3: Wang and Olson 2016,
/// "AprilTag 2"; Krogius et al. 2019), the chessboard's corners give the place. *Single-threaded.*
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "calibration/core/board.h"

namespace vismem {

struct BoardDetection {
  BoardView view;        ///< found corners; empty when none
  int tags = 0;          ///< tags of this board that were read
  double blur_px = 0.0;  ///< median spread of the edges at the corners (standard deviation)
};

/// Finds one board in images, also when only a part of it is in the image. Two steps: the tags that can be
/// read place their squares' corners; from found corners the search goes on to their neighbours, read or not.
class BoardDetector {
 public:
  /// @param board passes checkBoard.
  explicit BoardDetector(const BoardSpec& board);
  ~BoardDetector();
  BoardDetector(const BoardDetector&) = delete;
  BoardDetector& operator=(const BoardDetector&) = delete;

  /// @param image CV_8UC1, or CV_8UC3 in the order R, G, B.
  BoardDetection detect(const cv::Mat& image, std::int64_t stamp_us);

 private:
  class Tags;

  BoardSpec board_;
  std::unique_ptr<Tags> tags_;
};

}  // namespace vismem
