#include "simulator/core/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr int kRoundSides = 48;
constexpr int kSphereRings = 24;

Eigen::Vector3<std::uint32_t> triangle(std::size_t a, std::size_t b, std::size_t c) {
  return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)};
}

void addQuad(TriangleMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
             const Eigen::Vector3f& d) {
  const std::size_t first = mesh.vertices.size();
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
  mesh.uvs.insert(mesh.uvs.end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  mesh.triangles.push_back(triangle(first, first + 1, first + 2));
  mesh.triangles.push_back(triangle(first, first + 2, first + 3));
}

Eigen::Vector3f onCircle(double radius, int side, double z) {
  const double angle = 2.0 * std::numbers::pi * side / kRoundSides;
  return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>();
}

constexpr float turnShare(int side) {
  return static_cast<float>(side) / kRoundSides;
}

}  // namespace

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const bool first_part = mesh.vertices.empty();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles) mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
  const auto join = [&](auto& to, const auto& from) {
    if ((first_part || !to.empty()) && !from.empty()) {
      to.insert(to.end(), from.begin(), from.end());
    } else {
      to.clear();
    }
  };
  join(mesh.uvs, more.uvs);
  join(mesh.normals, more.normals);
}

void transformMesh(TriangleMesh& mesh, const Eigen::Affine3d& T) {
  for (auto& v : mesh.vertices) v = (T * v.cast<double>()).cast<float>();
  // Normals stay normal under the inverse transpose, here up to its length.
  const Eigen::Matrix3d m = T.linear();
  Eigen::Matrix3d normal;
  normal << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
  const bool mirrored = m.determinant() < 0.0;
  if (mirrored) normal = -normal;
  for (auto& n : mesh.normals) n = (normal * n.cast<double>()).normalized().cast<float>();
  if (mirrored) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
}

TriangleMesh boxMesh(const Eigen::Vector3d& size) {
  const Eigen::Vector3f h = (0.5 * size).cast<float>();
  const auto corner = [&](int x, int y, int z) { return Eigen::Vector3f(x * h.x(), y * h.y(), z * h.z()); };
  TriangleMesh mesh;
  addQuad(mesh, corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1));
  addQuad(mesh, corner(-1, 1, -1), corner(1, 1, -1), corner(1, -1, -1), corner(-1, -1, -1));
  addQuad(mesh, corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1), corner(1, -1, 1));
  addQuad(mesh, corner(-1, 1, -1), corner(-1, -1, -1), corner(-1, -1, 1), corner(-1, 1, 1));
  addQuad(mesh, corner(1, 1, -1), corner(-1, 1, -1), corner(-1, 1, 1), corner(1, 1, 1));
  addQuad(mesh, corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1));
  return mesh;
}

TriangleMesh planeMesh(const Eigen::Vector2d& size) {
  const float x = static_cast<float>(0.5 * size.x());
  const float y = static_cast<float>(0.5 * size.y());
  TriangleMesh mesh;
  addQuad(mesh, {-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0});
  return mesh;
}

TriangleMesh cylinderMesh(double radius, double length) {
  TriangleMesh mesh;
  const double top = 0.5 * length;
  for (int i = 0; i < kRoundSides; ++i) {
    addQuad(mesh, onCircle(radius, i, -top), onCircle(radius, i + 1, -top), onCircle(radius, i + 1, top),
            onCircle(radius, i, top));
    const Eigen::Vector3f here = onCircle(1.0, i, 0.0);
    const Eigen::Vector3f next = onCircle(1.0, i + 1, 0.0);
    mesh.normals.insert(mesh.normals.end(), {here, next, next, here});
    for (int k = 4; k > 0; --k) {
      auto& uv = mesh.uvs[mesh.uvs.size() - k];
      uv.x() = turnShare(k == 3 || k == 2 ? i + 1 : i);
    }
    for (const int up : {1, -1}) {
      const std::size_t first = mesh.vertices.size();
      const auto z = static_cast<float>(up * top);
      mesh.vertices.insert(mesh.vertices.end(),
                           {Eigen::Vector3f(0, 0, z), onCircle(radius, up > 0 ? i : i + 1, z),
                            onCircle(radius, up > 0 ? i + 1 : i, z)});
      mesh.triangles.push_back(triangle(first, first + 1, first + 2));
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3f& p = mesh.vertices[first + k];
        const auto r = static_cast<float>(radius);
        mesh.uvs.emplace_back(0.5f + 0.5f * p.x() / r, 0.5f - 0.5f * p.y() / r);
        mesh.normals.emplace_back(0, 0, static_cast<float>(up));
      }
    }
  }
  return mesh;
}

