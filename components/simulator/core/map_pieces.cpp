#include "simulator/core/map_pieces.h"

#include <algorithm>

namespace vismem {
namespace {

/// Joins `b` to `a` if both lie on one line and touch.
bool join(MapSegment& a, const MapSegment& b, double tolerance_m) {
  if (a.label != b.label) return false;
  const Eigen::Vector3d d = (a.world.b - a.world.a).normalized();
  const auto offset = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d r = p - a.world.a;
    return (r - r.dot(d) * d).norm();
  };
  constexpr double kSameLine_m = 0.002;
  if (offset(b.world.a) > kSameLine_m || offset(b.world.b) > kSameLine_m) return false;
  const double length = a.world.length();
  const double t0 = (b.world.a - a.world.a).dot(d);
  const double t1 = (b.world.b - a.world.a).dot(d);
  if (std::min(t0, t1) > length + tolerance_m || std::max(t0, t1) < -tolerance_m) return false;
  const Eigen::Vector3d low = std::min(t0, t1) < 0.0 ? (t0 < t1 ? b.world.a : b.world.b) : a.world.a;
  const Eigen::Vector3d high = std::max(t0, t1) > length ? (t0 > t1 ? b.world.a : b.world.b) : a.world.b;
  a.world = {low, high};
  return true;
}

}  // namespace

std::vector<MapSegment> joinPieces(const std::vector<MapSegment>& pieces, double same_place_m) {
  std::vector<MapSegment> joined;
  for (MapSegment piece : pieces) {
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < joined.size() && !again; ++i) {
        if (join(joined[i], piece, same_place_m)) {
          piece = joined[i];
          joined.erase(joined.begin() + static_cast<std::ptrdiff_t>(i));
          again = true;
        }
      }
    }
    joined.push_back(piece);
  }

  // Both borders of a thin panel are one edge for a camera; the longer one stays.
  std::vector<std::size_t> order(joined.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return joined[a].world.length() > joined[b].world.length() + 1e-9;
  });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order) {
    const MapSegment& s = joined[i];
    const bool twice = std::any_of(kept.begin(), kept.end(), [&](std::size_t k) {
      const MapSegment& other = joined[k];
      return other.label == s.label && distanceToSegment(s.world.a, other.world) < same_place_m &&
             distanceToSegment(s.world.b, other.world) < same_place_m;
    });
    if (!twice) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<MapSegment> result;
  for (const std::size_t i : kept) result.push_back(joined[i]);
  return result;
}

}  // namespace vismem
