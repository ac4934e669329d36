/// @file How surfaces look: OGRE material names and scripts, as Gazebo's worlds use them; texture files.
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
  std::string texture;  ///< as the script names it; empty: none
};

/// The materials of a script by name: their first `diffuse`, `emissive` and `texture` lines (also
/// `set_texture_alias` and a parent's, as in `material A : B`). What else a script says is passed over. Pure;
/// takes any text.
std::map<std::string, OgreMaterial> parseOgreScript(std::string_view text);

/// Colour of a material that ships with Gazebo ("Gazebo/Grey"), textured ones by their mean. Pure.
std::optional<OgreMaterial> gazeboMaterial(const std::string& name);

/// Reads a picture (any format that OpenCV knows). Wider or higher than 4096 pixels: halved until it is not.
/// @throws std::runtime_error naming the file and what is wrong.
std::shared_ptr<const Texture> loadTexture(const std::filesystem::path& file);
/// The same from a picture in memory. @param name for messages.
std::shared_ptr<const Texture> decodeTexture(std::string_view bytes, const std::string& name);

}  // namespace vismem