TriangleMesh coneMesh(double radius, double length) {
  TriangleMesh mesh;
  const double top = 0.5 * length;
  const double slant = std::hypot(radius, length);
  const auto outwards = [&](double side) {
    // As onCircle, between two sides too.
    const double a = 2.0 * std::numbers::pi * side / kRoundSides;
    return Eigen::Vector3f(static_cast<float>(std::cos(a) * length / slant),
                           static_cast<float>(std::sin(a) * length / slant),
                           static_cast<float>(radius / slant));
  };
  for (int i = 0; i < kRoundSides; ++i) {
    const std::size_t first = mesh.vertices.size();
    const Eigen::Vector3f here = onCircle(radius, i, -top);
    const Eigen::Vector3f next = onCircle(radius, i + 1, -top);
    mesh.vertices.insert(mesh.vertices.end(), {here, next, Eigen::Vector3f(0, 0, static_cast<float>(top)),
                                               Eigen::Vector3f(0, 0, static_cast<float>(-top)), next, here});
    mesh.normals.insert(mesh.normals.end(), {outwards(i), outwards(i + 1), outwards(i + 0.5)});
    mesh.normals.insert(mesh.normals.end(), 3, Eigen::Vector3f(0, 0, -1));
    mesh.uvs.insert(mesh.uvs.end(), {{turnShare(i), 1.0f}, {turnShare(i + 1), 1.0f}, {turnShare(i), 0.0f}});
    for (int k = 3; k < 6; ++k) {
      const Eigen::Vector3f& p = mesh.vertices[first + k];
      const auto r = static_cast<float>(2.0 * radius);
      mesh.uvs.emplace_back(0.5f + p.x() / r, 0.5f - p.y() / r);
    }
    mesh.triangles.push_back(triangle(first, first + 1, first + 2));
    mesh.triangles.push_back(triangle(first + 3, first + 4, first + 5));
  }
  return mesh;
}

TriangleMesh sphereMesh(double radius) {
  return capsuleMesh(radius, 0.0);
}

TriangleMesh ellipsoidMesh(const Eigen::Vector3d& radii) {
  TriangleMesh mesh = sphereMesh(1.0);
  transformMesh(mesh, Eigen::Affine3d(Eigen::Scaling(radii)));
  return mesh;
}

TriangleMesh capsuleMesh(double radius, double length) {
  TriangleMesh mesh;
  const auto normal = [&](int ring, int side) {
    const double polar = std::numbers::pi * ring / kSphereRings;
    return onCircle(std::sin(polar), side, std::cos(polar));
  };
  const auto addRing = [&](int from, int to, double z_from, double z_to) {
    for (int side = 0; side < kRoundSides; ++side) {
      const std::array<Eigen::Vector3f, 4> n{normal(from, side), normal(to, side), normal(to, side + 1),
                                             normal(from, side + 1)};
      const auto point = [&](int i, double z) {
        return Eigen::Vector3f(static_cast<float>(radius) * n[i] +
                               Eigen::Vector3f(0, 0, static_cast<float>(z)));
      };
      addQuad(mesh, point(0, z_from), point(1, z_to), point(2, z_to), point(3, z_from));
      mesh.normals.insert(mesh.normals.end(), n.begin(), n.end());
      const auto v = [](int ring) { return static_cast<float>(ring) / kSphereRings; };
      auto* uv = &mesh.uvs[mesh.uvs.size() - 4];
      uv[0] = {turnShare(side), v(from)};
      uv[1] = {turnShare(side), v(to)};
      uv[2] = {turnShare(side + 1), v(to)};
      uv[3] = {turnShare(side + 1), v(from)};
    }
  };
  const double half = 0.5 * length;
  for (int ring = 0; ring < kSphereRings; ++ring) {
    const double z = ring < kSphereRings / 2 ? half : -half;
    if (ring == kSphereRings / 2 && length > 0.0) addRing(ring, ring, half, -half);
    addRing(ring, ring + 1, z, z);
  }
  return mesh;
}

