/// @file Attention points: growth and reset of their salience.
/// Pure. Implements A1, A2, A3. See A6.
/// Salience with inhibition of return after L. Itti, C. Koch, "Computational modelling of visual attention",
/// 2001.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "active_visual_memory/core/memory/life.h"
#include "common/config/parameter_visitor.h"
#include "common/memory/scratch.h"
#include "common/robot/rig.h"
#include "common/visual_memory/gaze.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Elements of the memory that compete for attention.
struct AttentionObjects {
  std::span<const MemorySegment> segments;
  std::span<const Primitive> primitives;  ///< stripes compete as their segments
  std::span<const VertexHypothesis> hypotheses;
};

/// All attention points. *Single-threaded* (owner: the perception loop).
/// Invariant: salience >= 0; one point per remembered object; at most one scanning point waits.
class AttentionPool {
 public:
  enum class Scanning { kRandom, kSystematic, kAlternate };

  struct Params {
    /// Growth of salience per tick of 200 ms by AttentionKind (A1); that of clients times the request's
    /// priority.
    std::array<double, 5> rates{1.0, 1.0, 1.0, 2.0, 1.0};
    double visit_angle_rad = 0.26;  ///< a visit resets the points this near to the optical axis (15 degrees)
    double forced_search_s = 2.5;   ///< A3: a scanning point every so long, times (1 + objects / 5)
    double max_forced_search_s = 10.0;
    bool look_around_first = true;  ///< the systematic pattern once at the beginning, before all else
    bool count_groups = true;       ///< objects within one visit's angle count as one for the search
    Scanning scanning = Scanning::kSystematic;
    double scan_min_tilt_rad = -0.35;  ///< the tilts that scanning points use
    double scan_max_tilt_rad = -0.35;
    std::uint64_t seed = 1;  ///< of the random scanning points

    double& rateOf(AttentionKind kind) { return rates[static_cast<std::size_t>(kind)]; }
    void visit(ParameterVisitor& v);
    static Params chapter();
  };

  AttentionPool(const Params& params, const Rig& rig);

  /// Follows the memory's objects, lets salience grow and inserts scanning points when due.
  /// @param attended  id of the point being visited, whose salience does not grow.
  void update(StampUs stamp_us, const AttentionObjects& objects, const Pose2& T_odom_robot,
              std::optional<std::uint64_t> attended);

  /// The most salient point; the older of equals.
  std::optional<AttentionPoint> mostSalient() const;
  std::optional<AttentionPoint> find(std::uint64_t id) const;
  /// Whether the most salient point is an urgent request, which ends the visit of an object.
  bool isUrgent() const;
  /// Id of the segment that a point stands for.
  std::optional<std::uint64_t> segmentOf(std::uint64_t point_id) const;
  /// Sets the salience of all that have a point. @param segments  in the order of their ids.
  void publishSalience(std::span<MemorySegment> segments, std::span<Primitive> primitives) const;

  /// Completes a visit: resets the point and all points near the optical axis `axis`, removes a scanning
  /// point.
  void visited(std::uint64_t id, const PanTilt& axis, const Pose2& T_odom_robot);
  /// Gives up a point that was not reached (A6): resets it, removes a scanning point.
  void giveUp(std::uint64_t id);

  /// Changes how fast the salience of one kind grows, also of the points that wait already.
  /// @param rate_per_tick >= 0; of kClient: times the request's priority.
  void setRate(AttentionKind kind, double rate_per_tick) { params_.rateOf(kind) = rate_per_tick; }
  /// @param interval_s between forced searches (A3), > 0.
  void setForcedSearch(double interval_s) { params_.forced_search_s = interval_s; }

  void addScanningPoint();
  void request(const GazeRequest& request);
  void withdraw(const std::string& client, const std::string& key);

  std::size_t size() const { return entries_.size(); }
  /// @param points replaced.
  void listPoints(std::vector<AttentionPoint>& points) const;
  /// Drops the points that have a place in odom; directions stay.
  void clearPlaces();

 private:
  struct Entry {
    AttentionPoint point;
    std::uint64_t object_id = 0;  ///< of the segment or primitive it stands for; 0: none
    std::optional<GazeRequest> request;
  };
  const Entry* best() const;
  const Entry* entryOf(std::uint64_t point_id) const;
  /// The highest salience of all points; of those of no client.
  double highest(bool of_clients = true) const;
  void follow(const AttentionObjects& objects, const Pose2& T_odom_robot);
  /// Remembered segments, or directions that one visit each would show.
  double countObjects(const Pose2& T_odom_robot) const;
  /// @param elapsed_s since the last search (A3).
  bool isSearchDue(double elapsed_s, const Pose2& T_odom_robot) const;
  PanTilt directionOf(const AttentionPoint& point, const Pose2& T_odom_robot) const;
  PanTilt nextSystematic();
  int columns() const;
  int rows() const;
  bool lookingAround() const;
  PanTilt nextRandom();

  Params params_;
  Rig rig_;
  std::vector<Entry> entries_;
  mutable Scratch scratch_;  ///< of one update
  LifeClock clock_;
  std::mt19937_64 random_;
  std::uint64_t next_id_ = 1;
  int pattern_index_ = 0;
  bool random_turn_ = false;
  std::optional<StampUs> last_scan_us_;
};

/// Gaze point of a segment: the middle of its part within `distance_m` of the robot, or else its nearest
/// point.
Eigen::Vector3d focusOf(const Segment3& odom, const Eigen::Vector2d& robot, double distance_m);

}  // namespace vismem
