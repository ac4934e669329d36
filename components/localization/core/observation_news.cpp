#include "localization/core/observation_news.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

/// A floor point at the image's range lies this much beside where it lay, at most by half of it.
constexpr double kSquare_m = 0.25;
constexpr std::size_t kSquares = 8192;  // a view has hundreds; a wrong neighbour costs a little news

}  // namespace

ObservationNews::ObservationNews(const RobustParams& params) : params_(params), squares_(kSquares) {}

void ObservationNews::clear() {
  std::fill(squares_.begin(), squares_.end(), Square{});
}

std::uint64_t ObservationNews::keyOf(int label, std::int64_t x, std::int64_t y) {
  std::uint64_t key = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL;
  key = (key ^ (key >> 29)) + static_cast<std::uint64_t>(y) * 0xBF58476D1CE4E5B9ULL;
  key = (key ^ (key >> 31)) + static_cast<std::uint64_t>(label) * 0x94D049BB133111EBULL;
  return key ^ (key >> 27);
}

double ObservationNews::timesSeen(std::uint64_t key, StampUs stamp_us) {
  const Square& square = entryOf(key);
  if (square.key != key || square.times <= 0.0F) return 0.0;
  const double ago_s = toSeconds(stamp_us - square.stamp_us);
  return square.times * std::exp(-ago_s / params_.repeat_time_s);
}

void ObservationNews::weigh(RobustObservation& observation, const Pose2& T_odom_robot, StampUs stamp_us) {
  if (params_.repeats <= 0.0) return;
  double weight = 0.0;
  double news = 0.0;
  for (EvidencePoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    const auto x = static_cast<std::int64_t>(std::floor(at.x() - 0.5));
    const auto y = static_cast<std::int64_t>(std::floor(at.y() - 0.5));
    double times = 0.0;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}}) {
      times = std::max(times, timesSeen(keyOf(point.label, x + dx, y + dy), stamp_us));
    }
    point.news = 1.0 / (1.0 + times / params_.repeats);
    weight += point.weight;
    news += point.weight * point.news;
  }
  observation.news = weight > 0.0 ? news / weight : 1.0;
  for (const EvidencePoint& point : observation.points) {
    const Eigen::Vector2d at = transform(T_odom_robot, point.p_robot) / kSquare_m;
    const std::uint64_t key = keyOf(point.label, static_cast<std::int64_t>(std::floor(at.x())),
                                    static_cast<std::int64_t>(std::floor(at.y())));
    Square& square = entryOf(key);
    if (square.key == key && square.times > 0.0F && square.stamp_us == stamp_us) continue;
    square = {key, stamp_us, static_cast<float>(timesSeen(key, stamp_us) + 1.0)};
  }
}

}  // namespace vismem
