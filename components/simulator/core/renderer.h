/// @file Ray-traced camera images of a world whose models can move. DESIGN 6.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/profiling/stage_probe.h"
#include "simulator/core/world.h"

namespace vismem {

/// What a ray meets.
struct RayHit {
  double distance_m = 0.0;                            ///< along the ray, for a direction of unit length
  int model = 0;                                      ///< index into World::models, or what addModel gave
  int body = 0;                                       ///< index into its bodies
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of unit length, towards where the ray came from
  Eigen::Vector3f color = Eigen::Vector3f::Zero();    ///< as the camera sees it, R G B, 0..1
  bool from_inside = false;                           ///< the ray began inside the body
};

/// What is really at every pixel's centre, seen through the lens.
struct TruthImages {
  static constexpr int kNothing = -1;
  cv::Mat depth_m;  ///< CV_32F, along the optical axis; infinite where nothing is
  cv::Mat model;    ///< CV_32S, index of the model; kNothing
  cv::Mat body;     ///< CV_32S, index of the body in its model; kNothing
};

/// Calls task(0) .. task(count - 1), in any order, maybe at the same time, and returns when all are done.
using ParallelFor = std::function<void(int count, const std::function<void(int)>& task)>;

struct RendererOptions {
  /// Empty: everything on the calling thread. Whatever it does, the images are the same bytes.
  ParallelFor parallel_for;
  /// Hears of the stages "prepare", "first rays" and "antialiasing" of each image; may be null.
  StageProbe* probe = nullptr;
};

/// Renders a world for any number of cameras of any size. *Single-threaded* (owner: the simulation). The same
/// world, changes, camera and pose give the same bytes on one machine.
/// Models that never moved share one search tree; one that moves or hides gets its own, once (milliseconds
/// for large worlds); from then on a move costs about 10 us.
/// A camera inside a body sees its inner side. Light comes from World::lights: shadows are sharp.
class Renderer {
 public:
  explicit Renderer(const World& world, RendererOptions options = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Shows one more model. @return its index: World::models.size() for the first, and so on.
  int addModel(const WorldModel& model);
  int modelCount() const;
  /// @param model index; out of range throws std::out_of_range, a pose that is not finite
  /// std::invalid_argument.
  void setModelPose(int model, const Pose3& T_world_model);
  /// Hidden models throw no shadow and are met by no ray. They keep their pose.
  void setModelVisible(int model, bool visible);

  /// A CV_8UC3 image in the order R, G, B. One ray a pixel through its centre, bent exactly as the lens does;
  /// pixels beside another body or a step of brightness get four rays, as do those that an edge of a narrow
  /// body passes.
  /// @throws std::invalid_argument for unusable intrinsics or a pose that is not finite.
  cv::Mat render(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);
  /// Depth and identity of what a camera sees; throws as render.
  TruthImages renderTruth(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

  /// The first surface from `origin` [m] along `direction`; empty if none.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
