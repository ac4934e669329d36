#include "simulator/core/renderer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace vismem {
namespace {

constexpr int kPacket = 8;
constexpr float kRayStart_m = 0.01f;
constexpr float kFar_m = 1000.0f;
/// Lifts the start of shadow rays off the surface they start from [m].
constexpr float kShadowLift_m = 1e-3f;
/// Neighbours that differ by more than this are refined [grey levels].
constexpr float kContrast = 8.0f;
constexpr unsigned kSkyId = RTC_INVALID_GEOMETRY_ID;
const Eigen::Vector3f kSkyColor(0.75f, 0.82f, 0.9f);
/// Rotated grid of the refined pixels [px].
constexpr std::array<std::array<double, 2>, 4> kSubPixels{
    {{-0.375, -0.125}, {0.125, -0.375}, {0.375, 0.125}, {-0.125, 0.375}}};

struct Shaded {
  Eigen::Vector3f color = kSkyColor;  // 0..1, may exceed 1 before clamping
  unsigned id = kSkyId;
};

std::uint8_t toByte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value * 255.0f + 0.5f, 0.0f, 255.0f));
}

}  // namespace

struct Renderer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Eigen::Vector3f> colors;
  Sun sun;

  // Directions in the camera frame: the pixel centres, and the four refined ones of every pixel.
  CameraIntrinsics table_for;
  std::vector<Eigen::Vector3f> centre_rays;
  std::vector<Eigen::Vector3f> fine_rays;
  std::vector<Shaded> shaded;
  std::vector<int> refined;
  std::vector<Eigen::Vector3f> directions;

  explicit Impl(const World& world) : sun(world.sun) {
    device = rtcNewDevice("threads=1,set_affinity=0");
    if (device == nullptr) throw std::runtime_error("Embree gives no device");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    for (const auto& body : world.bodies) {
      RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), body.vertices.size()));
      for (const auto& v : body.vertices) vertices = std::copy_n(v.data(), 3, vertices);
      auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), body.triangles.size()));
      for (const auto& t : body.triangles) indices = std::copy_n(t.data(), 3, indices);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
      colors.push_back(body.color);
    }
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the world");
  }

  ~Impl() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  void makeTables(const CameraIntrinsics& k) {
    if (k == table_for) return;
    table_for = k;
    const auto ray = [&](double u, double v) {
      return Eigen::Vector3f(idealPixelRay(k, undistortPixel(k, {u, v})).normalized().cast<float>());
    };
    centre_rays.clear();
    fine_rays.clear();
    for (int v = 0; v < k.height; ++v) {
      for (int u = 0; u < k.width; ++u) {
        centre_rays.push_back(ray(u, v));
        for (const auto& [du, dv] : kSubPixels) fine_rays.push_back(ray(u + du, v + dv));
      }
    }
    shaded.resize(centre_rays.size());
  }

  /// @param sunlit whether nothing stands between the surface and the sun.
  float lightOn(const Eigen::Vector3f& normal, bool sunlit) const {
    // A sky above and a darker floor below: tops, walls and undersides differ a little in the shade.
    const float light = sun.ambient * (0.85f + 0.15f * normal.z());
    return sunlit ? light + sun.diffuse * std::max(0.0f, -normal.dot(sun.direction)) : light;
  }

  /// Colours of up to eight rays from one origin.
  void shadePacket(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> d, Shaded* out) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(32) std::array<int, kPacket> valid{};
    RTCRayHit8 rays;
    const int n = static_cast<int>(d.size());
    for (int i = 0; i < kPacket; ++i) {
      const Eigen::Vector3f& direction = d[std::min(i, n - 1)];
      valid[i] = i < n ? -1 : 0;
      rays.ray.org_x[i] = origin.x();
      rays.ray.org_y[i] = origin.y();
      rays.ray.org_z[i] = origin.z();
      rays.ray.dir_x[i] = direction.x();
      rays.ray.dir_y[i] = direction.y();
      rays.ray.dir_z[i] = direction.z();
      rays.ray.tnear[i] = kRayStart_m;
      rays.ray.tfar[i] = kFar_m;
      rays.ray.mask[i] = ~0u;
      rays.ray.time[i] = 0.0f;
      rays.ray.flags[i] = 0;
      rays.hit.geomID[i] = kSkyId;
      rays.hit.instID[0][i] = kSkyId;
    }
    rtcIntersect8(valid.data(), scene, &context, &rays);

    RTCRay8 shadow;
    std::array<Eigen::Vector3f, kPacket> normals;
    alignas(32) std::array<int, kPacket> lit{};
    for (int i = 0; i < n; ++i) {
      if (rays.hit.geomID[i] == kSkyId) continue;
      Eigen::Vector3f normal(rays.hit.Ng_x[i], rays.hit.Ng_y[i], rays.hit.Ng_z[i]);
      normal.normalize();
      if (normal.dot(d[i]) > 0.0f) normal = -normal;
      normals[i] = normal;
      if (normal.dot(sun.direction) >= 0.0f) continue;
      lit[i] = -1;
      const Eigen::Vector3f p = origin + rays.ray.tfar[i] * d[i] + kShadowLift_m * normal;
      shadow.org_x[i] = p.x();
      shadow.org_y[i] = p.y();
      shadow.org_z[i] = p.z();
      shadow.dir_x[i] = -sun.direction.x();
      shadow.dir_y[i] = -sun.direction.y();
      shadow.dir_z[i] = -sun.direction.z();
      shadow.tnear[i] = kShadowLift_m;
      shadow.tfar[i] = kFar_m;
      shadow.mask[i] = ~0u;
      shadow.time[i] = 0.0f;
      shadow.flags[i] = 0;
    }
    rtcOccluded8(lit.data(), scene, &context, &shadow);

    for (int i = 0; i < n; ++i) {
      out[i] = {};
      const unsigned id = rays.hit.geomID[i];
      if (id == kSkyId) continue;
      out[i] = {lightOn(normals[i], lit[i] != 0 && shadow.tfar[i] >= 0.0f) * colors[id], id};
    }
  }

  void shadeAll(const Eigen::Vector3f& origin, const std::vector<Eigen::Vector3f>& d,
                std::vector<Shaded>& out) {
    out.resize(d.size());
    for (std::size_t i = 0; i < d.size(); i += kPacket) {
      const std::size_t n = std::min<std::size_t>(kPacket, d.size() - i);
      shadePacket(origin, std::span(d).subspan(i, n), out.data() + i);
    }
  }
};

