/// @file A world to simulate: bodies of triangles, their outlines on the floor, a sun. Pure values.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/kinematics/obstacle.h"

namespace vismem {

/// A rigid body of one colour. Vertices are in world coordinates [m]: nothing moves but the robot.
struct WorldBody {
  std::string name;                         ///< "model/link/visual"
  Eigen::Vector3f color{0.7f, 0.7f, 0.7f};  ///< diffuse, R G B in 0..1
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3<std::uint32_t>> triangles;  ///< counter-clockwise seen from outside
};

struct Sun {
  /// Unit vector of the travelling light.
  Eigen::Vector3f direction = Eigen::Vector3f(-0.4f, 0.25f, -0.9f).normalized();
  float diffuse = 0.55f;
  float ambient = 0.45f;
};

/// Invariant: at least one body with a triangle.
struct World {
  std::string name;
  std::vector<WorldBody> bodies;
  std::vector<WorldObstacle> obstacles;
  Sun sun;
};

struct LoadedWorld {
  World world;
  std::vector<std::string> warnings;  ///< what could not be used, one line each
};

/// Reads an SDF file (1.2 to 1.9). libsdformat's own complaints are warnings as long as there is a world.
/// `model://` names are searched in `model_paths`, then in the world's own folder; ground_plane and sun are
/// built in. @throws ConfigError: unreadable, not SDF, or nothing to show; names the file and the reason.
LoadedWorld loadWorld(const std::filesystem::path& file,
                      const std::vector<std::filesystem::path>& model_paths = {});

}  // namespace vismem
