#include "simulator/core/world_optics.h"

#include <algorithm>
#include <sdf/Camera.hh>
#include <sdf/Noise.hh>

#include "common/geometry/camera.h"

namespace vismem {

Eigen::Vector3f lightColor(const ignition::math::Color& c) {
  const Eigen::Vector3f color(c.R(), c.G(), c.B());
  return color.allFinite() ? color.cwiseMax(0.0f).cwiseMin(10.0f).eval() : Eigen::Vector3f::Zero().eval();
}

std::optional<Light> readLight(const sdf::Light& light, const Pose3& T_world_light) {
  Light result;
  result.name = light.Name();
  result.kind = light.Type() == sdf::LightType::SPOT    ? Light::Kind::kSpot
                : light.Type() == sdf::LightType::POINT ? Light::Kind::kPoint
                                                        : Light::Kind::kDirectional;
  const auto direction = light.Direction();
  const Eigen::Vector3d d =
      T_world_light.linear() * Eigen::Vector3d(direction.X(), direction.Y(), direction.Z());
  const bool points_somewhere = d.norm() > 1e-9;
  if (result.kind != Light::Kind::kPoint && !points_somewhere) return std::nullopt;
  if (points_somewhere) result.direction = d.normalized().cast<float>();
  result.position = T_world_light.translation().cast<float>();
  const double intensity = light.Intensity() >= 0.0 && light.Intensity() < 100.0 ? light.Intensity() : 1.0;
  result.color = lightColor(light.Diffuse()) * static_cast<float>(intensity);
  const bool says = light.Element() && light.Element()->HasElement("cast_shadows");
  result.shadows = says ? light.CastShadows() : result.kind == Light::Kind::kDirectional;
  const auto factor = [](double value, double instead) {
    return static_cast<float>(value >= 0.0 && value < 1e6 ? value : instead);
  };
  result.range_m = factor(light.AttenuationRange(), 10.0);
  result.constant = factor(light.ConstantAttenuationFactor(), 1.0);
  result.linear = factor(light.LinearAttenuationFactor(), 0.0);
  result.quadratic = factor(light.QuadraticAttenuationFactor(), 0.0);
  result.inner_angle_rad = factor(light.SpotInnerAngle().Radian(), 0.0);
  result.outer_angle_rad = std::max(factor(light.SpotOuterAngle().Radian(), 0.0), result.inner_angle_rad);
  result.falloff = factor(light.SpotFalloff(), 1.0);
  return result;
}

std::optional<WorldCamera> readCamera(const sdf::Sensor& sensor, const Pose3& T_world_sensor,
                                      std::string& problem) {
  const sdf::Camera& camera = *sensor.CameraSensor();
  WorldCamera result;
  const double fov_rad = camera.HorizontalFov().Radian();
  const auto width = static_cast<int>(std::min(camera.ImageWidth(), 1u << 20));
  const auto height = static_cast<int>(std::min(camera.ImageHeight(), 1u << 20));
  problem = "its field of view or its image has no size";
  if (!(fov_rad > 0.0 && fov_rad < 3.1) || width <= 0 || height <= 0) return std::nullopt;
  result.intrinsics = intrinsicsFromFieldOfView(width, height, fov_rad);
  result.intrinsics.k1 = camera.DistortionK1();
  result.intrinsics.k2 = camera.DistortionK2();
  result.intrinsics.k3 = camera.DistortionK3();
  result.intrinsics.p1 = camera.DistortionP1();
  result.intrinsics.p2 = camera.DistortionP2();
  problem = checkIntrinsics(result.intrinsics);
  if (!problem.empty()) return std::nullopt;
  result.T_world_camera = T_world_sensor * cameraPose({}, 0.0, 0.0);
  if (camera.ImageNoise().Type() == sdf::NoiseType::GAUSSIAN && camera.ImageNoise().StdDev() >= 0.0) {
    result.noise_sigma = camera.ImageNoise().StdDev();
  }
  if (sensor.UpdateRate() > 0.0) result.rate_hz = sensor.UpdateRate();
  return result;
}

}  // namespace vismem
