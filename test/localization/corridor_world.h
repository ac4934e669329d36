// A small ring corridor and a synthetic visual memory of it, for tests of localization without images.
#pragma once

#include <map>
#include <random>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/random_engine.h"

namespace vismem::test {

/// A ring of 1.5 m width around a 6.5 x 3.5 m block, with doors at irregular places: the centre line is
/// 26 m long. Labels `skirting` and `door_foot`.
SegmentMap corridorMap();

struct CorridorParams {
  double rate_hz = 10.0;
  double speed_mps = 0.3;
  double odometry_scale_error = 0.03;  ///< systematic, of the distance
  double odometry_turn_noise = 0.02;   ///< rad per sqrt(m)
  double end_noise_m = 0.02;           ///< of remembered ends, per metre of range
  double false_share = 0.0;            ///< false segments per true one
  double range_m = 4.0;
  double fov_rad = 1.05;
};

/// Drives along the ring's centre line with a panning camera and remembers the segments in view.
class CorridorWorld {
 public:
  CorridorWorld(const CorridorParams& params, std::uint64_t seed);

  /// The next image's update.
  MemoryUpdate next();
  /// At the last update.
  const Pose2& truth() const { return T_world_robot_; }
  double seconds() const { return time_s_; }
  /// Displaces the robot on the ring without odometry; the memory starts a new epoch.
  void kidnap();

 private:
  struct Remembered {
    MemorySegment segment;
    double low = 1.0;  ///< seen part of the map segment, as fractions
    double high = 0.0;
  };
  void drive(double dt_s);
  void look();
  bool isVisible(const Eigen::Vector2d& p_world) const;

  CorridorParams params_;
  RandomEngine engine_;
  SegmentMap map_;
  double along_m_ = 0.0;  ///< on the centre line
  double direction_ = 1.0;
  double pan_rad_ = 0.0;
  double time_s_ = 0.0;
  double scale_ = 1.0;
  Pose2 T_world_robot_;
  Pose2 T_odom_robot_;
  std::map<std::size_t, Remembered> memory_;
  std::vector<MemorySegment> false_;
  std::uint64_t revision_ = 0;
  std::uint64_t next_id_ = 1;
  std::uint32_t epoch_ = 0;
};

}  // namespace vismem::test
