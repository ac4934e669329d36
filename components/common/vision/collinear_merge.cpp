#include "common/vision/collinear_merge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kTurn = 65536.0;  // what an angle of 16 bits wraps at
constexpr double kDiamondTurn = 4.0;
constexpr int kShift = 32768;  // makes numbers of 16 bits positive
constexpr int kBins = 32;      // by direction; a power of two
constexpr int kAngles = 65536;
constexpr int kBinWidth = kAngles / kBins;
constexpr int kMaximumCells = 256;  // of a bin, by position; a power of two

/// An angle that grows with the direction, -1 .. 3 for a turn: linear along |x| + |y| = 1. A radian is
/// between 1/2 and 1 of it.
double diamondAngle(const Eigen::Vector2d& direction) {
  const double quadrant = direction.y() / (std::abs(direction.x()) + std::abs(direction.y()));
  return direction.x() >= 0.0 ? quadrant : 2.0 - quadrant;
}

}  // namespace

/// A segment as a rod: mass (length), middle and second moments survive any number of joins, so the line of
/// a joined one is the least-squares line of all its original parts.
struct alignas(64) CollinearMerger::Rod {
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
    // Half-angle of (xx - yy, 2 xy) without trigonometry.
    const double c = xx - yy;
    const double s = 2.0 * xy;
    const double r = std::sqrt(c * c + s * s);
    const double cos_twice = r > 0.0 ? c / r : 1.0;
    direction = {std::sqrt(std::max(0.0, 0.5 * (1.0 + cos_twice))),
                 std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - cos_twice))), s)};
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

/// About a rod, in whole pixels, and its direction.
struct CollinearMerger::Box {
  std::int16_t left, right, top, bottom;
  std::uint16_t angle;  // wraps
  int rod;
};

/// Boxes and directions of rods as columns of numbers, for fast rejection of most pairs. Rods are sorted into
/// bins by direction. In a bin they are sorted into cells across the rods: from left to right for steep ones,
/// from top to bottom for flat ones.
class CollinearMerger::Lanes {
 public:
  /// Box of a rod, extended at both ends by half of the longest allowed gap and by `reach_px` aside: boxes of
  /// two that can be joined overlap.
  static Box boxOf(const Rod& rod, int index, double half_gap_px, double reach_px) {
    // Numbers saturate at the ends of their range: overlapping boxes still overlap. Rounded down; up is one
    // more.
    const auto whole = [](double value) {
      return static_cast<int>(std::min(std::max(value, -32000.0), 32000.0) + kShift) - kShift;
    };
    const Eigen::Vector2d ahead = half_gap_px * rod.direction;
    const Eigen::Vector2d a = rod.px.a - ahead;
    const Eigen::Vector2d b = rod.px.b + ahead;
    const Eigen::Vector2d low = a.cwiseMin(b);
    const Eigen::Vector2d high = a.cwiseMax(b);
    const auto angle = static_cast<int>((diamondAngle(rod.direction) + 1.0) * (kTurn / kDiamondTurn));
    return {static_cast<std::int16_t>(whole(low.x() - reach_px)),
            static_cast<std::int16_t>(whole(high.x() + reach_px) + 1),
            static_cast<std::int16_t>(whole(low.y() - reach_px)),
            static_cast<std::int16_t>(whole(high.y() + reach_px) + 1),
            static_cast<std::uint16_t>(angle),
            index};
  }

  void reserve(std::size_t count) {
    for (auto* column : {&left_, &right_, &top_, &bottom_}) column->reserve(count + kBoxBlock);
    angle_.reserve(count + kBoxBlock);
    rod_.reserve(count);
  }
  /// Sorts rods into the lanes, after counting them per cell.
  void lay(const std::vector<Box>& boxes) {
    const std::size_t count = boxes.size();
    rod_.resize(count);
    for (auto* column : {&left_, &right_, &top_, &bottom_}) column->resize(count + kBoxBlock);
    angle_.resize(count + kBoxBlock);
    std::fill_n(extent_, kBins, 0);
    lowest_ = count == 0 ? 0 : kShift;
    int highest = lowest_ - 1;
    for (const Box& box : boxes) {
      const int bin = binOf(box);
      const int low = lowOf(box, bin);
      lowest_ = std::min(lowest_, low);
      highest = std::max(highest, low);
      extent_[bin] = std::max(extent_[bin], highOf(box, bin) - low);
    }
    cells_ = 1;
    while (cells_ < kMaximumCells && kBins * cells_ < static_cast<int>(count)) cells_ *= 2;
    cell_shift_ = 0;
    while ((highest - lowest_) >> cell_shift_ >= cells_) ++cell_shift_;
    // begin_[c + 2] counts those of cell c, then begin_[c + 1] is where the next one of it goes: in the end,
    // its end.
    std::fill_n(begin_, kBins * cells_ + 2, 0);
    for (const Box& box : boxes) ++begin_[cellOf(box) + 2];
    for (int c = 0; c < kBins * cells_; ++c) begin_[c + 1] += begin_[c];
    for (const Box& box : boxes) {
      const int lane = begin_[cellOf(box) + 1]++;
      rod_[lane] = box.rod;
      set(lane, box);
    }
  }
  int count() const { return static_cast<int>(rod_.size()); }
  int rod(int lane) const { return rod_[lane]; }
  Box box(int lane) const {
    return {left_[lane], right_[lane], top_[lane], bottom_[lane], angle_[lane], rod_[lane]};
  }
  /// The first lane of a bin whose box may overlap this one, and the end of those that may.
  int firstOf(int bin, const Box& box) const { return begin_[cellAt(bin, lowOf(box, bin) - extent_[bin])]; }
  int endOf(int bin, const Box& box) const { return begin_[cellAt(bin, highOf(box, bin)) + 1]; }

