#include "localization/core/observation/novelty.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr double kHalfNoveltyViews = 3.0;  // earlier views that halve the novelty of a point
constexpr double kDecay_s = 60.0;          // time constant of the count of views
constexpr double kSquare_m = 0.25;         // repeated views of a point differ by less than half of it
constexpr std::size_t kSquares = 8192;     // a view has hundreds; a collision of hashes loses little

std::uint64_t keyOf(int label, std::int64_t x, std::int64_t y) {
  std::uint64_t key = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL;
  key = (key ^ (key >> 29)) + static_cast<std::uint64_t>(y) * 0xBF58476D1CE4E5B9ULL;
  key = (key ^ (key >> 31)) + static_cast<std::uint64_t>(label) * 0x94D049BB133111EBULL;
  return key ^ (key >> 27);
}

std::int64_t squareOf(double at) {
  return static_cast<std::int64_t>(std::floor(at));
}

}  // namespace

ObservationNovelty::ObservationNovelty() : squares_(kSquares) {}

void ObservationNovelty::reset() {
  std::fill(squares_.begin(), squares_.end(), Square{});
}

double ObservationNovelty::viewsOf(std::uint64_t key, StampUs stamp_us) const {
  const Square& square = squares_[key % kSquares];
  if (square.key != key) return 0.0;
  return square.views * std::exp(-toSeconds(stamp_us - square.stamp_us) / kDecay_s);
}

double ObservationNovelty::assess(const FloorObservation& observation, const Pose2& T_odom_robot,
                                  StampUs stamp_us) {
  double weight = 0.0;
  double novelty = 0.0;
  for (const FloorPoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    double views = 0.0;
    for (const auto& [dx, dy] : {std::pair{-0.5, -0.5}, {-0.5, 0.5}, {0.5, -0.5}, {0.5, 0.5}}) {
      const std::uint64_t key = keyOf(point.label, squareOf(at.x() + dx), squareOf(at.y() + dy));
      views = std::max(views, viewsOf(key, stamp_us));
    }
    weight += point.weight;
    novelty += point.weight / (1.0 + views / kHalfNoveltyViews);
  }
  for (const FloorPoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    const std::uint64_t key = keyOf(point.label, squareOf(at.x()), squareOf(at.y()));
    Square& square = squares_[key % kSquares];
    if (square.key == key && square.stamp_us == stamp_us) continue;
    square = {key, stamp_us, viewsOf(key, stamp_us) + 1.0};
  }
  return weight > 0.0 ? novelty / weight : 1.0;
}

}  // namespace vismem
