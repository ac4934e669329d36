#include "simulator/core/body_creases.h"

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace vismem {

std::vector<Segment3> creasesOf(const WorldBody& body, const Pose3& T, double min_angle_rad) {
  std::vector<Segment3> creases;
  std::vector<Eigen::Vector3d> vertices;
  for (const auto& v : body.vertices) {
    vertices.push_back((T.cast<float>() * v).cast<double>());
  }
  // Vertices are repeated per face: equal positions (to 0.1 mm) are one corner.
  using Corner = std::tuple<long, long, long>;
  const auto corner = [&](std::uint32_t i) {
    const Eigen::Vector3d& v = vertices[i];
    return Corner{std::lround(v.x() * 1e4), std::lround(v.y() * 1e4), std::lround(v.z() * 1e4)};
  };
  struct Side {
    Segment3 line;
    std::vector<Eigen::Vector3d> normals;
  };
  std::map<std::pair<Corner, Corner>, Side> sides;
  for (const auto& t : body.triangles) {
    const std::array<Eigen::Vector3d, 3> p{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.norm() < 1e-12) continue;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const Corner from = corner(t[i]);
      const Corner to = corner(t[j]);
      Side& side = sides[{std::min(from, to), std::max(from, to)}];
      side.line = {p[i], p[j]};
      side.normals.push_back(normal.normalized());
    }
  }
  for (const auto& [key, side] : sides) {
    const auto& n = side.normals;
    const bool smooth = n.size() == 2 && n[0].dot(n[1]) > std::cos(min_angle_rad);
    if (!smooth && side.line.length() > 0.0) creases.push_back(side.line);
  }
  return creases;
}

}  // namespace vismem
