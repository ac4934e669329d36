#include "active_visual_memory/core/gaze/attention.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/segment.h"

namespace vismem {
namespace {

constexpr StampUs kTick_us = 200'000;    // salience grows by its rate once per tick (A1)
constexpr double kHypothesisLead = 1.0;  // a new hypothesis starts this far above the most salient other
constexpr double kUrgentLead = 1.0;      // an urgent request starts this far above all points of no client
constexpr double kScanningLead = 10.0;   // a scanning point starts this far above the most salient other
constexpr double kForcedSearchObjects = 5.0;  // objects that double the time between forced searches (A3)
constexpr double kPanStep_rad = 0.70;         // of the systematic pattern, at most; 40 degrees
constexpr double kTiltStep_rad = 0.55;
constexpr double kFocusDistance_m = 3.0;  // the part of a long segment within this distance is looked at

/// Number of stops that cover a range with a step of at most `step`.
int stops(double low, double high, double step) {
  return 1 + static_cast<int>(std::ceil(std::max(0.0, high - low) / step - 1e-9));
}

}  // namespace

Eigen::Vector3d focusOf(const Segment3& odom, const Eigen::Vector2d& robot, double distance_m) {
  const Segment2 floor = odom.floor();
  const auto near = clipToDisc(floor, robot, distance_m);
  const double at =
      near ? 0.5 * (near->first + near->second) : std::clamp(projectionFraction(robot, floor), 0.0, 1.0);
  return odom.a + at * (odom.b - odom.a);
}

void AttentionPool::Params::visit(ParameterVisitor& v) {
  v.real(basic("SegmentRate", "A2: growth of salience per tick of 200 ms of segments"),
         rateOf(AttentionKind::kSegment), 0.0, 1000.0);
  v.real(basic("PrimitiveRate", "the same of shapes"), rateOf(AttentionKind::kPrimitive), 0.0, 1000.0);
  v.real(basic("HypothesisRate", "the same of inferred corners"), rateOf(AttentionKind::kHypothesis), 0.0,
         1000.0);
  v.real(basic("ClientRate", "the same of clients' requests, times their priority"),
         rateOf(AttentionKind::kClient), 0.0, 1000.0);
  v.real(expert("ForcedSearch_s", "A3: time between searches, times (1 + objects / 5)"), forced_search_s, 0.1,
         3600.0);
}

AttentionPool::Params AttentionPool::Params::chapter() {
  Params p;
  p.visit_angle_rad = degToRad(5.0);
  p.count_groups = false;
  p.look_around_first = false;
  p.forced_search_s = 5.0;
  p.max_forced_search_s = 20.0;
  p.scanning = Scanning::kAlternate;
  p.scan_min_tilt_rad = degToRad(-31.0);
  p.scan_max_tilt_rad = degToRad(31.0);
  return p;
}

AttentionPool::AttentionPool(const Params& params, const Rig& rig)
    : params_(params), rig_(rig), clock_(kTick_us), random_(params.seed) {}

PanTilt AttentionPool::directionOf(const AttentionPoint& point, const Pose2& T_odom_robot) const {
  if (point.direction) return *point.direction;
  return panTiltTowards(rig_.mount, transform(inverse(T_odom_robot), *point.p_odom));
}

void AttentionPool::follow(const AttentionObjects& objects, const Pose2& T_odom_robot) {
  struct Object {
    AttentionKind kind;
    std::uint64_t id;
    Eigen::Vector3d place;
    bool old = false;
  };
  // In the order of the memory, not of a hash: the same input gives the same ids.
  std::pmr::vector<Object> alive(scratch_.resource());
  alive.reserve(objects.segments.size() + objects.primitives.size() + objects.hypotheses.size());
  for (const MemorySegment& segment : objects.segments) {
    const Eigen::Vector3d place = focusOf(segment.odom, T_odom_robot.position(), kFocusDistance_m);
    alive.push_back({AttentionKind::kSegment, segment.id, place});
  }
  const auto onFloor = [](const Eigen::Vector2d& p) { return Eigen::Vector3d(p.x(), p.y(), 0.0); };
  for (const Primitive& primitive : objects.primitives) {
    if (primitive.kind == PrimitiveKind::kStripe) continue;
    alive.push_back({AttentionKind::kPrimitive, primitive.id, onFloor(primitive.centre)});
  }
  for (const VertexHypothesis& corner : objects.hypotheses) {
    alive.push_back({AttentionKind::kHypothesis, corner.primitive_id, onFloor(corner.p_odom)});
  }

  const auto key = [](AttentionKind kind, std::uint64_t id) {
    return static_cast<std::uint64_t>(kind) << 60 | id;
  };
  std::pmr::vector<std::pair<std::uint64_t, Object*>> by_key(scratch_.resource());
  by_key.reserve(alive.size());
  for (Object& object : alive) by_key.emplace_back(key(object.kind, object.id), &object);
  if (!std::is_sorted(by_key.begin(), by_key.end())) std::sort(by_key.begin(), by_key.end());
  auto next = by_key.begin();  // most points come in the order of their objects
  std::erase_if(entries_, [&](Entry& entry) {
    if (entry.object_id == 0) return false;
    const std::uint64_t wanted = key(entry.point.kind, entry.object_id);
    if (next == by_key.end() || next->first != wanted)
      next = std::lower_bound(by_key.begin(), by_key.end(), std::pair{wanted, alive.data()});
    if (next == by_key.end() || next->first != wanted) return true;
    entry.point.p_odom = next->second->place;
    next->second->old = true;
    ++next;
    return false;
  });
  const double known = highest();
  for (const Object& object : alive) {
    if (object.old) continue;
    Entry entry;
    entry.point.id = next_id_++;
    entry.point.kind = object.kind;
    entry.point.p_odom = object.place;
    // A hypothesis is visited at once (M9); after that its salience grows like the others.
    if (object.kind == AttentionKind::kHypothesis) entry.point.salience = known + kHypothesisLead;
    entry.object_id = object.id;
    entries_.push_back(std::move(entry));
  }
}

double AttentionPool::countObjects(const Pose2& T_odom_robot) const {
  if (!params_.count_groups) {
    return static_cast<double>(std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) {
      return entry.point.kind == AttentionKind::kSegment;
    }));
  }
  // Unit vectors from the pan-tilt unit: angles of all pairs would cost more than the rest of the gaze.
  const Pose3 T_pantilt_odom = (toPose3(T_odom_robot) * rig_.mount.T_robot_pantilt).inverse();
  const double least_cosine = std::cos(params_.visit_angle_rad);
  std::pmr::vector<Eigen::Vector3d> groups(scratch_.resource());
  for (const Entry& entry : entries_) {
    if (entry.point.kind != AttentionKind::kSegment) continue;
    const Eigen::Vector3d axis = (T_pantilt_odom * *entry.point.p_odom).normalized();
    const bool known = std::any_of(groups.begin(), groups.end(), [&](const Eigen::Vector3d& group) {
      return group.dot(axis) >= least_cosine;
    });
    if (!known) groups.push_back(axis);
  }
  return static_cast<double>(groups.size());
}

