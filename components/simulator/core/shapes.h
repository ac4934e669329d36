/// @file Triangles of the simple shapes, in the shape's own frame. Pure.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace vismem {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3<std::uint32_t>> triangles;
  std::vector<Eigen::Vector2f> uvs;      ///< one per vertex or none; (0, 0) is a texture's top left
  std::vector<Eigen::Vector3f> normals;  ///< one per vertex or none: of the rounded surface
};

/// Adds `more` to `mesh`. UVs and normals remain only if both have them (an empty `mesh` has both).
void append(TriangleMesh& mesh, const TriangleMesh& more);
/// Applies an affine transform to vertices and normals; mirrored meshes keep their outside.
void transformMesh(TriangleMesh& mesh, const Eigen::Affine3d& T);

/// @param size edge lengths along x, y, z [m]; centred on the origin.
TriangleMesh boxMesh(const Eigen::Vector3d& size);
/// A rectangle facing +z.
/// @param size along x and y [m].
TriangleMesh planeMesh(const Eigen::Vector2d& size);
/// Axis along z, centred [m].
TriangleMesh cylinderMesh(double radius, double length);
/// Axis along z, its point upwards, centred [m].
TriangleMesh coneMesh(double radius, double length);
TriangleMesh sphereMesh(double radius);
/// @param radii along x, y, z [m].
TriangleMesh ellipsoidMesh(const Eigen::Vector3d& radii);
/// A cylinder along z, centred, with a half ball on either end.
/// @param length of the cylinder [m].
TriangleMesh capsuleMesh(double radius, double length);
/// A surface over a grid of heights [m], row by row, the first row at +y.
/// @param size along x and y [m]; centred.
/// @param columns, rows at least 2, heights.size() == columns * rows.
TriangleMesh heightmapMesh(const Eigen::Vector2d& size, int columns, int rows,
                           const std::vector<float>& heights);
/// A prism over a simple polygon (either sense of rotation), from z = 0 to `height` [m].
/// @return without triangles if the polygon has no area or crosses itself.
TriangleMesh prismMesh(std::vector<Eigen::Vector2d> outline, double height);

/// Convex hull of points of the plane, counter-clockwise, without the repeated first point.
std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points);

}  // namespace vismem
