#include "localization/core/observation/novelty.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

/// Repeated views of one point at the image's largest range differ by less than half of this.
constexpr double kSquare_m = 0.25;
constexpr std::size_t kSquares = 8192;  // one view has hundreds; a hash collision loses little novelty

}  // namespace

ObservationNovelty::ObservationNovelty(const NoveltyParams& params) : params_(params), squares_(kSquares) {}

void ObservationNovelty::reset() {
  std::fill(squares_.begin(), squares_.end(), Square{});
}

std::uint64_t ObservationNovelty::keyOf(int label, std::int64_t x, std::int64_t y) {
  std::uint64_t key = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL;
  key = (key ^ (key >> 29)) + static_cast<std::uint64_t>(y) * 0xBF58476D1CE4E5B9ULL;
  key = (key ^ (key >> 31)) + static_cast<std::uint64_t>(label) * 0x94D049BB133111EBULL;
  return key ^ (key >> 27);
}

double ObservationNovelty::viewsOf(std::uint64_t key, StampUs stamp_us) {
  const Square& square = entryOf(key);
  if (square.key != key || square.views <= 0.0F) return 0.0;
  const double ago_s = toSeconds(stamp_us - square.stamp_us);
  return square.views * std::exp(-ago_s / params_.novelty_decay_s);
}

void ObservationNovelty::assess(FloorObservation& observation, const Pose2& T_odom_robot, StampUs stamp_us) {
  if (params_.half_novelty_views <= 0.0) return;
  double weight = 0.0;
  double novelty = 0.0;
  for (FloorPoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    const auto x = static_cast<std::int64_t>(std::floor(at.x() - 0.5));
    const auto y = static_cast<std::int64_t>(std::floor(at.y() - 0.5));
    double views = 0.0;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}}) {
      views = std::max(views, viewsOf(keyOf(point.label, x + dx, y + dy), stamp_us));
    }
    point.novelty = 1.0 / (1.0 + views / params_.half_novelty_views);
    weight += point.weight;
    novelty += point.weight * point.novelty;
  }
  observation.novelty = weight > 0.0 ? novelty / weight : 1.0;
  for (const FloorPoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    const std::uint64_t key = keyOf(point.label, static_cast<std::int64_t>(std::floor(at.x())),
                                    static_cast<std::int64_t>(std::floor(at.y())));
    Square& square = entryOf(key);
    if (square.key == key && square.views > 0.0F && square.stamp_us == stamp_us) continue;
    square = {key, stamp_us, static_cast<float>(viewsOf(key, stamp_us) + 1.0)};
  }
}

}  // namespace vismem