Renderer::Renderer(const World& world) : impl_(std::make_unique<Impl>(world)) {}
Renderer::~Renderer() = default;

cv::Mat Renderer::render(const CameraIntrinsics& k, const Pose3& T_world_camera) {
  Impl& m = *impl_;
  m.makeTables(k);
  const Eigen::Matrix3f R = T_world_camera.linear().cast<float>();
  const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();

  m.directions.resize(m.centre_rays.size());
  for (std::size_t i = 0; i < m.centre_rays.size(); ++i) m.directions[i] = R * m.centre_rays[i];
  m.shadeAll(origin, m.directions, m.shaded);

  // Pixels that differ from the one to the right or below: both get refined.
  const auto differs = [&](int i, int j) {
    const Shaded& a = m.shaded[i];
    const Shaded& b = m.shaded[j];
    return a.id != b.id || (a.color - b.color).cwiseAbs().maxCoeff() * 255.0f > kContrast;
  };
  std::vector<char> refine(m.shaded.size(), 0);
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const int i = v * k.width + u;
      if (u + 1 < k.width && differs(i, i + 1)) refine[i] = refine[i + 1] = 1;
      if (v + 1 < k.height && differs(i, i + k.width)) refine[i] = refine[i + k.width] = 1;
    }
  }

  cv::Mat image(k.height, k.width, CV_8UC3);
  std::array<Eigen::Vector3f, 2 * kSubPixels.size()> fine;
  std::array<Shaded, 2 * kSubPixels.size()> fine_shaded;
  for (int i = 0; i < static_cast<int>(m.shaded.size()); ++i) {
    Eigen::Vector3f color = m.shaded[i].color;
    if (refine[i] != 0) {
      for (std::size_t s = 0; s < kSubPixels.size(); ++s)
        fine[s] = R * m.fine_rays[i * kSubPixels.size() + s];
      m.shadePacket(origin, std::span(fine).first(kSubPixels.size()), fine_shaded.data());
      color.setZero();
      for (std::size_t s = 0; s < kSubPixels.size(); ++s) {
        color += fine_shaded[s].color.cwiseMin(1.0f) / static_cast<float>(kSubPixels.size());
      }
    }
    std::uint8_t* pixel = image.data + 3 * static_cast<std::size_t>(i);
    for (int c = 0; c < 3; ++c) pixel[c] = toByte(color[c]);
  }
  return image;
}

std::optional<RayHit> Renderer::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const Eigen::Vector3f d = direction.normalized().cast<float>();
  const Eigen::Vector3f o = origin.cast<float>();
  RTCRayHit ray{};
  std::tie(ray.ray.org_x, ray.ray.org_y, ray.ray.org_z) = std::tuple(o.x(), o.y(), o.z());
  std::tie(ray.ray.dir_x, ray.ray.dir_y, ray.ray.dir_z) = std::tuple(d.x(), d.y(), d.z());
  ray.ray.tnear = 0.0f;
  ray.ray.tfar = kFar_m;
  ray.ray.mask = ~0u;
  ray.hit.geomID = kSkyId;
  ray.hit.instID[0] = kSkyId;
  rtcIntersect1(impl_->scene, &context, &ray);
  if (ray.hit.geomID == kSkyId) return std::nullopt;
  Eigen::Vector3f normal(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  normal.normalize();
  const bool from_inside = normal.dot(d) > 0.0f;
  if (from_inside) normal = -normal;

  const Eigen::Vector3f p = o + ray.ray.tfar * d + kShadowLift_m * normal;
  const Eigen::Vector3f to_sun = -impl_->sun.direction;
  RTCRay shadow{};
  std::tie(shadow.org_x, shadow.org_y, shadow.org_z) = std::tuple(p.x(), p.y(), p.z());
  std::tie(shadow.dir_x, shadow.dir_y, shadow.dir_z) = std::tuple(to_sun.x(), to_sun.y(), to_sun.z());
  shadow.tnear = kShadowLift_m;
  shadow.tfar = kFar_m;
  shadow.mask = ~0u;
  rtcOccluded1(impl_->scene, &context, &shadow);
  const bool sunlit = shadow.tfar >= 0.0f;
  return RayHit{ray.ray.tfar, static_cast<int>(ray.hit.geomID), normal.cast<double>(),
                impl_->lightOn(normal, sunlit) * impl_->colors[ray.hit.geomID], from_inside};
}

}  // namespace vismem
