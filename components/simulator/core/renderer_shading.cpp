#include "simulator/core/renderer_shading.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

/// Lifts the start of shadow rays off the surface they start from [m].
constexpr float kShadowLift_m = 1e-3f;
constexpr float kFar_m = 1000.0f;
/// Cosine below which light fades out at grazing incidence: a rounded surface of flat triangles would
/// otherwise have stepped shadows of itself.
constexpr float kGrazing = 0.2f;

float fade(float value, float zero, float one) {
  const float t = std::clamp((value - zero) / (one - zero), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// Intensity of a point or spot light at a distance along the unit vector `travel`.
float strengthAt(const Light& light, const Eigen::Vector3f& travel, float distance) {
  if (distance > light.range_m) return 0.0f;
  const float divisor = light.constant + distance * (light.linear + distance * light.quadratic);
  float strength = divisor > 1e-6f ? 1.0f / divisor : 1.0f;
  if (light.kind == Light::Kind::kSpot) {
    const float angle = 2.0f * std::acos(std::clamp(travel.dot(light.direction), -1.0f, 1.0f));
    if (angle >= light.outer_angle_rad) return 0.0f;
    if (angle > light.inner_angle_rad) {
      strength *= std::pow((light.outer_angle_rad - angle) / (light.outer_angle_rad - light.inner_angle_rad),
                           light.falloff);
    }
  }
  return strength;
}

}  // namespace

struct Shader::Lanes {
  using Floats = std::array<float, kPacket>;
  alignas(32) Floats px, py, pz;        ///< intersection with the surface
  alignas(32) Floats gx, gy, gz;        ///< normal of the triangle, of unit length, towards the eye
  alignas(32) Floats nx, ny, nz;        ///< normal for light: that of the rounded surface where there is one
  alignas(32) Floats view;              ///< cosine between the ray and the triangle's normal
  alignas(32) Floats red, green, blue;  ///< light that arrives
  std::array<bool, kPacket> hit{}, smooth{};
};

Shader::Shader(const World& world, const RenderScene& scene)
    : scene_(scene), lights_(world.lights), ambient_(world.ambient), sky_(world.sky) {
  addSlots();
}

void Shader::addSlots() {
  while (materials_.size() < scene_.slotCount()) {
    const WorldBody& body = scene_.slot(static_cast<int>(materials_.size())).source;
    Material material{body.color, body.emissive, nullptr, !body.normals.empty(), texelsPerMetre(body)};
    if (!material.texels_per_m.empty()) {
      auto& pyramid = textures_[body.texture.get()];
      if (!pyramid) pyramid = std::make_unique<TexturePyramid>(*body.texture);
      material.texture = pyramid.get();
    }
    materials_.push_back(std::move(material));
  }
}

void Shader::addLight(const Light& light, int count, Lanes& l) const {
  alignas(32) Lanes::Floats lx, ly, lz, far, strength;
  if (light.kind == Light::Kind::kDirectional) {
    lx.fill(-light.direction.x());
    ly.fill(-light.direction.y());
    lz.fill(-light.direction.z());
    far.fill(kFar_m);
    strength.fill(1.0f);
  } else {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3f to = light.position - Eigen::Vector3f(l.px[i], l.py[i], l.pz[i]);
      const float distance = std::max(to.norm(), 1e-6f);
      const Eigen::Vector3f unit = to / distance;
      lx[i] = unit.x();
      ly[i] = unit.y();
      lz[i] = unit.z();
      far[i] = distance;
      strength[i] = strengthAt(light, -unit, distance);
    }
  }
  RTCRay8 shadow;
  alignas(32) std::array<int, kPacket> lit{};
  alignas(32) Lanes::Floats cosine{};
  int first = -1;  // lane that may be lit
  for (int i = 0; i < count; ++i) {
    const float flat = l.gx[i] * lx[i] + l.gy[i] * ly[i] + l.gz[i] * lz[i];
    cosine[i] = l.nx[i] * lx[i] + l.ny[i] * ly[i] + l.nz[i] * lz[i];
    if (!l.hit[i] || flat <= 0.0f || cosine[i] <= 0.0f || strength[i] <= 0.0f) continue;
    lit[i] = -1;
    if (first < 0) first = i;
    if (l.smooth[i]) cosine[i] *= fade(cosine[i], 0.0f, kGrazing);
  }
  if (first < 0) return;
  for (int i = 0; i < kPacket; ++i) {
    // Where packets are narrower than these, Embree looks at idle lanes too: they must hold a ray.
    const int from = lit[i] != 0 ? i : first;
    shadow.org_x[i] = l.px[from] + kShadowLift_m * l.gx[from];
    shadow.org_y[i] = l.py[from] + kShadowLift_m * l.gy[from];
    shadow.org_z[i] = l.pz[from] + kShadowLift_m * l.gz[from];
    shadow.dir_x[i] = lx[from];
    shadow.dir_y[i] = ly[from];
    shadow.dir_z[i] = lz[from];
    shadow.tnear[i] = kShadowLift_m;
    shadow.tfar[i] = far[from];
    shadow.mask[i] = ~0u;
    shadow.time[i] = 0.0f;
    shadow.flags[i] = 0;
  }
  if (light.shadows) scene_.occluded(shadow, lit);
  for (int i = 0; i < count; ++i) {
    if (lit[i] == 0 || shadow.tfar[i] < 0.0f) continue;
    const float arriving = strength[i] * cosine[i];
    l.red[i] += light.color.x() * arriving;
    l.green[i] += light.color.y() * arriving;
    l.blue[i] += light.color.z() * arriving;
  }
}

