/// @file Ray-traced camera images of a world whose models can move.
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

/// First intersection of a ray.
struct RayHit {
  double distance_m = 0.0;                            ///< along the ray, for a direction of unit length
  int model = 0;                                      ///< index into World::models, or from addModel
  int body = 0;                                       ///< index into its bodies
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of unit length, towards the ray's origin
  Eigen::Vector3f color = Eigen::Vector3f::Zero();    ///< as lit, R G B, 0..1
  bool from_inside = false;                           ///< the ray began inside the body
};

/// Ground truth at every pixel's centre, with the distortion of the lens.
struct TruthImages {
  static constexpr int kNothing = -1;
  cv::Mat depth_m;  ///< CV_32F, along the optical axis; infinite without a surface
  cv::Mat model;    ///< CV_32S, index of the model; kNothing
  cv::Mat body;     ///< CV_32S, index of the body in its model; kNothing
};

/// Calls task(0) .. task(count - 1), in any order or in parallel, and returns after all of them.
using ParallelFor = std::function<void(int count, const std::function<void(int)>& task)>;

struct RendererOptions {
  /// Empty: all work on the calling thread. The images are the same bytes in any case.
  ParallelFor parallel_for;
  /// Called at the stages "prepare", "first rays" and "antialiasing" of each image; may be null.
  StageProbe* probe = nullptr;
};

/// Renders a world for any number of cameras of any size. *Single-threaded* (owner: the simulation). The same
/// world, changes, camera and pose give the same bytes on one machine. Models that never moved share one
/// search tree. The first move or hiding of a model builds a tree of its own (milliseconds for large worlds);
/// later moves take about 10 us. A camera inside a body sees its inner side. Light comes from World::lights:
/// shadows are sharp.
class Renderer {
 public:
  explicit Renderer(const World& world, RendererOptions options = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Adds a model.
  /// @return its index: World::models.size() for the first, and so on.
  int addModel(const WorldModel& model);
  int modelCount() const;
  /// @param model index; out of range throws std::out_of_range, a pose that is not finite
  /// std::invalid_argument.
  void setModelPose(int model, const Pose3& T_world_model);
  /// Hidden models have no shadow and no intersections with rays. They keep their pose.
  void setModelVisible(int model, bool visible);

  /// A CV_8UC3 image in the order R, G, B. One ray per pixel through its centre, with the exact distortion of
  /// the lens. Pixels beside another body or a brightness step get four rays, as do those on an edge of a
  /// narrow body.
  /// @throws std::invalid_argument for unusable intrinsics or a pose that is not finite.
  cv::Mat render(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);
  /// Depth and identity of the visible surfaces; throws as render.
  TruthImages renderTruth(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera);

  /// The first surface from `origin` [m] along `direction`; empty if none.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