  BoxLanes boxes() const { return {left_.data(), right_.data(), top_.data(), bottom_.data(), angle_.data()}; }

 private:
  static int binOf(const Box& box) { return box.angle / kBinWidth; }
  int cellAt(int bin, int position) const {
    return bin * cells_ + std::clamp((position - lowest_) >> cell_shift_, 0, cells_ - 1);
  }
  int cellOf(const Box& box) const {
    const int bin = binOf(box);
    return cellAt(bin, lowOf(box, bin));
  }
  /// An angle is 0 upwards and a quarter of its range to the right.
  static bool steep(int bin) { return ((bin + kBins / 8) & (kBins / 2 - 1)) < kBins / 4; }
  static int lowOf(const Box& box, int bin) { return steep(bin) ? box.left : box.top; }
  static int highOf(const Box& box, int bin) { return steep(bin) ? box.right : box.bottom; }
  void set(std::size_t k, const Box& box) {
    left_[k] = box.left;
    right_[k] = box.right;
    top_[k] = box.top;
    bottom_[k] = box.bottom;
    angle_[k] = box.angle;
  }

  std::vector<std::int16_t> left_, right_, top_, bottom_;
  std::vector<std::uint16_t> angle_;
  std::vector<int> rod_;
  int cells_ = 1;
  int cell_shift_ = 0;                         // they are 1 << so many px wide
  int lowest_ = 0;                             // where the first one begins
  int begin_[kBins * kMaximumCells + 2] = {};  // of the lanes of a cell
  int extent_[kBins] = {};                     // of a bin's largest box, along what it is sorted by
};

CollinearMerger::CollinearMerger(const EdgeRowKernel& kernel)
    : kernel_(&kernel), given_(std::make_unique<Lanes>()), joined_(std::make_unique<Lanes>()) {}
CollinearMerger::~CollinearMerger() = default;
CollinearMerger::CollinearMerger(CollinearMerger&&) noexcept = default;
CollinearMerger& CollinearMerger::operator=(CollinearMerger&&) noexcept = default;

double CollinearMerger::longestGap(const Rod& shorter, const CollinearMergeParams& params) const {
  if (evidence_ == nullptr) return params.gap_px;
  return std::max(params.gap_px, std::min(params.bridge_px, params.bridge_share * shorter.length));
}

void CollinearMerger::reserve(std::size_t segments) {
  rods_.reserve(2 * segments);  // each join leaves one rod less
  candidates_.reserve(8 * segments);
  given_->reserve(segments);
  joined_->reserve(segments);
  boxes_.reserve(segments);
  overlapping_.reserve(segments + kBoxBlock);
}

/// Sorts the rods from `begin` on that are not part of another one.
void CollinearMerger::lay(int begin, const CollinearMergeParams& params, Lanes& lanes) {
  boxes_.clear();
  for (int i = begin; i < static_cast<int>(rods_.size()); ++i) {
    if (!rods_[i].alive) continue;
    boxes_.push_back(Lanes::boxOf(rods_[i], i, 0.5 * longestGap(rods_[i], params), reach_px_));
  }
  lanes.lay(boxes_);
}

/// All pairs that may be joined and have at least one rod from `first_fresh` on, closest first. Long gaps are
/// checked for their length only.
void CollinearMerger::findCandidates(int given, int first_fresh, const CollinearMergeParams& params) {
  candidates_.clear();
  if (first_fresh == 0) {
    lay(0, params, *given_);
    for (int lane = 0; lane < given_->count(); ++lane) compare(given_->box(lane), lane + 1, *given_, params);
  } else {
    lay(given, params, *joined_);
    for (int lane = 0; lane < joined_->count(); ++lane) {
      const Box box = joined_->box(lane);
      if (box.rod < first_fresh) continue;
      compare(box, 0, *given_, params);
      compare(box, 0, *joined_, params);
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.gap, x.offset, x.a, x.b) < std::tie(y.gap, y.offset, y.a, y.b);
  });
}

