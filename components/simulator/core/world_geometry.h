/// @file Shapes and materials of SDF elements. Includes libsdformat: for world_loader.cpp only.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <sdf/Geometry.hh>
#include <sdf/Material.hh>
#include <string>
#include <vector>

#include "simulator/core/world_material.h"
#include "simulator/core/world_mesh.h"
#include "simulator/core/world_resolver.h"

namespace vismem {

/// *Single-threaded*: caches the files that it read.
class GeometryReader {
 public:
  GeometryReader(const UriResolver& resolver, std::function<void(const std::string&)> warn)
      : resolver_(resolver), warn_(std::move(warn)) {}

  struct Shape {
    std::vector<MeshPart> parts;
    bool solid = true;  ///< convex, or nearly
  };
  /// @param name of the visual or collision, for warnings.
  /// @return empty without a usable shape.
  std::optional<Shape> read(const std::string& name, const sdf::Geometry* geometry);
  /// Whether a visual of it is to be seen: false for none and for <empty/>.
  static bool isToBeSeen(const sdf::Geometry* geometry);
  /// File for the relative names of elements without a file of their own; empty: the world's folder.
  void readAs(std::filesystem::path file) { file_ = std::move(file); }
  /// Applies a material to the parts; properties that it does not define stay unchanged.
  void apply(const std::string& name, const sdf::Material& material, std::vector<MeshPart>& parts);

 private:
  std::optional<Shape> readMesh(const std::string& name, const sdf::Mesh& mesh);
  std::optional<Shape> readHeightmap(const std::string& name, const sdf::Heightmap& heightmap);
  std::optional<TriangleMesh> readPolylines(const std::string& name, const sdf::ElementPtr& geometry);
  bool usable(const std::string& name, const std::string& what, std::initializer_list<double> lengths);
  std::filesystem::path resolve(const std::string& uri, const std::string& named_in);
  std::optional<OgreMaterial> script(const std::string& name, const sdf::Material& material);
  std::shared_ptr<const Texture> texture(const std::string& name, const std::filesystem::path& file);

  std::filesystem::path fileOf(const std::string& named_in) const;

  const UriResolver& resolver_;
  std::filesystem::path file_;
  std::function<void(const std::string&)> warn_;
  std::map<std::string, std::optional<MeshFile>> meshes_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;
  std::map<std::string, std::map<std::string, OgreMaterial>> scripts_;
};

}  // namespace vismem
