// Maps as occupancy grids of map_server.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "localization/core/map/visibility.h"
#include "mapper/core/map_output.h"

namespace vismem {
namespace {

constexpr unsigned char kOccupied = 0;
constexpr unsigned char kFree = 254;
constexpr unsigned char kUnknown = 205;

class Grid {
 public:
  Grid(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double resolution_m) {
    image_.resolution_m = resolution_m;
    image_.low = low;
    image_.width = static_cast<int>(std::ceil((high.x() - low.x()) / resolution_m));
    image_.height = static_cast<int>(std::ceil((high.y() - low.y()) / resolution_m));
    image_.cells.assign(static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height),
                        kUnknown);
  }

  /// Null outside.
  unsigned char* at(const Eigen::Vector2d& p) {
    const int x = static_cast<int>(std::floor((p.x() - image_.low.x()) / image_.resolution_m));
    const int y = static_cast<int>(std::floor((p.y() - image_.low.y()) / image_.resolution_m));
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return nullptr;
    return &image_.cells[static_cast<std::size_t>(image_.height - 1 - y) *
                             static_cast<std::size_t>(image_.width) +
                         static_cast<std::size_t>(x)];
  }
  void occupy(const Segment2& segment) {
    const int steps = static_cast<int>(std::ceil(2.0 * segment.length() / image_.resolution_m)) + 1;
    for (int i = 0; i <= steps; ++i) {
      if (auto* cell = at(segment.a + (segment.b - segment.a) * (static_cast<double>(i) / steps)))
        *cell = kOccupied;
    }
  }
  /// Frees a ray up to the first obstacle.
  void see(const Eigen::Vector2d& from, double heading_rad, double range_m) {
    const Eigen::Vector2d u(std::cos(heading_rad), std::sin(heading_rad));
    const double step = 0.5 * image_.resolution_m;
    Eigen::Vector2d before = from;
    for (double s = 0.0; s < range_m; s += step) {
      const Eigen::Vector2d p = from + s * u;
      auto* cell = at(p);
      if (!cell || *cell == kOccupied) return;
      // Cells of a wall that touch at a corner only: nothing passes between them.
      if (isOccupied({before.x(), p.y()}) && isOccupied({p.x(), before.y()})) return;
      *cell = kFree;
      before = p;
    }
  }
  void drive(const Eigen::Vector2d& p, double radius_m) {
    for (double dx = -radius_m; dx <= radius_m; dx += 0.5 * image_.resolution_m) {
      for (double dy = -radius_m; dy <= radius_m; dy += 0.5 * image_.resolution_m) {
        if (dx * dx + dy * dy > radius_m * radius_m) continue;
        auto* cell = at(p + Eigen::Vector2d(dx, dy));
        if (cell && *cell != kOccupied) *cell = kFree;
      }
    }
  }
  GridImage take() { return std::move(image_); }

 private:
  bool isOccupied(const Eigen::Vector2d& p) {
    const auto* cell = at(p);
    return cell && *cell == kOccupied;
  }

  GridImage image_;
};

}  // namespace

GridImage gridOf(const SegmentMap& map, const DriveRecord& record, const std::vector<Pose2>& poses,
                 const GridParams& params) {
  Eigen::Vector2d low = map.low();
  Eigen::Vector2d high = map.high();
  for (const Pose2& pose : poses) {
    low = low.cwiseMin(pose.position());
    high = high.cwiseMax(pose.position());
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(params.margin_m);
  Grid grid(low - margin, high + margin, params.resolution_m);
  for (const MapSegment& segment : map.segments) {
    if (segment.width_m <= 0.0 && matchesAny(segment.label, params.obstacles))
      grid.occupy(segment.world.floor());
  }
  constexpr double kRay_rad = 0.01;
  for (std::size_t k = 0; k < poses.size() && k < record.keyframes.size(); ++k) {
    const Keyframe& keyframe = record.keyframes[k];
    const Pose3 T = toPose3(poses[k]) * keyframe.T_robot_camera;
    const Eigen::Vector3d axis = T.linear().col(2);
    const double middle = std::atan2(axis.y(), axis.x());
    const double half = std::atan(0.5 * keyframe.intrinsics.width / keyframe.intrinsics.fx);
    for (double off = -half; off <= half; off += kRay_rad) {
      grid.see(T.translation().head<2>(), middle + off, params.range_m);
    }
    grid.drive(poses[k].position(), params.robot_m);
  }
  return grid.take();
}

std::string pgmOf(const GridImage& grid) {
  std::string bytes = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  bytes.append(grid.cells.begin(), grid.cells.end());
  return bytes;
}

std::string gridYamlOf(const GridImage& grid, const std::string& image) {
  std::array<char, 300> text{};
  std::snprintf(text.data(), text.size(),
                "image: %s\nresolution: %.3f\norigin: [%.3f, %.3f, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
                "free_thresh: 0.196\n",
                image.c_str(), grid.resolution_m, grid.low.x(), grid.low.y());
  return text.data();
}

}  // namespace vismem
