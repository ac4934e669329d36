#include "localization/core/map/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kSpacing_m = 0.2;    // between points
constexpr double kIndexCell_m = 2.0;  // of the index
/// A point this near behind an opaque segment counts as visible: walls do not occlude their own foot.
constexpr double kMargin_m = 0.3;
constexpr int kBearings = 256;           // of the depth buffer
constexpr double kPieceRounding = 1e-9;  // of pieces

constexpr double kCellRadius_m = 0.7072 * kIndexCell_m;  // largest distance of a cell's point from its centre
constexpr double kPieceReach_m = 0.2;                    // the same of a piece
constexpr std::size_t kAtOnce = 64;                      // cells

/// Orders cells row by row, and those of a row by x.
std::uint64_t cellKey(std::int32_t x, std::int32_t y) {
  const auto ordered = [](std::int32_t value) { return static_cast<std::uint32_t>(value) ^ 0x8000'0000u; };
  return (std::uint64_t{ordered(y)} << 32) | ordered(x);
}

std::int32_t rowOf(std::uint64_t key) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32) ^ 0x8000'0000u);
}

std::int32_t columnOf(std::uint64_t key) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(key) ^ 0x8000'0000u);
}

std::int32_t cellOf(double value) {
  return static_cast<std::int32_t>(std::floor(value / kIndexCell_m));
}

/// Grows with the bearing from 0 to 4, without trigonometry.
double diamondAngle(const Eigen::Vector2d& p) {
  const double sum = std::abs(p.x()) + std::abs(p.y());
  if (sum == 0.0) return 0.0;
  const double t = p.y() / sum;
  if (p.x() < 0.0) return 2.0 - t;
  return t < 0.0 ? 4.0 + t : t;
}

/// The nearest occluding distance by bearing.
class DepthBuffer {
 public:
  DepthBuffer() { depth_.fill(1e9f); }

  /// Adds `count` adjacent pieces from `start` on, each as long as `step` and short compared with its
  /// distance.
  void add(const Eigen::Vector2d& start, const Eigen::Vector2d& step, int count) {
    int from = bin(start);
    for (int i = 0; i < count; ++i) {
      const int to = bin(start + (i + 1.0) * step);
      add(from, to, static_cast<float>((start + (i + 0.5) * step).norm()));
      from = to;
    }
  }
  bool hides(const Eigen::Vector2d& p) const {
    return p.norm() > static_cast<double>(depth_[static_cast<std::size_t>(bin(p))]) + kMargin_m;
  }

 private:
  void add(int from, int to, float distance) {
    int steps = to - from;
    if (steps > kBearings / 2) steps -= kBearings;
    if (steps < -kBearings / 2) steps += kBearings;
    const int step = steps < 0 ? -1 : 1;
    for (int i = 0; i != steps + step; i += step) {
      float& depth = depth_[static_cast<std::size_t>((from + i + kBearings) % kBearings)];
      depth = std::min(depth, distance);
    }
  }
  static int bin(const Eigen::Vector2d& p) {
    return std::min(kBearings - 1, static_cast<int>(diamondAngle(p) * (kBearings / 4.0)));
  }
  std::array<float, kBearings> depth_;
};

/// The part of a line on the positive side of a border (see CameraView::clip).
bool clipBy(const HalfPlane& border, const Eigen::Vector2d& start, const Eigen::Vector2d& way, double& from,
            double& to) {
  const double at_start = border.at(start);
  const double slope = border.normal.dot(way);
  const double begin = at_start + from * slope;
  const double end = at_start + to * slope;
  if (begin < 0.0 && end < 0.0) return false;
  if (begin < 0.0) from -= begin / slope;
  if (end < 0.0) to -= end / slope;
  return from <= to;
}

/// The sector of bearings and ranges that can contain occluders of given points.
class Sector {
 public:
  explicit Sector(std::span<const VisiblePoint> points) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const VisiblePoint& point : points) middle += point.p_robot;
    middle.normalize();
    double least = 1.0;
    for (const VisiblePoint& point : points) {
      const double distance = point.p_robot.norm();
      range_ = std::max(range_, distance);
      least = std::min(least, distance > 0.0 ? middle.dot(point.p_robot) / distance : -1.0);
    }
    const double half = std::acos(std::max(least, -1.0)) + kWidestBin_rad;
    is_narrow_ = half < 0.5 * std::numbers::pi;
    const Eigen::Vector2d left(-middle.y(), middle.x());
    sides_[0].normal = std::sin(half) * middle + std::cos(half) * left;
    sides_[1].normal = std::sin(half) * middle - std::cos(half) * left;
  }
  /// Largest distance of an occluder.
  double range() const { return range_; }
  /// False if the disc of `radius_m` about the point contains no occluder.
  bool mayHide(const Eigen::Vector2d& p_robot, double radius_m) const {
    return !is_narrow_ || (sides_[0].at(p_robot) > -radius_m && sides_[1].at(p_robot) > -radius_m);
  }
  /// Clips a line to the sector (see CameraView::clip).
  bool clip(const Eigen::Vector2d& start, const Eigen::Vector2d& way, double& from, double& to) const {
    return !is_narrow_ ||
           (clipBy(sides_[0], start, way, from, to) && clipBy(sides_[1], start, way, from, to));
  }

 private:
  static constexpr double kWidestBin_rad = 0.04;  // of the depth buffer
  double range_ = 0.0;
  bool is_narrow_ = false;
  std::array<HalfPlane, 2> sides_;
};

}  // namespace

