#include "simulator/core/renderer_scene.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace vismem {
namespace {

constexpr float kFar_m = 1000.0f;
constexpr unsigned kNone = RTC_INVALID_GEOMETRY_ID;

std::array<float, 12> columns(const Pose3& pose) {
  const Eigen::Matrix<float, 3, 4> m = pose.matrix().topRows<3>().cast<float>();
  std::array<float, 12> result;
  std::copy_n(m.data(), 12, result.begin());  // Eigen's own order is by columns
  return result;
}

}  // namespace

void RayPacket::set(int i, const Eigen::Vector3f& origin, float x, float y, float z, float near_m) {
  rays.ray.org_x[i] = origin.x();
  rays.ray.org_y[i] = origin.y();
  rays.ray.org_z[i] = origin.z();
  rays.ray.dir_x[i] = x;
  rays.ray.dir_y[i] = y;
  rays.ray.dir_z[i] = z;
  rays.ray.tnear[i] = near_m;
}

void RayPacket::finish(int count) {
  for (int i = 0; i < kPacket; ++i) {
    valid[i] = i < count ? -1 : 0;
    if (i >= count) {
      set(i, {rays.ray.org_x[0], rays.ray.org_y[0], rays.ray.org_z[0]}, rays.ray.dir_x[0], rays.ray.dir_y[0],
          rays.ray.dir_z[0], rays.ray.tnear[0]);
    }
    rays.ray.tfar[i] = kFar_m;
    rays.ray.mask[i] = ~0u;
    rays.ray.time[i] = 0.0f;
    rays.ray.flags[i] = 0;
    rays.hit.geomID[i] = kNone;
    rays.hit.instID[0][i] = kNone;
  }
}

RenderScene::RenderScene(const World& world) {
  // One building thread: trees of these sizes take milliseconds, and the robot's cores have other work.
  device_ = rtcNewDevice("threads=1,set_affinity=0");
  if (device_ == nullptr) throw std::runtime_error("Embree gives no device");
  shared_ = rtcNewScene(device_);
  rtcSetSceneFlags(shared_, RTC_SCENE_FLAG_ROBUST);
  top_ = rtcNewScene(device_);
  rtcSetSceneFlags(top_, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  rtcSetSceneBuildQuality(top_, RTC_BUILD_QUALITY_LOW);
  shared_instance_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(shared_instance_, shared_);
  rtcAttachGeometryByID(top_, shared_instance_, 0);
  for (const auto& model : world.models) {
    const int index = addSlots(model);
    attach(models_[index], shared_, models_[index].first_slot, model.pose);
  }
  commit();
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the world");
}

RenderScene::~RenderScene() {
  for (const auto& model : models_) {
    if (model.instance != nullptr) rtcReleaseGeometry(model.instance);
    if (model.own != nullptr) rtcReleaseScene(model.own);
  }
  rtcReleaseGeometry(shared_instance_);
  rtcReleaseScene(top_);
  rtcReleaseScene(shared_);
  rtcReleaseDevice(device_);
}

int RenderScene::addSlots(const WorldModel& model) {
  const int index = modelCount();
  Model entry;
  entry.first_slot = static_cast<int>(slots_.size());
  entry.bodies = static_cast<int>(model.bodies.size());
  entry.pose = model.pose;
  entry.R = model.pose.linear().cast<float>();
  for (int b = 0; b < entry.bodies; ++b) slots_.push_back({index, b, model.bodies[b]});
  models_.push_back(entry);
  return index;
}

void RenderScene::attach(const Model& model, RTCScene tree, int first_id, const Pose3& T_tree_model) {
  const Eigen::Isometry3f T = T_tree_model.cast<float>();
  for (int b = 0; b < model.bodies; ++b) {
    const WorldBody& body = slots_[model.first_slot + b].source;
    if (body.triangles.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), body.vertices.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), body.triangles.size()));
    if (vertices == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
      throw std::runtime_error("no memory for body \"" + body.name + "\"");
    }
    for (const auto& v : body.vertices) {
      const Eigen::Vector3f p = T * v;
      vertices = std::copy_n(p.data(), 3, vertices);
    }
    for (const auto& t : body.triangles) indices = std::copy_n(t.data(), 3, indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree, geometry, static_cast<unsigned>(first_id + b));
    rtcReleaseGeometry(geometry);
  }
}