bool AttentionPool::isSearchDue(double elapsed_s, const Pose2& T_odom_robot) const {
  if (elapsed_s >= params_.max_forced_search_s) return true;
  // Objects make it later only.
  return elapsed_s >= params_.forced_search_s &&
         elapsed_s >= params_.forced_search_s * (1.0 + countObjects(T_odom_robot) / kForcedSearchObjects);
}

void AttentionPool::update(StampUs stamp_us, const AttentionObjects& objects, const Pose2& T_odom_robot,
                           std::optional<std::uint64_t> attended) {
  scratch_.release();
  follow(objects, T_odom_robot);
  std::erase_if(entries_, [&](const Entry& e) { return e.request && e.request->deadline_us < stamp_us; });
  const double ticks = clock_.advance(stamp_us) / toSeconds(kTick_us);
  for (Entry& entry : entries_) {
    if (attended && entry.point.id == *attended) continue;
    const double priority = entry.request ? entry.request->priority : 1.0;
    entry.point.salience += ticks * (params_.rateOf(entry.point.kind) * priority);
  }
  if (!last_scan_us_ || stamp_us < *last_scan_us_) last_scan_us_ = stamp_us;
  if (lookingAround() || isSearchDue(toSeconds(stamp_us - *last_scan_us_), T_odom_robot)) {
    addScanningPoint();
    last_scan_us_ = stamp_us;
  }
}