bool matchesAny(const Label& label, std::span<const std::string> names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return name.starts_with('*') ? label.ends_with(std::string_view(name).substr(1)) : label == name;
  });
}

CameraView::CameraView(const CameraIntrinsics& intrinsics, const Pose3& T_robot_camera) {
  const Pose3 T_camera_robot = T_robot_camera.inverse();
  // Each border of the image is a plane through the camera; its intersection with the floor is a half plane.
  const auto border = [&](double x, double y, double z, double offset) {
    const Eigen::RowVector3d normal(x, y, z);
    return HalfPlane{(normal * T_camera_robot.linear().leftCols<2>()).transpose(),
                     normal * T_camera_robot.translation() + offset};
  };
  borders_ = {border(0.0, 0.0, 1.0, -kNearPlane_m), border(intrinsics.fx, 0.0, intrinsics.cx, 0.0),
              border(0.0, intrinsics.fy, intrinsics.cy, 0.0),
              border(-intrinsics.fx, 0.0, intrinsics.width - 1.0 - intrinsics.cx, 0.0),
              border(0.0, -intrinsics.fy, intrinsics.height - 1.0 - intrinsics.cy, 0.0)};
  std::transform(borders_.begin(), borders_.end(), slopes_.begin(),
                 [](const HalfPlane& one) { return one.normal.norm(); });
}

bool CameraView::shows(const Eigen::Vector2d& p_robot) const {
  return std::all_of(borders_.begin(), borders_.end(),
                     [&](const HalfPlane& border) { return border.at(p_robot) >= 0.0; });
}

bool CameraView::mayShow(const Eigen::Vector2d& p_robot, double radius_m) const {
  for (std::size_t i = 0; i < borders_.size(); ++i) {
    if (borders_[i].at(p_robot) < -radius_m * slopes_[i]) return false;
  }
  return true;
}

bool CameraView::clip(const Eigen::Vector2d& start, const Eigen::Vector2d& way, double& from,
                      double& to) const {
  return std::all_of(borders_.begin(), borders_.end(),
                     [&](const HalfPlane& border) { return clipBy(border, start, way, from, to); });
}

