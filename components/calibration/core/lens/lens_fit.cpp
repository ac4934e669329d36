#include "calibration/core/lens/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibration/core/lens/adjustment.h"
#include "calibration/core/lens/board_pose.h"

namespace vismem {
namespace {

using UsedCorners = std::vector<std::vector<bool>>;

/// Scale of the kernel while outliers are unknown [sigma]; and of the first kernel: a start is off by some
/// pixels everywhere, which a narrow one takes for outliers, and nothing would move.
constexpr double kCauchy = 3.0;
constexpr double kWideCauchy = 100.0;
/// Fields of view to start from [degrees].
constexpr double kStarts_deg[] = {50.0, 75.0, 100.0};
/// A corner farther off than this is an outlier, in standard deviations of the others, and more than its own
/// sigma.
constexpr double kOutlier = 4.5;

UsedCorners allOf(const std::vector<BoardView>& views) {
  UsedCorners used;
  for (const BoardView& view : views) used.emplace_back(view.corners.size(), true);
  return used;
}

/// @return false when a view has no pose.
bool startPoses(const CameraIntrinsics& lens, const BoardSpec& board, const std::vector<BoardView>& views,
                LensUnknowns& unknowns) {
  unknowns.lens = lensVector(lens);
  unknowns.poses.clear();
  for (const BoardView& view : views) {
    const auto pose = boardPoseFrom(lens, board, view);
    if (!pose) return false;
    unknowns.poses.push_back(poseVector(*pose));
  }
  return true;
}

/// Marks corners far off as outliers. @return whether that changed any.
bool dropOutliers(const Adjustment& adjustment, const LensUnknowns& unknowns,
                  const std::vector<BoardView>& views, UsedCorners& used) {
  const auto residuals = adjustment.residuals(unknowns);
  std::vector<double> distances;
  const auto distance = [&](std::size_t view, std::size_t i) {
    return residuals[view][i].norm() / adjustment.sigmaOf(views[view].corners[i]);
  };
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t i = 0; i < used[view].size(); ++i) distances.push_back(distance(view, i));
  }
  auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  // Median of the length of a vector of two normal numbers: 1.177 sigma.
  const double limit = std::max(1.0, kOutlier * *middle / 1.177);
  bool changed = false;
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t i = 0; i < used[view].size(); ++i) {
      const bool is_used = distance(view, i) <= limit;
      changed |= is_used != used[view][i];
      used[view][i] = is_used;
    }
  }
  return changed;
}

std::vector<FittedView> fittedViews(const Adjustment& adjustment, const LensUnknowns& unknowns,
                                    const UsedCorners& used) {
  const auto residuals = adjustment.residuals(unknowns);
  std::vector<FittedView> fitted;
  for (std::size_t view = 0; view < residuals.size(); ++view) {
    fitted.push_back({poseFrom(unknowns.poses[view]), residuals[view], used[view], 0.0});
    fitted.back().rms_px = rmsOf({fitted.back()});
  }
  return fitted;
}

/// The best of several starts.
std::optional<LensUnknowns> firstSolution(const Adjustment& adjustment, const BoardSpec& board,
                                          const std::vector<BoardView>& views, int width, int height,
                                          const LensFitOptions& options) {
  std::vector<CameraIntrinsics> starts;
  if (options.start) {
    starts.push_back(*options.start);
  } else {
    for (const double fov_deg : kStarts_deg)
      starts.push_back(intrinsicsFromFieldOfView(width, height, fov_deg * std::numbers::pi / 180.0));
  }
  const UsedCorners all = allOf(views);
  std::optional<LensUnknowns> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const CameraIntrinsics& start : starts) {
    LensUnknowns unknowns;
    if (!startPoses(start, board, views, unknowns)) continue;
    const int free = std::min(freeParameters(options.model), freeParameters(LensModel::kRadial));
    AdjustmentOptions robust{free, false, kWideCauchy};
    adjustment.solve(unknowns, all, robust);
    robust.free_lens = freeParameters(options.model);
    robust.is_bow_free = !options.is_board_flat;
    robust.cauchy = kCauchy;
    const double cost = adjustment.solve(unknowns, all, robust);
    if (cost < best_cost) {
      best_cost = cost;
      best = unknowns;
    }
    // A corner fits to a few sigma: no other start can be better by much.
    constexpr double kGood = 3.0;
    if (best_cost < kGood) break;
  }
  return best;
}

std::string problemOf(const std::vector<BoardView>& views) {
  if (views.size() < kMinLensViews) {
    return std::to_string(views.size()) + " views of the board (at least " + std::to_string(kMinLensViews) +
           " are needed)";
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].corners.size() < kMinViewCorners) {
      return "view " + std::to_string(i) + " has " + std::to_string(views[i].corners.size()) +
             " corners (at least " + std::to_string(kMinViewCorners) + " are needed)";
    }
  }
  return {};
}

}  // namespace

double rmsOf(const std::vector<FittedView>& views) {
  double squares = 0.0;
  int corners = 0;
  for (const FittedView& view : views) {
    for (std::size_t i = 0; i < view.residuals_px.size(); ++i) {
      if (!view.is_used[i]) continue;
      squares += view.residuals_px[i].squaredNorm();
      ++corners;
    }
  }
  return corners > 0 ? std::sqrt(squares / corners) : 0.0;
}

LensFitResult fitLens(const BoardSpec& board, const std::vector<BoardView>& views, int width, int height,
                      const LensFitOptions& options) {
  if (const std::string problem = problemOf(views); !problem.empty()) return {std::nullopt, problem};
  const Adjustment adjustment(board, views, width, height);
  auto unknowns = firstSolution(adjustment, board, views, width, height, options);
  if (!unknowns) return {std::nullopt, "no start leads to a solution: the corners do not fit one flat board"};
  const AdjustmentOptions last{freeParameters(options.model), !options.is_board_flat, 0.0};
  UsedCorners used = allOf(views);
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    if (!dropOutliers(adjustment, *unknowns, views, used) && round > 0) break;
    if (!std::isfinite(adjustment.solve(*unknowns, used, last)))
      return {std::nullopt, "the least squares did not converge"};
  }
  LensFit fit;
  fit.lens = lensFrom(unknowns->lens, width, height);
  fit.model = options.model;
  fit.bow_m = unknowns->bow_m;
  fit.views = fittedViews(adjustment, *unknowns, used);
  fit.rms_px = rmsOf(fit.views);
  const auto covariance = adjustment.covariance(*unknowns, used, last);
  fit.P_lens = covariance.P_lens;
  fit.bow_sigma_m = covariance.bow_sigma_m;
  for (const auto& view : used) {
    for (const bool is_used : view) ++(is_used ? fit.corners : fit.outliers);
  }
  return {std::move(fit), {}};
}

std::optional<std::vector<FittedView>> fitPoses(const CameraIntrinsics& lens, const Eigen::Vector2d& bow_m,
                                                const BoardSpec& board, const std::vector<BoardView>& views) {
  const Adjustment adjustment(board, views, lens.width, lens.height);
  LensUnknowns unknowns;
  unknowns.bow_m = bow_m;
  if (!startPoses(lens, board, views, unknowns)) return std::nullopt;
  UsedCorners used = allOf(views);
  adjustment.solve(unknowns, used, {0, false, kWideCauchy});
  dropOutliers(adjustment, unknowns, views, used);
  if (!std::isfinite(adjustment.solve(unknowns, used, {0, false, 0.0}))) return std::nullopt;
  return fittedViews(adjustment, unknowns, used);
}

}  // namespace vismem
