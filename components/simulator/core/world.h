/// @file A world to simulate: named models of triangles, their outlines on the floor, lights. Pure values.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/kinematics/obstacle.h"

namespace vismem {

/// The image of a surface. Invariant: rgb has 3 * width * height bytes, rows from the top.
struct Texture {
  std::string name;  ///< its file
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A rigid body of one material, in the coordinates of its model [m].
struct WorldBody {
  std::string name;                                    ///< "link/visual"
  Eigen::Vector3f color{0.7f, 0.7f, 0.7f};             ///< diffuse, R G B in 0..1; times the texture's
  Eigen::Vector3f emissive = Eigen::Vector3f::Zero();  ///< its own light, R G B in 0..1
  std::shared_ptr<const Texture> texture;              ///< may be null
  std::vector<Eigen::Vector3f> vertices;               ///< finite
  std::vector<Eigen::Vector2f> uvs;      ///< one per vertex, or empty; (0, 0) is the image's top left
  std::vector<Eigen::Vector3f> normals;  ///< one per vertex, or empty: every triangle is flat
  std::vector<Eigen::Vector3<std::uint32_t>> triangles;  ///< counter-clockwise seen from outside
};

/// Outline of a collision shape in plan view, convex, counter-clockwise [m].
struct ModelOutline {
  std::string name;                      ///< "link/collision"
  std::vector<Eigen::Vector2d> outline;  ///< in the frame toPose2(pose) of its model
  double low_m = 0.0;                    ///< its lowest and highest point above the model's origin
  double high_m = 0.0;
};

/// A rigid model of one or more bodies.
struct WorldModel {
  std::string name;
  Pose3 pose = Pose3::Identity();  ///< T_world_model
  std::vector<WorldBody> bodies;
  /// Outlines at the model's pose; valid for any pose that differs in position and heading only.
  std::vector<ModelOutline> outlines;
};

struct Light {
  enum class Kind { kDirectional, kPoint, kSpot };
  std::string name;
  Kind kind = Kind::kDirectional;
  Eigen::Vector3f color{0.55f, 0.55f, 0.55f};  ///< diffuse, R G B
  /// Unit vector of the travelling light (directional, spot).
  Eigen::Vector3f direction = Eigen::Vector3f(-0.4f, 0.25f, -0.9f).normalized();
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< in the world [m] (point, spot)
  bool shadows = true;
  // Point and spot lights: attenuation 1 / (constant + linear d + quadratic d^2), 0 beyond range_m.
  float range_m = 10.0f;
  float constant = 1.0f;
  float linear = 0.0f;
  float quadratic = 0.0f;
  // Spot lights: full intensity inside the inner cone, 0 outside the outer one (full angles).
  float inner_angle_rad = 0.6f;
  float outer_angle_rad = 1.0f;
  float falloff = 1.0f;
};

/// A camera sensor of the world's file.
struct WorldCamera {
  std::string name;                          ///< "model/link/sensor"
  Pose3 T_world_camera = Pose3::Identity();  ///< camera axes: x right, y down, z forward
  CameraIntrinsics intrinsics;               ///< with its distortion
  double noise_sigma = 0.0;                  ///< Gaussian, of a channel in 0..1
  double rate_hz = 0.0;                      ///< 0: as fast as possible
};

/// Invariant: at least one model has a body with a triangle. Names of models differ.
struct World {
  std::string name;
  std::vector<WorldModel> models;
  std::vector<Light> lights;
  std::vector<WorldCamera> cameras;
  Eigen::Vector3f ambient{0.45f, 0.45f, 0.45f};
  Eigen::Vector3f sky{0.75f, 0.82f, 0.9f};  ///< colour without a surface

  /// @return index of the model of that name; empty if there is none.
  std::optional<int> modelNamed(std::string_view wanted) const;
  int bodyCount() const;
};

/// The outlines of a model at a pose, for collisions with a robot's body (3 to 50 cm above the floor). Names
/// are "model/link/collision".
std::vector<WorldObstacle> obstaclesAt(const WorldModel& model, const Pose3& T_world_model);
/// The outlines of all models at their poses.
std::vector<WorldObstacle> obstaclesOf(const World& world);

struct LoadedWorld {
  World world;
  std::vector<std::string> warnings;  ///< unusable parts, one line each
  int visuals = 0;  ///< of the file and its models that are to be seen; 1 for an include without a model
  int visuals_shown = 0;  ///< of these, those that have a body

  bool isWhole() const { return visuals_shown == visuals; }
  /// "116 of 116 visuals".
  std::string summary() const;
};

/// Called while a world is loaded, after each model of all.
using LoadingProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Reads an SDF file (1.2 to 1.9). Errors of libsdformat become warnings as long as there is a world.
/// `model://` names are searched in `model_paths`, then in the world's own folder; ground_plane and sun are
/// built in. Third-party files, meshes and images may be malformed.
/// @throws ConfigError: unreadable, not SDF, a model that includes itself, or nothing to show; names the file
/// and the reason.
LoadedWorld loadWorld(const std::filesystem::path& file,
                      const std::vector<std::filesystem::path>& model_paths = {},
                      const LoadingProgress& progress = {});
/// Maximum number of trials with parts of a world that libsdformat rejects as a whole; 10 to 30 ms each, and
/// more for large worlds.
constexpr int kRescueTries = 120;
/// As loadWorld on a text.
/// @param file for messages only.
/// @param search all folders in their order.
LoadedWorld parseWorld(const std::string& bytes, const std::string& file,
                       const std::vector<std::filesystem::path>& search, int rescue_tries = kRescueTries);

/// Lowest and highest height of a robot's body above the floor, for collisions [m].
constexpr double kRobotBodyBottom_m = 0.03;
constexpr double kRobotBodyTop_m = 0.5;

}  // namespace vismem
