/// @file Lights and cameras of an SDF world. Includes libsdformat: for world_loader.cpp only.
#pragma once

#include <optional>
#include <sdf/Light.hh>
#include <sdf/Sensor.hh>
#include <string>

#include "simulator/core/world.h"

namespace vismem {

/// R, G, B of a colour of libsdformat, each in 0..10; black if it is not finite.
Eigen::Vector3f lightColor(const ignition::math::Color& color);

/// A light at its place. Gazebo's defaults: directional lights cast shadows, point and spot lights do not.
/// @return empty for a directional or spot light whose direction has no length.
std::optional<Light> readLight(const sdf::Light& light, const Pose3& T_world_light);

/// A sensor's camera at its place; SDF cameras look along their x axis.
/// @param problem receives why it cannot be used.
/// @return empty without a usable camera.
std::optional<WorldCamera> readCamera(const sdf::Sensor& sensor, const Pose3& T_world_sensor,
                                      std::string& problem);

}  // namespace vismem
