/// @file Mesh files (all formats of assimp: Collada, OBJ, STL ...) as parts of one material each.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "simulator/core/shapes.h"
#include "simulator/core/world.h"

namespace vismem {

struct MeshPart {
  std::string name;  ///< of the part of the file it comes from
  TriangleMesh mesh;
  Eigen::Vector3f color{0.7f, 0.7f, 0.7f};
  Eigen::Vector3f emissive = Eigen::Vector3f::Zero();
  std::shared_ptr<const Texture> texture;  ///< may be null
};

struct MeshFile {
  std::vector<MeshPart> parts;
  std::vector<std::string> notes;  ///< unusable parts, one line each
};

/// Reads a mesh and converts it to metres as Gazebo does: a Collada file's unit is applied, its up axis is
/// ignored. Textures are searched beside the file, in ../materials/textures and materials/textures there, by
/// the path that the file gives and by its last part.
/// @param submesh only parts of that name, or all if empty.
/// @param centre moves the middle of their bounding box to the origin.
/// @throws std::runtime_error naming the file and the problem.
MeshFile loadMeshFile(const std::filesystem::path& file, const std::string& submesh, bool centre);

}  // namespace vismem
