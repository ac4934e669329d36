#include "common/vision/collinear_merge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <tuple>

namespace vismem {
namespace {

constexpr int kStripRods = 384;  // about so many of those given in a strip
constexpr int kMaximumStrips = 64;
constexpr float kTurn = 4.0F;  // of the diamond angle

/// An angle that grows with the direction, -1 .. 3 for a turn: linear along |x| + |y| = 1. A radian is
/// between 1/2 and 1 of it.
double diamondAngle(const Eigen::Vector2d& direction) {
  const double quadrant = direction.y() / (std::abs(direction.x()) + std::abs(direction.y()));
  return direction.x() >= 0.0 ? quadrant : 2.0 - quadrant;
}

}  // namespace

/// A segment as a rod: mass (length), middle and second moments survive any number of joins, so the line of
/// a joined one is the least-squares line of all its original parts.
struct CollinearMerger::Rod {
  // First what is looked at for every pair.
  Segment2 px;
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double length = 0.0;
  int group = 0;
  bool alive = true;
  double mass = 0.0;
  double value = 0.0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double xx = 0.0;  // central second moments, times mass
  double xy = 0.0;
  double yy = 0.0;

  explicit Rod(const GroupedSegment& segment)
      : px(segment.px),
        length(segment.px.length()),
        group(segment.group),
        mass(length * segment.weight),
        value(segment.value),
        middle(segment.px.middle()) {
    const Eigen::Vector2d d = px.b - px.a;
    direction = d / length;
    xx = mass * d.x() * d.x() / 12.0;
    xy = mass * d.x() * d.y() / 12.0;
    yy = mass * d.y() * d.y() / 12.0;
  }

  /// Both joined.
  Rod(const Rod& a, const Rod& b) : group(a.group), mass(a.mass + b.mass) {
    const double wa = a.mass / mass;
    const double wb = b.mass / mass;
    value = wa * a.value + wb * b.value;
    middle = wa * a.middle + wb * b.middle;
    const Eigen::Vector2d apart = b.middle - a.middle;
    const double reduced = wa * b.mass;
    xx = a.xx + b.xx + reduced * apart.x() * apart.x();
    xy = a.xy + b.xy + reduced * apart.x() * apart.y();
    yy = a.yy + b.yy + reduced * apart.y() * apart.y();
    const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
    direction = {std::cos(angle), std::sin(angle)};
    if (direction.dot(a.mass >= b.mass ? a.direction : b.direction) < 0.0) direction = -direction;
    double low = 0.0;
    double high = 0.0;
    for (const Eigen::Vector2d* end : {&a.px.a, &a.px.b, &b.px.a, &b.px.b}) {
      const double t = (*end - middle).dot(direction);
      low = std::min(low, t);
      high = std::max(high, t);
    }
    px = {middle + low * direction, middle + high * direction};
    length = high - low;
  }
};

struct CollinearMerger::Candidate {
  double gap = 0.0;
  double offset = 0.0;
  int a = 0;  // < b
  int b = 0;
};

/// What tells most rods apart, as columns of numbers that are compared several at a time.
class CollinearMerger::Lanes {
 public:
  void reserve(std::size_t count) {
    for (auto* column : {&x_, &y_, &dx_, &dy_, &half_, &angle_}) column->reserve(count);
    rod_.reserve(count);
  }
  void clear() {
    for (auto* column : {&x_, &y_, &dx_, &dy_, &half_, &angle_}) column->clear();
    rod_.clear();
  }
  void add(const Rod& rod, int index) {
    const Eigen::Vector2d middle = rod.px.middle();
    x_.push_back(static_cast<float>(middle.x()));
    y_.push_back(static_cast<float>(middle.y()));
    dx_.push_back(static_cast<float>(rod.direction.x()));
    dy_.push_back(static_cast<float>(rod.direction.y()));
    half_.push_back(static_cast<float>(0.5 * rod.length));
    angle_.push_back(static_cast<float>(diamondAngle(rod.direction)));
    rod_.push_back(index);
  }
  int count() const { return static_cast<int>(rod_.size()); }
  int rod(int lane) const { return rod_[lane]; }
  /// First lane in begin..end-1 whose angle is at least `angle`; the lanes must be in order there.
  int firstFrom(float angle, int begin, int end) const {
    return static_cast<int>(std::lower_bound(angle_.begin() + begin, angle_.begin() + end, angle) -
                            angle_.begin());
  }
  /// near[k] is not 0 for every lane begin + k that can be joined with the rod, and for few others.
  void compare(const Rod& rod, int begin, int end, float gap, float offset, float cos_limit,
               std::uint8_t* near) const {
    const Eigen::Vector2d middle = rod.px.middle();
    const auto x = static_cast<float>(middle.x());
    const auto y = static_cast<float>(middle.y());
    const auto dx = static_cast<float>(rod.direction.x());
    const auto dy = static_cast<float>(rod.direction.y());
    const float reach = static_cast<float>(0.5 * rod.length) + gap;
    const float* __restrict lane_x = x_.data() + begin;
    const float* __restrict lane_y = y_.data() + begin;
    const float* __restrict lane_dx = dx_.data() + begin;
    const float* __restrict lane_dy = dy_.data() + begin;
    const float* __restrict lane_half = half_.data() + begin;
    const int count = end - begin;
    for (int k = 0; k < count; ++k) {
      const float ex = lane_x[k] - x;
      const float ey = lane_y[k] - y;
      const float along = std::abs(ex * dx + ey * dy);
      // The middle of the shorter one lies near the line of the longer one, whichever that is.
      const float aside = std::abs(ex * dy - ey * dx);
      const float other_aside = std::abs(ex * lane_dy[k] - ey * lane_dx[k]);
      const float least = aside < other_aside ? aside : other_aside;
      const float cosine = dx * lane_dx[k] + dy * lane_dy[k];
      const int is_near = static_cast<int>(along <= reach + lane_half[k]) &
                          static_cast<int>(least <= offset) & static_cast<int>(cosine >= cos_limit);
      near[k] = static_cast<std::uint8_t>(is_near);
    }
  }