Visibility::Visibility(const MapIndex& map, std::span<const std::string> opaque) {
  std::vector<std::pair<std::uint64_t, Run>> runs;
  std::uint32_t number = 0;
  for (int label = 0; label < map.labelCount(); ++label) {
    const bool is_opaque = matchesAny(map.labelName(label), opaque);
    for (const Segment2& segment : map.floor(label)) {
      ++number;
      const double length = segment.length();
      if (length <= 0.0) continue;
      const int pieces = std::max(1, static_cast<int>(std::lround(length / kSpacing_m)));
      const Line line{segment.a, segment.b - segment.a, segment.direction(), pieces, label, number,
                      is_opaque};
      const auto index = static_cast<std::uint32_t>(lines_.size());
      lines_.push_back(line);
      for (int i = 0; i < pieces; ++i) {
        const Eigen::Vector2d p = segment.a + (i + 0.5) / pieces * line.way;
        const std::uint64_t cell = cellKey(cellOf(p.x()), cellOf(p.y()));
        if (i > 0 && runs.back().first == cell) {
          ++runs.back().second.count;
        } else {
          runs.push_back({cell, {index, static_cast<std::uint32_t>(i), 1}});
        }
      }
    }
  }
  std::stable_sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  runs_.reserve(runs.size());
  std::optional<std::uint64_t> last;
  for (const auto& [cell, run] : runs) {
    if (cell != last) {
      if (!last || rowOf(*last) != rowOf(cell)) {
        rows_.push_back({rowOf(cell), static_cast<std::uint32_t>(cells_.size())});
      }
      cells_.push_back(columnOf(cell));
      first_of_.push_back(static_cast<std::uint32_t>(runs_.size()));
      last = cell;
    }
    runs_.push_back(run);
  }
  rows_.push_back({0, static_cast<std::uint32_t>(cells_.size())});
  first_of_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

/// Visits the runs of lines near a position, cell by cell.
/// @param may_count false for the centre of a cell without relevant points.
template <typename MayCount, typename Visit>
void Visibility::visitRuns(const Eigen::Vector2d& position, double range_m, MayCount may_count,
                           Visit visit) const {
  std::array<std::size_t, kAtOnce> cells;
  std::size_t count = 0;
  // A large map exceeds the caches: all cells are prefetched before the first one is used.
  const auto visitAll = [&] {
    for (const std::size_t cell : std::span(cells).first(count)) {
      for (const Run& run : runsOf(cell)) __builtin_prefetch(&lines_[run.line]);
    }
    for (const std::size_t cell : std::span(cells).first(count)) {
      for (const Run& run : runsOf(cell)) visit(lines_[run.line], run);
    }
    count = 0;
  };
  const std::int32_t x_from = cellOf(position.x() - range_m);
  const std::int32_t x_to = cellOf(position.x() + range_m);
  const std::int32_t y_to = cellOf(position.y() + range_m);
  const auto rows_end = rows_.end() - 1;
  auto row = std::lower_bound(rows_.begin(), rows_end, cellOf(position.y() - range_m),
                              [](const Row& one, std::int32_t y) { return one.y < y; });
  for (; row != rows_end && row->y <= y_to; ++row) {
    const auto end = cells_.begin() + (row + 1)->first;
    for (auto x = std::lower_bound(cells_.begin() + row->first, end, x_from); x != end && *x <= x_to; ++x) {
      const Eigen::Vector2d middle(kIndexCell_m * (*x + 0.5), kIndexCell_m * (row->y + 0.5));
      const Eigen::Vector2d off = ((middle - position).array().abs() - 0.5 * kIndexCell_m).max(0.0);
      if (off.norm() > range_m + kPieceRounding || !may_count(middle)) continue;
      if (count == cells.size()) visitAll();
      cells[count] = static_cast<std::size_t>(x - cells_.begin());
      __builtin_prefetch(&runs_[first_of_[cells[count++]]]);
    }
  }
  visitAll();
}

void Visibility::around(const Pose2& T_world_robot, double range_m, std::span<const Segment2> obstacles,
                        const CameraView* view, std::vector<VisiblePoint>& out) const {
  out.clear();
  const double c = std::cos(T_world_robot.theta);
  const double s = std::sin(T_world_robot.theta);
  const auto turn = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(c * v.x() + s * v.y(), -s * v.x() + c * v.y());
  };
  const Eigen::Vector2d position = T_world_robot.position();
  const auto isInView = [&](const Eigen::Vector2d& p_world) {
    return !view || view->mayShow(turn(p_world - position), kCellRadius_m);
  };
  visitRuns(position, range_m, isInView, [&](const Line& line, const Run& run) {
    const Eigen::Vector2d start = turn(line.a - position);
    const Eigen::Vector2d way = turn(line.way);
    const double piece = 1.0 / line.pieces;
    double from = (run.first + 0.5) * piece;
    double to = (run.first + run.count - 0.5) * piece;
    if (view && !view->clip(start, way, from, to)) return;
    const double length = piece * way.norm();
    const auto last = static_cast<int>(std::floor(to * line.pieces - 0.5 + kPieceRounding));
    for (auto i = static_cast<int>(std::ceil(from * line.pieces - 0.5 - kPieceRounding)); i <= last; ++i) {
      const Eigen::Vector2d p_robot = start + (i + 0.5) * piece * way;
      if (p_robot.squaredNorm() > range_m * range_m) continue;
      out.push_back({p_robot, line.direction - T_world_robot.theta, length, line.label, line.number});
    }
  });
  if (out.empty()) return;
  DepthBuffer depth;
  const Sector sector(out);
  const auto mayHide = [&](const Eigen::Vector2d& p_world) {
    return sector.mayHide(turn(p_world - position), kCellRadius_m + kPieceReach_m);
  };
  visitRuns(position, sector.range(), mayHide, [&](const Line& line, const Run& run) {
    if (!line.opaque) return;
    const Eigen::Vector2d start = turn(line.a - position);
    const Eigen::Vector2d way = turn(line.way);
    const double piece = 1.0 / line.pieces;
    double from = run.first * piece;
    double to = (run.first + run.count) * piece;
    if (!sector.clip(start, way, from, to)) return;
    const auto first = static_cast<int>(std::floor(from * line.pieces + kPieceRounding));
    const auto after = static_cast<int>(std::ceil(to * line.pieces - kPieceRounding));
    depth.add(start + first * piece * way, piece * way, after - first);
  });
  for (const Segment2& obstacle : obstacles) {
    const int pieces = std::max(1, static_cast<int>(obstacle.length() / kSpacing_m));
    const Eigen::Vector2d step = (obstacle.b - obstacle.a) / pieces;
    depth.add(obstacle.a, step, pieces);
  }
  std::erase_if(out, [&](const VisiblePoint& point) { return depth.hides(point.p_robot); });
}

}  // namespace vismem