void RenderScene::makeOwnTree(int index) {
  Model& model = models_[index];
  model.own = rtcNewScene(device_);
  rtcSetSceneFlags(model.own, RTC_SCENE_FLAG_ROBUST);
  attach(model, model.own, 0, Pose3::Identity());
  rtcCommitScene(model.own);
  model.instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(model.instance, model.own);
  placeInstance(model);
  rtcAttachGeometryByID(top_, model.instance, static_cast<unsigned>(1 + index));
  top_changed_ = true;
}

void RenderScene::placeInstance(const Model& model) {
  const auto m = columns(model.pose);
  rtcSetGeometryTransform(model.instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m.data());
  if (model.visible) {
    rtcEnableGeometry(model.instance);
  } else {
    rtcDisableGeometry(model.instance);
  }
  rtcCommitGeometry(model.instance);
  top_changed_ = true;
}

void RenderScene::checkModel(int model) const {
  if (model < 0 || model >= modelCount()) {
    throw std::out_of_range("there is no model " + std::to_string(model) + " (0.." +
                            std::to_string(modelCount() - 1) + ")");
  }
}

int RenderScene::addModel(const WorldModel& model) {
  const int index = addSlots(model);
  makeOwnTree(index);
  return index;
}

void RenderScene::setPose(int index, const Pose3& pose) {
  checkModel(index);
  if (!pose.matrix().allFinite()) {
    throw std::invalid_argument("pose of model " + std::to_string(index) + " is not finite");
  }
  Model& model = models_[index];
  if (model.pose.matrix() == pose.matrix()) return;
  const bool was_shared = model.own == nullptr;
  model.pose = pose;
  model.R = pose.linear().cast<float>();
  if (!was_shared) {
    placeInstance(model);
    return;
  }
  for (int b = 0; b < model.bodies; ++b) {
    if (!slots_[model.first_slot + b].source.triangles.empty()) {
      rtcDetachGeometry(shared_, static_cast<unsigned>(model.first_slot + b));
    }
  }
  shared_changed_ = true;
  makeOwnTree(index);
}

void RenderScene::setVisible(int index, bool visible) {
  checkModel(index);
  Model& model = models_[index];
  if (model.visible == visible) return;
  model.visible = visible;
  if (model.own != nullptr) {
    placeInstance(model);
    return;
  }
  for (int b = 0; b < model.bodies; ++b) {
    if (slots_[model.first_slot + b].source.triangles.empty()) continue;
    RTCGeometry geometry = rtcGetGeometry(shared_, static_cast<unsigned>(model.first_slot + b));
    if (visible) {
      rtcEnableGeometry(geometry);
    } else {
      rtcDisableGeometry(geometry);
    }
  }
  shared_changed_ = true;
}

void RenderScene::commit() {
  if (shared_changed_) {
    rtcCommitScene(shared_);
    // An instance keeps its scene's bounds of the last commit.
    rtcCommitGeometry(shared_instance_);
    shared_changed_ = false;
    top_changed_ = true;
  }
  if (!top_changed_) return;
  use_top_ = std::any_of(models_.begin(), models_.end(),
                         [](const Model& model) { return model.own != nullptr && model.visible; });
  if (use_top_) rtcCommitScene(top_);
  top_changed_ = !use_top_ && top_changed_;
}

void RenderScene::intersect(RayPacket& p) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(p.valid.data(), use_top_ ? top_ : shared_, &context, &p.rays);
  const RTCHit8& hit = p.rays.hit;
  std::copy_n(hit.Ng_x, kPacket, p.nx.begin());
  std::copy_n(hit.Ng_y, kPacket, p.ny.begin());
  std::copy_n(hit.Ng_z, kPacket, p.nz.begin());
  for (int i = 0; i < kPacket; ++i) {
    const unsigned instance = hit.instID[0][i];
    if (p.valid[i] == 0 || hit.geomID[i] == kNone) {
      p.slot[i] = kNoSlot;
    } else if (instance == kNone || instance == 0) {
      p.slot[i] = static_cast<int>(hit.geomID[i]);
    } else {
      const Model& model = models_[instance - 1];
      p.slot[i] = model.first_slot + static_cast<int>(hit.geomID[i]);
      // Embree gives normals in the coordinates of the instanced tree.
      const Eigen::Vector3f n = model.R * Eigen::Vector3f(p.nx[i], p.ny[i], p.nz[i]);
      p.nx[i] = n.x();
      p.ny[i] = n.y();
      p.nz[i] = n.z();
    }
  }
}

void RenderScene::occluded(RTCRay8& rays, const std::array<int, kPacket>& valid) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded8(valid.data(), use_top_ ? top_ : shared_, &context, &rays);
}

}  // namespace vismem
