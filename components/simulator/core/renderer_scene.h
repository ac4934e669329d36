/// @file The search trees of a renderer: intersections of rays with the bodies of moving models. Private to
/// Renderer.
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "simulator/core/world.h"

namespace vismem {

constexpr int kPacket = 8;
constexpr int kNoSlot = -1;

/// A body for the shading. Slots are numbered over all models in the order of their addition.
struct BodySlot {
  int model = 0;
  int body = 0;
  WorldBody source;
};

/// Up to eight rays; the lanes in use come first.
struct RayPacket {
  RTCRayHit8 rays;
  alignas(32) std::array<int, kPacket> valid;
  // Filled by intersect:
  std::array<int, kPacket> slot;  ///< kNoSlot without an intersection
  /// Normal of the triangle in world coordinates, of any length, on the side of its winding.
  alignas(32) std::array<float, kPacket> nx, ny, nz;

  /// Lane `i` starts at `origin` towards (x, y, z) of unit length.
  void set(int i, const Eigen::Vector3f& origin, float x, float y, float z, float near_m);
  /// Lanes from `count` on repeat the first and are not traced.
  void finish(int count);
};

/// *Single-threaded*, but for intersect and occluded after commit(), which any thread may call.
class RenderScene {
 public:
  explicit RenderScene(const World& world);
  ~RenderScene();
  RenderScene(const RenderScene&) = delete;
  RenderScene& operator=(const RenderScene&) = delete;

  int addModel(const WorldModel& model);
  int modelCount() const { return static_cast<int>(models_.size()); }
  void setPose(int model, const Pose3& T_world_model);
  void setVisible(int model, bool visible);
  /// Updates the trees; to be called before rays are traced.
  void commit();

  void intersect(RayPacket& packet) const;
  /// Sets tfar of a lane to a negative value if a body occludes its end.
  void occluded(RTCRay8& rays, const std::array<int, kPacket>& valid) const;

  const BodySlot& slot(int i) const { return slots_[i]; }
  std::size_t slotCount() const { return slots_.size(); }
  const Pose3& poseOf(int model) const { return models_[model].pose; }
  bool isVisible(int model) const { return models_[model].visible; }
  /// Rotation from the coordinates of a slot's model to the world's.
  const Eigen::Matrix3f& rotationOf(int slot) const { return models_[slots_[slot].model].R; }

 private:
  struct Model {
    int first_slot = 0;
    Pose3 pose = Pose3::Identity();
    Eigen::Matrix3f R = Eigen::Matrix3f::Identity();
    bool visible = true;
    int bodies = 0;
    RTCScene own = nullptr;          ///< its own tree, in model coordinates, once it moved
    RTCGeometry instance = nullptr;  ///< of `own` in top_
  };

  int addSlots(const WorldModel& model);
  /// Adds the geometries of a model to a tree; ids count from `first_id` in the order of its bodies.
  void attach(const Model& model, RTCScene tree, int first_id, const Pose3& T);
  /// Gives a model a tree of its own, shown as an instance in top_.
  void makeOwnTree(int model);
  void placeInstance(const Model& model);
  void checkModel(int model) const;

  RTCDevice device_ = nullptr;
  RTCScene shared_ = nullptr;  ///< models that never moved, in world coordinates; geometry id = slot
  RTCScene top_ = nullptr;  ///< an instance of shared_ (id 0) and one of each detached model (id = 1 + model)
  RTCGeometry shared_instance_ = nullptr;
  bool shared_changed_ = true;
  bool top_changed_ = false;
  bool use_top_ = false;  ///< some model with a tree of its own is visible
  std::vector<Model> models_;
  std::vector<BodySlot> slots_;
};

}  // namespace vismem