/// Compares all rods in lanes with the box's rod. If those before `begin` have been compared already, the rod
/// lies in the lane before, and bins of smaller angles compare with it themselves.
void CollinearMerger::compare(const Box& box, int begin, const Lanes& lanes,
                              const CollinearMergeParams& params) {
  const int lowest = box.angle - (begin == 0 ? angle_limit_ : 0);
  const int first_bin = (lowest + kAngles) / kBinWidth;
  const int last_bin = std::min((box.angle + angle_limit_ + kAngles) / kBinWidth, first_bin + kBins - 1);
  const BoxQuery query{box.left,
                       box.right,
                       box.top,
                       box.bottom,
                       static_cast<std::uint16_t>(box.angle - angle_limit_),
                       static_cast<std::uint16_t>(2 * angle_limit_)};
  const auto room = static_cast<std::size_t>(lanes.count() + kBoxBlock);
  if (overlapping_.size() < room) overlapping_.resize(room);
  for (int bin = first_bin; bin <= last_bin; ++bin) {
    const int which = bin % kBins;
    const int lane = begin != 0 && bin == first_bin ? begin : lanes.firstOf(which, box);
    const int found =
        kernel_->overlaps(lanes.boxes(), query, lane, lanes.endOf(which, box), overlapping_.data());
    for (int k = 0; k < found; ++k) {
      const int other = lanes.rod(overlapping_[k]);
      if (other != box.rod) judge(box.rod, other, params);
    }
  }
}

void CollinearMerger::judge(int index, int other_index, const CollinearMergeParams& params) {
  const Rod& rod = rods_[index];
  const Rod& other = rods_[other_index];
  if (rod.direction.dot(other.direction) < cos_limit_ || !other.alive || other.group != rod.group) return;
  // Of two of the same length the earlier is the reference, in either order of comparison.
  const bool rod_is_longer = rod.length > other.length || (rod.length == other.length && index < other_index);
  const Rod& longer = rod_is_longer ? rod : other;
  const Rod& shorter = rod_is_longer ? other : rod;
  const Eigen::Vector2d normal = turned90(longer.direction);
  const Eigen::Vector2d a = shorter.px.a - longer.px.a;
  const Eigen::Vector2d b = shorter.px.b - longer.px.a;
  const double offset = std::max(std::abs(a.dot(normal)), std::abs(b.dot(normal)));
  if (offset > params.offset_px) return;
  const double begin = a.dot(longer.direction);
  const double end = b.dot(longer.direction);
  const double gap = std::max({0.0, begin - longer.length, -end});
  if (gap > params.gap_px && gap > longestGap(shorter, params)) return;
  candidates_.push_back({gap, offset, std::min(index, other_index), std::max(index, other_index)});
}

/// Whether the edge continues in the long gap between two rods.
bool CollinearMerger::goesOn(const Rod& a, const Rod& b) const {
  const bool ahead = (b.middle - a.middle).dot(a.direction) > 0.0;
  const Rod& before = ahead ? a : b;
  const Rod& after = ahead ? b : a;
  return evidence_->goesOn({before.px.b, after.px.a}, before.px, after.px);
}

void CollinearMerger::merge(std::vector<GroupedSegment>& segments, const CollinearMergeParams& params,
                            const GapEvidence* evidence) {
  evidence_ = evidence;
  rods_.clear();
  for (const auto& segment : segments) {
    if (segment.px.length() > 0.0) rods_.emplace_back(segment);
  }
  segments.clear();
  if (rods_.empty()) return;
  cos_limit_ = std::cos(params.angle_rad);
  // Half of the distance between the ends of two rods extended to the middle of a gap: their directions
  // differ.
  const double longest_px = evidence == nullptr ? params.gap_px : std::max(params.gap_px, params.bridge_px);
  reach_px_ =
      0.5 * (params.offset_px + longest_px * std::sin(std::min(params.angle_rad, 0.5 * std::numbers::pi))) +
      0.01;
  angle_limit_ = static_cast<std::uint16_t>(
      std::min(std::ceil(params.angle_rad * (kTurn / kDiamondTurn)) + 2.0, 0.5 * kTurn - 1.0));
  const auto given = static_cast<int>(rods_.size());
  int first_fresh = 0;
  while (first_fresh < static_cast<int>(rods_.size())) {
    const int count = static_cast<int>(rods_.size());
    // Two that were both left over cannot be joined with each other, or that pass would have.
    findCandidates(given, first_fresh, params);
    first_fresh = count;
    for (const Candidate& pair : candidates_) {
      const Rod& a = rods_[pair.a];
      const Rod& b = rods_[pair.b];
      // The image is evaluated only now: most rods with a long gap beside them have been joined over a
      // shorter one.
      if (!a.alive || !b.alive || (pair.gap > params.gap_px && !goesOn(a, b))) continue;
      rods_[pair.a].alive = rods_[pair.b].alive = false;
      rods_.emplace_back(Rod(rods_[pair.a], rods_[pair.b]));
    }
  }
  for (const Rod& rod : rods_) {
    if (rod.alive) segments.push_back({rod.px, rod.group, rod.mass / rod.length, rod.value});
  }
}

}  // namespace vismem
