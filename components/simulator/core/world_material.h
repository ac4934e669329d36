/// @file Materials of surfaces: OGRE material names and scripts of Gazebo's worlds; texture files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "simulator/core/world.h"

namespace vismem {

struct OgreMaterial {
  Eigen::Vector3f diffuse{1.0f, 1.0f, 1.0f};
  Eigen::Vector3f emissive = Eigen::Vector3f::Zero();
  std::string texture;  ///< name in the script; empty: none
};

/// The materials of a script by name: their first `diffuse`, `emissive` and `texture` lines (also
/// `set_texture_alias` and a parent's, as in `material A : B`). Other lines are ignored. Pure; accepts any
/// text.
std::map<std::string, OgreMaterial> parseOgreScript(std::string_view text);

/// Colour of a material that ships with Gazebo ("Gazebo/Grey"), textured ones by their mean. Pure.
std::optional<OgreMaterial> gazeboMaterial(const std::string& name);

/// Reads an image of any format of OpenCV, or TGA. Images wider or higher than 4096 px are halved until they
/// fit.
/// @throws std::runtime_error naming the file and the problem.
std::shared_ptr<const Texture> loadTexture(const std::filesystem::path& file);
/// As loadTexture from an image in memory.
/// @param name for messages.
std::shared_ptr<const Texture> decodeTexture(std::string_view bytes, const std::string& name);

}  // namespace vismem