TriangleMesh heightmapMesh(const Eigen::Vector2d& size, int columns, int rows,
                           const std::vector<float>& heights) {
  TriangleMesh mesh;
  const auto at = [&](int column, int row) { return static_cast<std::size_t>(row) * columns + column; };
  const auto clampedHeight = [&](int column, int row) {
    return heights[at(std::clamp(column, 0, columns - 1), std::clamp(row, 0, rows - 1))];
  };
  const double dx = size.x() / (columns - 1);
  const double dy = size.y() / (rows - 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      mesh.vertices.emplace_back(static_cast<float>(-0.5 * size.x() + dx * column),
                                 static_cast<float>(0.5 * size.y() - dy * row), heights[at(column, row)]);
      mesh.uvs.emplace_back(static_cast<float>(column) / static_cast<float>(columns - 1),
                            static_cast<float>(row) / static_cast<float>(rows - 1));
      const double slope_x = (clampedHeight(column + 1, row) - clampedHeight(column - 1, row)) / (2.0 * dx);
      const double slope_y = (clampedHeight(column, row - 1) - clampedHeight(column, row + 1)) / (2.0 * dy);
      mesh.normals.push_back(Eigen::Vector3d(-slope_x, -slope_y, 1.0).normalized().cast<float>());
    }
  }
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      mesh.triangles.push_back(triangle(at(column, row), at(column, row + 1), at(column + 1, row + 1)));
      mesh.triangles.push_back(triangle(at(column, row), at(column + 1, row + 1), at(column + 1, row)));
    }
  }
  return mesh;
}

TriangleMesh prismMesh(std::vector<Eigen::Vector2d> outline, double height) {
  // Twice the signed area of the triangle a, b, c.
  const auto area2 = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return cross2(b - a, c - a);
  };
  if (outline.size() > 1 && (outline.front() - outline.back()).norm() < 1e-9) outline.pop_back();
  if (outline.size() < 3) return {};
  double area = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    area += area2(Eigen::Vector2d::Zero(), outline[i], outline[(i + 1) % outline.size()]);
  }
  if (area < 0.0) std::reverse(outline.begin(), outline.end());

  TriangleMesh mesh;
  const std::size_t n = outline.size();
  for (const double z : {0.0, height}) {
    for (const auto& p : outline) mesh.vertices.emplace_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
  }
  // Ear clipping: cut off corners that turn left and hold no other corner.
  std::vector<std::size_t> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = i;
  while (left.size() >= 3) {
    bool cut = false;
    for (std::size_t i = 0; i < left.size() && !cut; ++i) {
      const std::size_t a = left[(i + left.size() - 1) % left.size()];
      const std::size_t b = left[i];
      const std::size_t c = left[(i + 1) % left.size()];
      if (area2(outline[a], outline[b], outline[c]) <= 1e-12) continue;
      const bool holds_corner = std::any_of(left.begin(), left.end(), [&](std::size_t p) {
        return p != a && p != b && p != c && area2(outline[a], outline[b], outline[p]) >= 0.0 &&
               area2(outline[b], outline[c], outline[p]) >= 0.0 &&
               area2(outline[c], outline[a], outline[p]) >= 0.0;
      });
      if (holds_corner) continue;
      mesh.triangles.push_back(triangle(n + a, n + b, n + c));
      mesh.triangles.push_back(triangle(c, b, a));
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      cut = true;
    }
    if (!cut) break;
  }
  if (left.size() != 2) return {};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    mesh.triangles.push_back(triangle(i, j, n + j));
    mesh.triangles.push_back(triangle(i, n + j, n + i));
  }
  return mesh;
}

std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points) {
  // Andrew's monotone chain.
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  const auto turnsRight = [&](std::size_t base, const Eigen::Vector2d& p) {
    if (hull.size() < base + 2) return false;
    const Eigen::Vector2d u = hull.back() - hull[hull.size() - 2];
    const Eigen::Vector2d v = p - hull.back();
    return cross2(u, v) <= 0.0;
  };
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = pass == 0 ? 0 : hull.size() - 1;
    for (const auto& p : points) {
      while (turnsRight(base, p)) hull.pop_back();
      hull.push_back(p);
    }
    std::reverse(points.begin(), points.end());
  }
  hull.pop_back();
  // The last point of the first chain begins the second one too.
  hull.erase(std::unique(hull.begin(), hull.end()), hull.end());
  return hull;
}

}  // namespace vismem
