/// @file The colour at intersections of rays: materials, textures, lights, shadows. Private to Renderer.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "simulator/core/renderer_scene.h"
#include "simulator/core/renderer_texture.h"

namespace vismem {

/// A colour in 0..1 (it may exceed 1 before clamping) and its body.
struct Shaded {
  Eigen::Vector3f color;
  int slot = kNoSlot;
};

/// *Thread-safe* but for addSlots.
class Shader {
 public:
  Shader(const World& world, const RenderScene& scene);

  /// Prepares the scene's new slots.
  void addSlots();

  /// Colours of the first `count` lanes of an intersected packet.
  /// @param pixel_rad the angle that a pixel covers, for textures.
  void shade(const RayPacket& packet, int count, float pixel_rad, Shaded* out) const;

 private:
  struct Material {
    Eigen::Vector3f color, emissive;
    const TexturePyramid* texture = nullptr;  ///< null: plain
    bool smooth = false;                      ///< has normals
    std::vector<float> texels_per_m;          ///< by triangle, with a texture
  };
  /// Lanes as structures of arrays, so that compilers make vectors of the loops over them.
  struct Lanes;

  void addLight(const Light& light, int count, Lanes& lanes) const;
  Eigen::Vector3f surfaceColor(const RayPacket& packet, int lane, const Lanes& lanes, float pixel_rad) const;
  Eigen::Vector3f smoothNormal(const RayPacket& packet, int lane, const Lanes& lanes) const;

  const RenderScene& scene_;
  std::vector<Light> lights_;
  Eigen::Vector3f ambient_;
  Eigen::Vector3f sky_;
  std::vector<Material> materials_;  ///< by slot
  std::map<const Texture*, std::unique_ptr<TexturePyramid>> textures_;
};

}  // namespace vismem
