#include "calibration/core/lens/lens_session.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

namespace vismem {
namespace {

/// Mean distance of the corners that both views have [px]; infinite when they share fewer than half of the
/// first.
double meanDistance(const BoardView& first, const BoardView& second) {
  double sum = 0.0;
  std::size_t shared = 0;
  auto b = second.corners.begin();
  for (const BoardCorner& a : first.corners) {
    while (b != second.corners.end() && b->id < a.id) ++b;
    if (b == second.corners.end() || b->id != a.id) continue;
    sum += (a.pixel - b->pixel).norm();
    ++shared;
  }
  if (2 * shared < first.corners.size()) return std::numeric_limits<double>::infinity();
  return sum / static_cast<double>(shared);
}

/// "upper left", "middle right", "middle".
std::string placeName(const Eigen::Vector2d& px, int width, int height) {
  const int column = std::min(2, static_cast<int>(3.0 * px.x() / width));
  const int row = std::min(2, static_cast<int>(3.0 * px.y() / height));
  static const char* const kRows[] = {"upper", "middle", "lower"};
  static const char* const kColumns[] = {" left", "", " right"};
  if (row == 1 && column == 1) return "middle";
  return std::string(kRows[row]) + (column == 1 ? " middle" : kColumns[column]);
}

/// The point of a grid that is farthest from all corners.
Eigen::Vector2d farthestFromCorners(const std::vector<BoardView>& views, int width, int height) {
  Eigen::Vector2d farthest(0.5 * (width - 1), 0.5 * (height - 1));
  double most = -1.0;
  if (views.empty()) return farthest;
  for (const Eigen::Vector2d& px : pixelGrid(width, height).px) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const BoardView& view : views) {
      for (const BoardCorner& corner : view.corners) nearest = std::min(nearest, (corner.pixel - px).norm());
    }
    if (nearest > most) {
      most = nearest;
      farthest = px;
    }
  }
  return farthest;
}

/// Angle between the board's normal and the direction to it [rad].
double slantOf(const Pose3& T_camera_board) {
  const Eigen::Vector3d d = T_camera_board.translation().normalized();
  return std::acos(std::clamp(std::abs(T_camera_board.linear().col(2).dot(d)), 0.0, 1.0));
}

std::string inPixels(double px) {
  std::ostringstream text;
  text << std::setprecision(2) << px << " px";
  return text.str();
}

}  // namespace

std::string describe(ViewVerdict verdict) {
  switch (verdict) {
    case ViewVerdict::kAccepted:
      return "accepted";
    case ViewVerdict::kNoBoard:
      return "no board is seen";
    case ViewVerdict::kFewCorners:
      return "too little of the board is seen";
    case ViewVerdict::kMoving:
      return "the board moves";
    case ViewVerdict::kBlurred:
      return "the image is not sharp";
    case ViewVerdict::kKnown:
      break;
  }
  return "the same as a view before";
}

LensSession::LensSession(const BoardSpec& board, int width, int height, const LensSessionParams& params)
    : board_(board), width_(width), height_(height), params_(params) {
  advise();
}

ViewVerdict LensSession::offer(const BoardView& view, double blur_px) {
  const std::optional<BoardView> before = std::exchange(last_, view);
  if (view.corners.empty()) return ViewVerdict::kNoBoard;
  if (static_cast<int>(view.corners.size()) < params_.min_corners) return ViewVerdict::kFewCorners;
  if (params_.max_motion_px > 0.0 && !(before && meanDistance(view, *before) <= params_.max_motion_px))
    return ViewVerdict::kMoving;
  if (blur_px > params_.max_blur_px) return ViewVerdict::kBlurred;
  const double novelty_px = params_.min_novelty * width_;
  const bool is_known = std::any_of(views_.begin(), views_.end(), [&](const BoardView& accepted) {
    return meanDistance(view, accepted) < novelty_px;
  });
  if (is_known) return ViewVerdict::kKnown;
  views_.push_back(view);
  return ViewVerdict::kAccepted;
}

void LensSession::restore(const BoardView& view) {
  views_.push_back(view);
}

const LensProgress& LensSession::progress() {
  if (fitted_views_ == views_.size()) return progress_;
  fitted_views_ = views_.size();
  LensFitOptions options{LensModel::kFull, false, std::nullopt};
  if (progress_.fit) options.start = progress_.fit->lens;
  progress_.fit = fitLens(board_, views_, width_, height_, options).fit;
  progress_.uncertainty.reset();
  if (progress_.fit) {
    progress_.uncertainty =
        projectionUncertainty(progress_.fit->lens, progress_.fit->P_lens, pixelGrid(width_, height_));
  }
  advise();
  return progress_;
}

void LensSession::advise() {
  progress_.views = views_.size();
  progress_.is_enough = false;
  const bool is_few = static_cast<int>(views_.size()) < params_.min_views;
  if (!progress_.fit) {
    progress_.target_px = farthestFromCorners(views_, width_, height_);
    progress_.advice = "Show the board in the " + placeName(progress_.target_px, width_, height_) +
                       " of the image, each time at another slant.";
    return;
  }
  const ProjectionUncertainty& uncertainty = *progress_.uncertainty;
  const double worst_px = uncertainty.sigma_px[uncertainty.worst];
  progress_.target_px = uncertainty.grid.px[uncertainty.worst];
  progress_.is_enough = !is_few && worst_px <= params_.goal_px;
  if (progress_.is_enough) {
    progress_.advice = "Enough: " + inPixels(worst_px) + " in the worst place.";
    return;
  }
  double slant_rad = 0.0;
  for (const FittedView& view : progress_.fit->views)
    slant_rad = std::max(slant_rad, slantOf(view.T_camera_board));
  constexpr double kFlat_rad = 0.35;
  if (slant_rad < kFlat_rad) {
    progress_.advice = "Slant the board by 30 degrees or more: without that nobody knows the focal length.";
    return;
  }
  progress_.advice =
      "Show the board near and aslant in the " + placeName(progress_.target_px, width_, height_) +
      " of the image: " + inPixels(worst_px) + " there, " + inPixels(params_.goal_px) + " is the goal.";
  if (worst_px <= params_.goal_px)
    progress_.advice = "Show the board at new places and slants: at least " +
                       std::to_string(params_.min_views) + " views are needed.";
}

}  // namespace vismem
