/// @file Collects views of a board for a lens: which images count, what is still missing, when it is enough.
/// Pure. *Single-threaded.*
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/core/lens/lens_fit.h"
#include "calibration/core/lens/projection_grid.h"

namespace vismem {

struct LensSessionParams {
  int min_corners = 12;        ///< of a view
  double max_motion_px = 0.3;  ///< mean of the corners between two images; 0: every image shows a still board
  double min_novelty =
      0.04;  ///< mean distance of the corners from those of each accepted view, in image widths
  double max_blur_px = 2.0;  ///< spread of the edges
  double goal_px = 0.1;      ///< uncertainty of the projection in the worst place at which it is enough
  int min_views = 12;
};

/// What happened to an image.
enum class ViewVerdict { kAccepted, kNoBoard, kFewCorners, kMoving, kBlurred, kKnown };
/// For people: "the board moves".
std::string describe(ViewVerdict verdict);

/// What the views so far determine.
struct LensProgress {
  std::size_t views = 0;
  bool is_enough = false;
  std::optional<LensFit> fit;                           ///< empty while there are too few views
  std::optional<ProjectionUncertainty> uncertainty;     ///< with `fit`
  Eigen::Vector2d target_px = Eigen::Vector2d::Zero();  ///< where in the image the board is wanted next
  std::string advice;                                   ///< the same in words
};

class LensSession {
 public:
  LensSession(const BoardSpec& board, int width, int height, const LensSessionParams& params = {});

  /// @param blur_px spread of the edges in this image.
  ViewVerdict offer(const BoardView& view, double blur_px);
  /// Takes a view that was accepted earlier.
  void restore(const BoardView& view);

  const std::vector<BoardView>& views() const { return views_; }
  /// Fits the accepted views anew if there are new ones.
  const LensProgress& progress();

 private:
  void advise();

  BoardSpec board_;
  int width_;
  int height_;
  LensSessionParams params_;
  std::vector<BoardView> views_;
  std::optional<BoardView> last_;
  LensProgress progress_;
  std::size_t fitted_views_ = 0;
};

}  // namespace vismem
