#include "simulator/core/world_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismem {
namespace {

constexpr double kCell_m = 0.05;
constexpr double kSmall_m = 0.3;
/// Larger surfaces get larger cells.
constexpr int kMaxCells = 1024;

using Polygon = std::vector<Eigen::Vector3d>;

/// The part of a polygon where sign * z >= sign * height.
Polygon cutAt(const Polygon& polygon, double height, double sign) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a.z() - height);
    const double db = sign * (b.z() - height);
    if (da >= 0.0) result.push_back(a);
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) result.push_back(a + da / (da - db) * (b - a));
  }
  return result;
}

/// Cells of a grid in plan view that a surface touches.
class Grid {
 public:
  explicit Grid(const Eigen::AlignedBox2d& box) : origin_(box.min()) {
    cell_ = std::max(kCell_m, box.sizes().maxCoeff() / (kMaxCells - 1));
    width_ = static_cast<int>(box.sizes().x() / cell_) + 1;
    height_ = static_cast<int>(box.sizes().y() / cell_) + 1;
    cells_.assign(static_cast<std::size_t>(width_) * height_, 0);
  }

  /// Marks the cells under a convex polygon, row by row.
  void mark(const Polygon& polygon) {
    double low = std::numeric_limits<double>::max();
    double high = -low;
    for (const auto& p : polygon) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
    for (int row = rowOf(low); row <= rowOf(high); ++row) {
      const double y0 = origin_.y() + row * cell_;
      double x0 = std::numeric_limits<double>::max();
      double x1 = -x0;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector3d& a = polygon[i];
        const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
        // The part of the side within the row.
        double from = 0.0;
        double to = 1.0;
        const double dy = b.y() - a.y();
        if (std::abs(dy) > 1e-12) {
          const double t0 = (y0 - a.y()) / dy;
          const double t1 = (y0 + cell_ - a.y()) / dy;
          from = std::max(from, std::min(t0, t1));
          to = std::min(to, std::max(t0, t1));
        }
        if (from > to) continue;
        for (const double t : {from, to}) {
          const double x = a.x() + t * (b.x() - a.x());
          x0 = std::min(x0, x);
          x1 = std::max(x1, x);
        }
      }
      for (int column = columnOf(x0); x0 <= x1 && column <= columnOf(x1); ++column) {
        cells_[static_cast<std::size_t>(row) * width_ + column] = 1;
      }
    }
  }

  /// Few rectangles that cover the marked cells: runs of a row, grown downwards.
  std::vector<std::vector<Eigen::Vector2d>> rectangles() {
    std::vector<std::vector<Eigen::Vector2d>> result;
    for (int row = 0; row < height_; ++row) {
      for (int column = 0; column < width_; ++column) {
        if (!marked(row, column)) continue;
        int last = column;
        while (last + 1 < width_ && marked(row, last + 1)) ++last;
        int bottom = row;
        while (bottom + 1 < height_ && allMarked(bottom + 1, column, last)) ++bottom;
        for (int r = row; r <= bottom; ++r) {
          std::fill_n(cells_.begin() + static_cast<std::ptrdiff_t>(r) * width_ + column, last - column + 1,
                      0);
        }
        const Eigen::Vector2d a = origin_ + cell_ * Eigen::Vector2d(column, row);
        const Eigen::Vector2d b = origin_ + cell_ * Eigen::Vector2d(last + 1, bottom + 1);
        result.push_back({a, {b.x(), a.y()}, b, {a.x(), b.y()}});
      }
    }
    return result;
  }

 private:
  int rowOf(double y) const {
    return std::clamp(static_cast<int>((y - origin_.y()) / cell_), 0, height_ - 1);
  }
  int columnOf(double x) const {
    return std::clamp(static_cast<int>((x - origin_.x()) / cell_), 0, width_ - 1);
  }
  bool marked(int row, int column) const {
    return cells_[static_cast<std::size_t>(row) * width_ + column] != 0;
  }
  bool allMarked(int row, int first, int last) const {
    for (int c = first; c <= last; ++c) {
      if (!marked(row, c)) return false;
    }
    return true;
  }

  Eigen::Vector2d origin_;
  double cell_ = kCell_m;
  int width_ = 0;
  int height_ = 0;
  std::vector<char> cells_;
};

}  // namespace

std::vector<ModelOutline> outlinesOf(const TriangleMesh& mesh, bool solid, double low_m, double high_m) {
  if (mesh.vertices.empty()) return {};
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v.cast<double>());
  const double low = box.min().z();
  const double high = box.max().z();
  if (solid || box.sizes().head<2>().maxCoeff() < kSmall_m) {
    std::vector<Eigen::Vector2d> points;
    for (const auto& v : mesh.vertices) points.emplace_back(v.head<2>().cast<double>());
    auto hull = convexHull(std::move(points));
    if (hull.size() < 3) return {};
    return {{"", std::move(hull), low, high}};
  }
  std::vector<Polygon> pieces;
  Eigen::AlignedBox2d bounds;
  for (const auto& t : mesh.triangles) {
    const Polygon triangle{mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(),
                           mesh.vertices[t[2]].cast<double>()};
    Polygon piece = cutAt(cutAt(triangle, low_m, 1.0), high_m, -1.0);
    if (piece.empty()) continue;
    for (const auto& p : piece) bounds.extend(p.head<2>());
    pieces.push_back(std::move(piece));
  }
  if (pieces.empty()) return {};
  Grid grid(bounds);
  for (const auto& piece : pieces) grid.mark(piece);
  std::vector<ModelOutline> result;
  for (auto& rectangle : grid.rectangles()) result.push_back({"", std::move(rectangle), low, high});
  return result;
}

}  // namespace vismem
