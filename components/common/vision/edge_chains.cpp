#include "common/vision/edge_chains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace vismem {
namespace {

/// Steps of the eight direction classes, 45 degrees apart, turning from +x towards +y.
constexpr std::array<int, 8> kStepX{1, 1, 0, -1, -1, -1, 0, 1};
constexpr std::array<int, 8> kStepY{0, 1, 1, 1, 0, -1, -1, -1};
constexpr double kMinimumCos = 0.7;   // between the gradients of neighbours: one class
constexpr std::size_t kStraight = 6;  // points back that give the way on across a gap
constexpr std::size_t kRingOverlap = 16;
constexpr float kRingGap_px = 3.0F;

int directionClass(int dx, int dy) {
  // tan(22.5 deg) = 0.4142: 169 / 408.
  const int ax = std::abs(dx);
  const int ay = std::abs(dy);
  if (ay * 408 <= ax * 169) return dx >= 0 ? 0 : 4;
  if (ax * 408 <= ay * 169) return dy >= 0 ? 2 : 6;
  if (dy >= 0) return dx >= 0 ? 1 : 3;
  return dx >= 0 ? 7 : 5;
}

class Follower {
 public:
  Follower(EdgePlanes& planes, int gap_px) : planes_(planes), gap_px_(gap_px) {}

  /// Appends the chain on from `start` (included), forwards (bright side left) or backwards.
  void follow(std::int32_t start, int sense, std::vector<ChainPoint>& chain) {
    const std::size_t first = chain.size();
    for (std::int32_t here = start; here >= 0;) {
      chain.push_back(subPixel(here));
      retire(here);
      std::int32_t next = step(here, sense);
      if (next < 0 && chain.size() - first >= kStraight) next = jump(chain, sense);
      here = next;
    }
  }

 private:
  /// The point itself and its neighbours across the edge, which belong to the same crossing of it.
  void retire(std::int32_t i) {
    const int across = std::abs(planes_.gx[i]) >= std::abs(planes_.gy[i]) ? 1 : planes_.width;
    planes_.is_edge[i] = 0;
    planes_.is_edge[i - across] = 0;
    planes_.is_edge[i + across] = 0;
  }

  bool compatible(std::int32_t i, std::int32_t j) const {
    const double dot = static_cast<double>(planes_.gx[i]) * planes_.gx[j] + planes_.gy[i] * planes_.gy[j];
    return dot >= kMinimumCos * planes_.magnitude[i] * planes_.magnitude[j];
  }

  std::int32_t step(std::int32_t here, int sense) const {
    // Bright on the left: the way is the gradient turned by 90 degrees.
    const int direction = directionClass(-sense * planes_.gy[here], sense * planes_.gx[here]);
    std::int32_t best = -1;
    for (const int turn : {0, 7, 1}) {
      const int d = (direction + turn) & 7;
      const std::int32_t next = here + kStepY[d] * planes_.width + kStepX[d];
      if (!planes_.is_edge[next] || !compatible(here, next)) continue;
      if (best < 0 || planes_.magnitude[next] > planes_.magnitude[best]) best = next;
    }
    return best;
  }

  std::int32_t jump(const std::vector<ChainPoint>& chain, int) const {
    const ChainPoint& end = chain.back();
    const ChainPoint& back = chain[chain.size() - kStraight];
    const float dx = end.x - back.x;
    const float dy = end.y - back.y;
    const float length = std::hypot(dx, dy);
    if (length <= 0.0F) return -1;
    // One pixel a step along the longer axis; sideways one pixel is allowed.
    const bool flat = std::abs(dx) >= std::abs(dy);
    const float scale = 1.0F / std::max(std::abs(dx), std::abs(dy));
    for (int k = 2; k <= gap_px_ + 1; ++k) {
      const int x = static_cast<int>(std::lround(end.x + dx * scale * static_cast<float>(k)));
      const int y = static_cast<int>(std::lround(end.y + dy * scale * static_cast<float>(k)));
      if (x < 3 || y < 3 || x + 3 >= planes_.width || y + 3 >= planes_.height) return -1;
      for (const int aside : {0, -1, 1}) {
        const std::int32_t next = flat ? (y + aside) * planes_.width + x : y * planes_.width + x + aside;
        if (planes_.is_edge[next] && compatible(end.index, next)) return next;
      }
    }
    return -1;
  }

  /// Top of the parabola through the magnitudes on the axis across the edge.
  ChainPoint subPixel(std::int32_t i) const {
    const bool steep = std::abs(planes_.gx[i]) >= std::abs(planes_.gy[i]);
    const int across = steep ? 1 : planes_.width;
    const float before = planes_.magnitude[i - across];
    const float here = planes_.magnitude[i];
    const float after = planes_.magnitude[i + across];
    const float curvature = before - 2.0F * here + after;
    const float offset = curvature < 0.0F ? 0.5F * (before - after) / curvature : 0.0F;
    const auto x = static_cast<float>(i % planes_.width);
    const auto y = static_cast<float>(i / planes_.width);
    return steep ? ChainPoint{x + offset, y, i} : ChainPoint{x, y + offset, i};
  }

  EdgePlanes& planes_;
  int gap_px_;
};

/// A ring begins anywhere on a side: going on over its beginning shows that side whole.
void closeRing(std::vector<ChainPoint>& chains, std::size_t begin) {
  const std::size_t count = chains.size() - begin;
  if (count < 2 * kRingOverlap) return;
  const ChainPoint& first = chains[begin];
  const ChainPoint& last = chains.back();
  if (std::hypot(first.x - last.x, first.y - last.y) > kRingGap_px) return;
  for (std::size_t i = 0; i < kRingOverlap; ++i) chains.push_back(ChainPoint(chains[begin + i]));
}

}  // namespace

void followChains(EdgePlanes& planes, int gap_px, std::vector<ChainPoint>& chains,
                  std::vector<std::int32_t>& begins) {
  chains.clear();
  begins.clear();
  Follower follower(planes, gap_px);
  for (const std::int32_t start : planes.edges) {
    if (!planes.is_edge[start]) continue;
    const auto begin = static_cast<std::ptrdiff_t>(chains.size());
    begins.push_back(static_cast<std::int32_t>(begin));
    // Backwards first and reversed, then on from the start, so that the whole chain runs one way.
    follower.follow(start, -1, chains);
    std::reverse(chains.begin() + begin, chains.end());
    const ChainPoint middle = chains.back();
    chains.pop_back();
    const std::size_t before = chains.size();
    follower.follow(start, 1, chains);
    if (chains.size() == before) chains.push_back(middle);
    closeRing(chains, static_cast<std::size_t>(begin));
  }
  begins.push_back(static_cast<std::int32_t>(chains.size()));
}

}  // namespace vismem