 private:
  std::vector<float> x_, y_, dx_, dy_, half_, angle_;
  std::vector<int> rod_;
};

CollinearMerger::CollinearMerger() : given_(std::make_unique<Lanes>()), joined_(std::make_unique<Lanes>()) {}
CollinearMerger::~CollinearMerger() = default;
CollinearMerger::CollinearMerger(CollinearMerger&&) noexcept = default;
CollinearMerger& CollinearMerger::operator=(CollinearMerger&&) noexcept = default;

void CollinearMerger::reserve(std::size_t segments) {
  rods_.reserve(2 * segments);  // each join leaves one rod less
  candidates_.reserve(4 * segments);
  given_->reserve(2 * segments);
  joined_->reserve(segments);
  strip_begin_.reserve(kMaximumStrips + 1);
  keys_.reserve(2 * segments);
  near_.reserve(2 * segments);
}

/// First and last strip that a rod and all that can be joined to it touch both.
std::pair<int, int> CollinearMerger::stripsOf(const Rod& rod, const CollinearMergeParams& params) const {
  const double reach_px = 0.5 * (params.gap_px + params.offset_px) + slack_px_;  // of each of the two
  const auto strip = [&](double y) {
    return std::clamp(static_cast<int>((y - low_y_) / strip_px_), 0, strip_count_ - 1);
  };
  const auto [y0, y1] = std::minmax(rod.px.a.y(), rod.px.b.y());
  return {strip(y0 - reach_px), strip(y1 + reach_px)};
}

/// Sorts the rods given into strips and by direction.
void CollinearMerger::lay(const CollinearMergeParams& params) {
  Eigen::Vector2d low = rods_.front().px.a;
  Eigen::Vector2d high = low;
  for (const Rod& rod : rods_) {
    low = low.cwiseMin(rod.px.a).cwiseMin(rod.px.b);
    high = high.cwiseMax(rod.px.a).cwiseMax(rod.px.b);
  }
  cos_limit_ = std::cos(params.angle_rad);
  // What single precision may be wrong by.
  slack_px_ = 0.01 + 1e-6 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  const int strips = std::clamp(static_cast<int>(rods_.size()) / kStripRods, 1, kMaximumStrips);
  low_y_ = low.y();
  strip_px_ = std::max((high.y() - low.y()) / strips, 1e-6);
  strip_count_ = strips;
  keys_.clear();
  for (std::size_t i = 0; i < rods_.size(); ++i) {
    const auto angle = static_cast<std::uint64_t>((diamondAngle(rods_[i].direction) + 1.0) * (1 << 20));
    const auto [first, last] = stripsOf(rods_[i], params);
    for (int s = first; s <= last; ++s)
      keys_.push_back(static_cast<std::uint64_t>(s) << 56 | angle << 32 | i);
  }
  std::sort(keys_.begin(), keys_.end());
  given_->clear();
  joined_->clear();
  strip_begin_.assign(1, 0);
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    while (strip_begin_.size() <= keys_[k] >> 56) strip_begin_.push_back(static_cast<int>(k));
    const auto index = static_cast<int>(keys_[k] & 0xffffffffU);
    given_->add(rods_[index], index);
  }
  strip_begin_.push_back(given_->count());
}