double AttentionPool::highest(bool of_clients) const {
  double highest = 0.0;
  for (const Entry& entry : entries_) {
    if (of_clients || !entry.request) highest = std::max(highest, entry.point.salience);
  }
  return highest;
}

const AttentionPool::Entry* AttentionPool::best() const {
  const Entry* best = nullptr;
  for (const Entry& entry : entries_) {
    // Points visited or first seen in this tick have salience 0 and are not chosen.
    if (entry.point.salience <= 0.0) continue;
    if (!best || entry.point.salience > best->point.salience) best = &entry;
  }
  return best;
}

const AttentionPool::Entry* AttentionPool::entryOf(std::uint64_t point_id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.point.id == point_id; });
  return found != entries_.end() ? &*found : nullptr;
}

std::optional<AttentionPoint> AttentionPool::mostSalient() const {
  const Entry* entry = best();
  return entry ? std::optional(entry->point) : std::nullopt;
}

bool AttentionPool::isUrgent() const {
  const Entry* entry = best();
  return entry && entry->request && entry->request->priority >= kUrgentPriority;
}

std::optional<AttentionPoint> AttentionPool::find(std::uint64_t id) const {
  const Entry* entry = entryOf(id);
  return entry ? std::optional(entry->point) : std::nullopt;
}

std::optional<std::uint64_t> AttentionPool::segmentOf(std::uint64_t point_id) const {
  const Entry* entry = entryOf(point_id);
  if (!entry || entry->point.kind != AttentionKind::kSegment) return std::nullopt;
  return entry->object_id;
}

void AttentionPool::publishSalience(std::span<MemorySegment> segments,
                                    std::span<Primitive> primitives) const {
  auto next = segments.begin();
  for (const Entry& entry : entries_) {
    if (entry.point.kind == AttentionKind::kPrimitive) {
      const auto found = std::find_if(primitives.begin(), primitives.end(),
                                      [&](const Primitive& p) { return p.id == entry.object_id; });
      if (found != primitives.end()) found->salience = entry.point.salience;
    }
    if (entry.point.kind != AttentionKind::kSegment) continue;
    if (next == segments.end() || next->id != entry.object_id)
      next = std::ranges::lower_bound(segments, entry.object_id, {}, &MemorySegment::id);
    if (next != segments.end() && next->id == entry.object_id) next++->salience = entry.point.salience;
  }
}

void AttentionPool::visited(std::uint64_t id, const PanTilt& axis, const Pose2& T_odom_robot) {
  giveUp(id);
  for (Entry& entry : entries_) {
    const bool near = angleBetween(directionOf(entry.point, T_odom_robot), axis) <= params_.visit_angle_rad;
    if (near) entry.point.salience = 0.0;
  }
}

void AttentionPool::giveUp(std::uint64_t id) {
  std::erase_if(entries_,
                [&](const Entry& e) { return e.point.id == id && e.point.kind == AttentionKind::kScanning; });
  for (Entry& entry : entries_) {
    if (entry.point.id == id) entry.point.salience = 0.0;
  }
}

