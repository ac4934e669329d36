#include "simulator/core/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  mesh.triangles.push_back(triangle(first, first + 1, first + 2));
  mesh.triangles.push_back(triangle(first, first + 2, first + 3));
}

Eigen::Vector3f onCircle(double radius, int side, double z) {
  const double angle = 2.0 * std::numbers::pi * side / kRoundSides;
  return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>();
}

}  // namespace

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
  const Eigen::Vector3f top_centre(0, 0, static_cast<float>(top));
  const Eigen::Vector3f bottom_centre(0, 0, static_cast<float>(-top));
  for (int i = 0; i < kRoundSides; ++i) {
    addQuad(mesh, onCircle(radius, i, -top), onCircle(radius, i + 1, -top), onCircle(radius, i + 1, top),
            onCircle(radius, i, top));
    const std::size_t first = mesh.vertices.size();
    mesh.vertices.insert(mesh.vertices.end(),
                         {top_centre, onCircle(radius, i, top), onCircle(radius, i + 1, top), bottom_centre,
                          onCircle(radius, i + 1, -top), onCircle(radius, i, -top)});
    mesh.triangles.push_back(triangle(first, first + 1, first + 2));
    mesh.triangles.push_back(triangle(first + 3, first + 4, first + 5));
  }
  return mesh;
}

TriangleMesh sphereMesh(double radius) {
  TriangleMesh mesh;
  const auto point = [&](int ring, int side) {
    const double polar = std::numbers::pi * ring / kSphereRings;
    return onCircle(radius * std::sin(polar), side, radius * std::cos(polar));
  };
  for (int ring = 0; ring < kSphereRings; ++ring) {
    for (int side = 0; side < kRoundSides; ++side) {
      addQuad(mesh, point(ring, side), point(ring + 1, side), point(ring + 1, side + 1),
              point(ring, side + 1));
    }
  }
  return mesh;
}

TriangleMesh prismMesh(std::vector<Eigen::Vector2d> outline, double height) {
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    const Eigen::Vector2d u = b - a;
    const Eigen::Vector2d v = c - a;
    return u.x() * v.y() - u.y() * v.x();
  };
  if (outline.size() > 1 && (outline.front() - outline.back()).norm() < 1e-9) outline.pop_back();
  if (outline.size() < 3) return {};
  double area = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    area += cross(Eigen::Vector2d::Zero(), outline[i], outline[(i + 1) % outline.size()]);
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
      if (cross(outline[a], outline[b], outline[c]) <= 1e-12) continue;
      const bool holds_corner = std::any_of(left.begin(), left.end(), [&](std::size_t p) {
        return p != a && p != b && p != c && cross(outline[a], outline[b], outline[p]) >= 0.0 &&
               cross(outline[b], outline[c], outline[p]) >= 0.0 &&
               cross(outline[c], outline[a], outline[p]) >= 0.0;
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
    return u.x() * v.y() - u.y() * v.x() <= 0.0;
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