Eigen::Vector3f Shader::smoothNormal(const RayPacket& p, int lane, const Lanes& l) const {
  const WorldBody& body = scene_.slot(p.slot[lane]).source;
  const auto& t = body.triangles[p.rays.hit.primID[lane]];
  const float u = p.rays.hit.u[lane];
  const float v = p.rays.hit.v[lane];
  const Eigen::Vector3f mean =
      (1.0f - u - v) * body.normals[t[0]] + u * body.normals[t[1]] + v * body.normals[t[2]];
  const Eigen::Vector3f flat(l.gx[lane], l.gy[lane], l.gz[lane]);
  Eigen::Vector3f normal = scene_.rotationOf(p.slot[lane]) * mean;
  const float length = normal.norm();
  if (!(length > 1e-6f)) return flat;
  normal /= length;
  return normal.dot(flat) < 0.0f ? Eigen::Vector3f(-normal) : normal;
}

Eigen::Vector3f Shader::surfaceColor(const RayPacket& p, int lane, const Lanes& l, float pixel_rad) const {
  const Material& material = materials_[p.slot[lane]];
  if (material.texture == nullptr) return material.color;
  const WorldBody& body = scene_.slot(p.slot[lane]).source;
  const unsigned triangle = p.rays.hit.primID[lane];
  const auto& t = body.triangles[triangle];
  const float u = p.rays.hit.u[lane];
  const float v = p.rays.hit.v[lane];
  const Eigen::Vector2f uv = (1.0f - u - v) * body.uvs[t[0]] + u * body.uvs[t[1]] + v * body.uvs[t[2]];
  // The footprint of a pixel is longer for flatter rays. The mean of both directions is a compromise between
  // blur and flicker.
  const float footprint_m = p.rays.ray.tfar[lane] * pixel_rad / std::sqrt(std::max(l.view[lane], 0.02f));
  return material.color.cwiseProduct(
      material.texture->sample(uv.x(), uv.y(), footprint_m * material.texels_per_m[triangle]));
}

void Shader::shade(const RayPacket& p, int count, float pixel_rad, Shaded* out) const {
  Lanes l;
  const RTCRay8& ray = p.rays.ray;
  for (int i = 0; i < kPacket; ++i) {
    const float length = std::sqrt(p.nx[i] * p.nx[i] + p.ny[i] * p.ny[i] + p.nz[i] * p.nz[i]);
    const float along = p.nx[i] * ray.dir_x[i] + p.ny[i] * ray.dir_y[i] + p.nz[i] * ray.dir_z[i];
    const float scale = (along > 0.0f ? -1.0f : 1.0f) / length;
    l.gx[i] = scale * p.nx[i];
    l.gy[i] = scale * p.ny[i];
    l.gz[i] = scale * p.nz[i];
    l.view[i] = std::abs(along) / length;
    l.px[i] = ray.org_x[i] + ray.tfar[i] * ray.dir_x[i];
    l.py[i] = ray.org_y[i] + ray.tfar[i] * ray.dir_y[i];
    l.pz[i] = ray.org_z[i] + ray.tfar[i] * ray.dir_z[i];
  }
  l.nx = l.gx;
  l.ny = l.gy;
  l.nz = l.gz;
  for (int i = 0; i < count; ++i) {
    l.hit[i] = p.slot[i] != kNoSlot;
    l.smooth[i] = l.hit[i] && materials_[p.slot[i]].smooth;
    if (!l.smooth[i]) continue;
    const Eigen::Vector3f n = smoothNormal(p, i, l);
    l.nx[i] = n.x();
    l.ny[i] = n.y();
    l.nz[i] = n.z();
  }
  // A sky above and a darker floor below: tops, walls and undersides differ a little in the shade.
  for (int i = 0; i < kPacket; ++i) {
    const float share = 0.85f + 0.15f * l.nz[i];
    l.red[i] = ambient_.x() * share;
    l.green[i] = ambient_.y() * share;
    l.blue[i] = ambient_.z() * share;
  }
  for (const Light& light : lights_) addLight(light, count, l);
  for (int i = 0; i < count; ++i) {
    out[i].slot = p.slot[i];
    if (!l.hit[i]) {
      out[i].color = sky_;
      continue;
    }
    const Eigen::Vector3f light(l.red[i], l.green[i], l.blue[i]);
    out[i].color = light.cwiseProduct(surfaceColor(p, i, l, pixel_rad)) + materials_[p.slot[i]].emissive;
  }
}

}  // namespace vismem
