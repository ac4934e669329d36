/// @file Triangles of the simple shapes, in the shape's own frame. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace vismem {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3<std::uint32_t>> triangles;
};

/// @param size edge lengths along x, y, z [m]; centred on the origin.
TriangleMesh boxMesh(const Eigen::Vector3d& size);
/// A rectangle facing +z. @param size along x and y [m].
TriangleMesh planeMesh(const Eigen::Vector2d& size);
/// Axis along z, centred [m].
TriangleMesh cylinderMesh(double radius, double length);
TriangleMesh sphereMesh(double radius);
/// A prism over a simple polygon (either sense of rotation), from z = 0 to `height` [m].
/// @return without triangles if the polygon has no area or crosses itself.
TriangleMesh prismMesh(std::vector<Eigen::Vector2d> outline, double height);

/// Convex hull of points of the plane, counter-clockwise, without the repeated first point.
std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points);

}  // namespace vismem