/// All pairs that can be joined and have at least one rod from `first_fresh` on, closest first.
void CollinearMerger::findCandidates(int first_fresh, const CollinearMergeParams& params) {
  candidates_.clear();
  near_.resize(std::max(given_->count(), joined_->count()));
  const auto limit = static_cast<float>(std::min(params.angle_rad, 4.0) + 1e-5);
  if (first_fresh == 0) {
    // Each with those after it in its strip, over the end of the turn to the beginning.
    for (std::size_t s = 0; s + 1 < strip_begin_.size(); ++s) {
      const int begin = strip_begin_[s];
      const int end = strip_begin_[s + 1];
      for (int lane = begin; lane < end; ++lane) {
        const int index = given_->rod(lane);
        const auto angle = static_cast<float>(diamondAngle(rods_[index].direction));
        compare(index, *given_, lane + 1, given_->firstFrom(angle + limit, lane + 1, end), params);
        const int over = given_->firstFrom(angle + limit - kTurn, begin, lane);
        compare(index, *given_, begin, over, params);
      }
    }
  } else {
    const int count = static_cast<int>(rods_.size());
    for (int i = first_fresh; i < count; ++i) joined_->add(rods_[i], i);
    for (int i = first_fresh; i < count; ++i) {
      const auto angle = static_cast<float>(diamondAngle(rods_[i].direction));
      const auto [first, last] = stripsOf(rods_[i], params);
      for (int s = first; s <= last; ++s) {
        const int begin = strip_begin_[s];
        const int end = strip_begin_[s + 1];
        for (const float turn : {0.0F, kTurn, -kTurn}) {
          const int from = given_->firstFrom(angle + turn - limit, begin, end);
          compare(i, *given_, from, given_->firstFrom(angle + turn + limit, from, end), params);
        }
      }
      compare(i, *joined_, 0, joined_->count() - count + i, params);
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.gap, x.offset, x.a, x.b) < std::tie(y.gap, y.offset, y.a, y.b);
  });
}

void CollinearMerger::compare(int index, const Lanes& lanes, int begin, int end,
                              const CollinearMergeParams& params) {
  if (begin >= end) return;
  lanes.compare(rods_[index], begin, end, static_cast<float>(params.gap_px + slack_px_),
                static_cast<float>(params.offset_px + slack_px_), static_cast<float>(cos_limit_ - 1e-5),
                near_.data());
  for (int k = 0; k < end - begin; ++k) {
    if (near_[k] != 0) judge(index, lanes.rod(begin + k), params);
  }
}

void CollinearMerger::judge(int index, int other_index, const CollinearMergeParams& params) {
  const Rod& rod = rods_[index];
  const Rod& other = rods_[other_index];
  if (rod.direction.dot(other.direction) < cos_limit_ || !other.alive || other.group != rod.group) return;
  // Of two of the same length the earlier is the measure, whichever looks at the other.
  const bool rod_is_longer = rod.length > other.length || (rod.length == other.length && index < other_index);
  const Rod& longer = rod_is_longer ? rod : other;
  const Rod& shorter = rod_is_longer ? other : rod;
  const Eigen::Vector2d normal(-longer.direction.y(), longer.direction.x());
  const Eigen::Vector2d a = shorter.px.a - longer.px.a;
  const Eigen::Vector2d b = shorter.px.b - longer.px.a;
  const double offset = std::max(std::abs(a.dot(normal)), std::abs(b.dot(normal)));
  if (offset > params.offset_px) return;
  const double begin = a.dot(longer.direction);
  const double end = b.dot(longer.direction);
  const double gap = std::max({0.0, begin - longer.length, -end});
  if (gap > params.gap_px) return;
  candidates_.push_back({gap, offset, std::min(index, other_index), std::max(index, other_index)});
}

void CollinearMerger::merge(std::vector<GroupedSegment>& segments, const CollinearMergeParams& params) {
  rods_.clear();
  for (const auto& segment : segments) {
    if (segment.px.length() > 0.0) rods_.emplace_back(segment);
  }
  segments.clear();
  if (rods_.empty()) return;
  lay(params);
  int first_fresh = 0;
  while (first_fresh < static_cast<int>(rods_.size())) {
    const int count = static_cast<int>(rods_.size());
    // Two that were both left over cannot be joined with each other, or that pass would have.
    findCandidates(first_fresh, params);
    first_fresh = count;
    for (const Candidate& pair : candidates_) {
      if (!rods_[pair.a].alive || !rods_[pair.b].alive) continue;
      rods_[pair.a].alive = rods_[pair.b].alive = false;
      rods_.emplace_back(Rod(rods_[pair.a], rods_[pair.b]));
    }
  }
  for (const Rod& rod : rods_) {
    if (rod.alive) segments.push_back({rod.px, rod.group, rod.mass / rod.length, rod.value});
  }
}

}  // namespace vismem
