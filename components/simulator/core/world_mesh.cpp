#include "simulator/core/world_mesh.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "simulator/core/world_material.h"
#include "simulator/core/world_resolver.h"

namespace vismem {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMaxMesh_bytes = 1u << 30;
/// Maximum depth of a node tree; deeper parts of malformed files are left out.
constexpr int kMaxDepth = 200;
constexpr std::size_t kMaxVertices = 40'000'000;

Eigen::Vector3f toVector(const aiColor3D& color) {
  return Eigen::Vector3f(color.r, color.g, color.b).cwiseMax(0.0f).cwiseMin(1.0f);
}

class MeshImporter {
 public:
  MeshImporter(const fs::path& file, const std::string& submesh) : file_(file), submesh_(submesh) {}

  MeshFile import() {
    std::error_code error;
    if (fs::file_size(file_, error) > kMaxMesh_bytes || error) {
      throw std::runtime_error(file_.string() + ": cannot be read, or over 1 GB");
    }
    // Gazebo ignores a Collada file's up axis, and its worlds rely on that.
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    // Worlds refer to the names of a Collada file's nodes, not to their ids.
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
    importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_LINE | aiPrimitiveType_POINT);
    scene_ = importer_.ReadFile(file_.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                                    aiProcess_SortByPType | aiProcess_ValidateDataStructure);
    if (scene_ == nullptr) throw std::runtime_error(file_.string() + ": " + importer_.GetErrorString());
    if (scene_->mRootNode != nullptr) addNode(*scene_->mRootNode, aiMatrix4x4(), 0, submesh_.empty());
    if (result_.parts.empty()) {
      throw std::runtime_error(file_.string() + ": holds no triangles" +
                               (submesh_.empty() ? "" : " called \"" + submesh_ + "\""));
    }
    return std::move(result_);
  }

 private:
  void addNode(const aiNode& node, const aiMatrix4x4& parent, int depth, bool wanted) {
    if (depth > kMaxDepth) return;
    wanted = wanted || submesh_ == node.mName.C_Str();
    const aiMatrix4x4 T = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_->mMeshes[node.mMeshes[i]];
      if (wanted || submesh_ == mesh.mName.C_Str()) addMesh(mesh, T, node.mName.C_Str());
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(*node.mChildren[i], T, depth + 1, wanted);
  }

  void addMesh(const aiMesh& mesh, const aiMatrix4x4& T, const std::string& name) {
    vertices_ += mesh.mNumVertices;
    if (vertices_ > kMaxVertices) throw std::runtime_error(file_.string() + ": too many vertices");
    MeshPart part;
    part.name = name;
    TriangleMesh& out = part.mesh;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      out.vertices.emplace_back(p.x, p.y, p.z);
      if (mesh.HasNormals())
        out.normals.emplace_back(mesh.mNormals[v].x, mesh.mNormals[v].y, mesh.mNormals[v].z);
      // Images are stored from the top; texture coordinates count from the bottom.
      if (mesh.HasTextureCoords(0)) {
        out.uvs.emplace_back(mesh.mTextureCoords[0][v].x, 1.0f - mesh.mTextureCoords[0][v].y);
      }
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 3) {
        out.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
      }
    }
    if (out.triangles.empty()) return;
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    transform.matrix() << T.a1, T.a2, T.a3, T.a4, T.b1, T.b2, T.b3, T.b4, T.c1, T.c2, T.c3, T.c4, 0, 0, 0, 1;
    transformMesh(out, transform);
    if (mesh.mMaterialIndex < scene_->mNumMaterials)
      useMaterial(*scene_->mMaterials[mesh.mMaterialIndex], part);
    result_.parts.push_back(std::move(part));
  }

  void useMaterial(const aiMaterial& material, MeshPart& part) {
    aiColor3D color;
    if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) part.color = toVector(color);
    if (material.Get(AI_MATKEY_COLOR_EMISSIVE, color) == AI_SUCCESS) part.emissive = toVector(color);
    aiString path;
    if (part.mesh.uvs.empty() || material.GetTexture(aiTextureType_DIFFUSE, 0, &path) != AI_SUCCESS) return;
    part.texture = texture(path.C_Str());
    // A textured material's own colour is often left black.
    if (part.texture) part.color.setOnes();
  }

  std::shared_ptr<const Texture> texture(const std::string& name) {
    const auto known = textures_.find(name);
    if (known != textures_.end()) return known->second;
    std::shared_ptr<const Texture> result;
    try {
      if (const aiTexture* embedded = scene_->GetEmbeddedTexture(name.c_str())) {
        if (embedded->mHeight != 0) throw std::runtime_error("embedded texture is not compressed");
        const auto* bytes = reinterpret_cast<const char*>(embedded->pcData);
        result = decodeTexture({bytes, embedded->mWidth}, file_.string() + " (" + name + ")");
      } else if (const auto path = findTexture(name)) {
        result = loadTexture(*path);
      } else {
        result_.notes.push_back("texture " + name + " of " + file_.string() + " not found");
      }
    } catch (const std::exception& error) {
      result_.notes.push_back(std::string("texture: ") + error.what());
    }
    textures_.emplace(name, result);
    return result;
  }

  std::optional<fs::path> findTexture(std::string name) const {
    for (char& c : name) {
      if (c == '\\') c = '/';
    }
    if (name.compare(0, 7, "file://") == 0) name = name.substr(7);
    const fs::path folder = file_.parent_path();
    const fs::path base = fs::path(name).filename();
    for (const fs::path& path :
         {folder / name, folder / base, folder / "../materials/textures" / base,
          folder / "materials/textures" / base, folder / "../textures" / base, folder / "textures" / base}) {
      std::error_code error;
      if (fs::is_regular_file(path, error)) return path;
    }
    return std::nullopt;
  }

  fs::path file_;
  std::string submesh_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  MeshFile result_;
  std::size_t vertices_ = 0;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;
};

}  // namespace

MeshFile loadMeshFile(const fs::path& file, const std::string& submesh, bool centre) {
  MeshFile result = MeshImporter(file, submesh).import();
  if (centre) {
    Eigen::AlignedBox3f box;
    for (const auto& part : result.parts) {
      for (const auto& v : part.mesh.vertices) box.extend(v);
    }
    for (auto& part : result.parts) {
      for (auto& v : part.mesh.vertices) v -= box.center();
    }
  }
  return result;
}

}  // namespace vismem