PanTilt AttentionPool::nextRandom() {
  // Drawn without std distributions, which differ between libraries: a seed means one run.
  const auto uniform = [&] { return static_cast<double>(random_() >> 11) * 0x1.0p-53; };
  const double pan = rig_.min_pan_rad + uniform() * (rig_.max_pan_rad - rig_.min_pan_rad);
  const double tilt =
      params_.scan_min_tilt_rad + uniform() * (params_.scan_max_tilt_rad - params_.scan_min_tilt_rad);
  return {pan, tilt};
}

int AttentionPool::columns() const {
  return stops(rig_.min_pan_rad, rig_.max_pan_rad, kPanStep_rad);
}

int AttentionPool::rows() const {
  return stops(params_.scan_min_tilt_rad, params_.scan_max_tilt_rad, kTiltStep_rad);
}

bool AttentionPool::lookingAround() const {
  return params_.look_around_first && pattern_index_ < columns() * rows();
}

PanTilt AttentionPool::nextSystematic() {
  const int columns = this->columns();
  const int rows = this->rows();
  // Boustrophedon order: successive stops are neighbours. The first one lies ahead.
  const int index = (pattern_index_++ + columns / 2) % (columns * rows);
  const int row = index / columns;
  const int column = row % 2 == 0 ? index % columns : columns - 1 - index % columns;
  const auto at = [](double low, double high, int i, int n) {
    return n > 1 ? low + (high - low) * i / (n - 1) : 0.5 * (low + high);
  };
  return {at(rig_.min_pan_rad, rig_.max_pan_rad, column, columns),
          at(params_.scan_min_tilt_rad, params_.scan_max_tilt_rad, row, rows)};
}

void AttentionPool::addScanningPoint() {
  const auto waits = [](const Entry& entry) { return entry.point.kind == AttentionKind::kScanning; };
  if (std::any_of(entries_.begin(), entries_.end(), waits)) return;
  Entry entry;
  entry.point.id = next_id_++;
  entry.point.kind = AttentionKind::kScanning;
  const bool random = !lookingAround() && (params_.scanning == Scanning::kRandom ||
                                           (params_.scanning == Scanning::kAlternate && random_turn_));
  random_turn_ = !random_turn_;
  entry.point.direction = random ? nextRandom() : nextSystematic();
  entry.point.salience = highest() + kScanningLead;
  entries_.push_back(std::move(entry));
}

void AttentionPool::request(const GazeRequest& request) {
  auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return e.request && e.request->client == request.client && e.request->key == request.key;
  });
  if (entry == entries_.end()) {
    Entry fresh;
    fresh.point.id = next_id_++;
    fresh.point.kind = AttentionKind::kClient;
    entry = entries_.insert(entries_.end(), std::move(fresh));
  }
  // A renewed request keeps its id and its salience.
  const bool was_urgent = entry->request && entry->request->priority >= kUrgentPriority;
  entry->request = request;
  entry->point.p_odom = request.p_odom;
  entry->point.direction = request.direction;
  if (was_urgent || request.priority < kUrgentPriority) return;
  // An urgent request starts above all points of no client.
  entry->point.salience = std::max(entry->point.salience, highest(false)) + kUrgentLead;
}

void AttentionPool::withdraw(const std::string& client, const std::string& key) {
  std::erase_if(entries_, [&](const Entry& e) {
    return e.request && e.request->client == client && e.request->key == key;
  });
}

void AttentionPool::listPoints(std::vector<AttentionPoint>& points) const {
  points.clear();
  points.reserve(entries_.capacity());
  for (const Entry& entry : entries_) points.push_back(entry.point);
}

void AttentionPool::clearPlaces() {
  std::erase_if(entries_, [](const Entry& e) { return e.point.p_odom.has_value(); });
  clock_.reset();
  last_scan_us_.reset();
  pattern_index_ = 0;
}

}  // namespace vismem
