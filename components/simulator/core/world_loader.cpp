// The only file that includes libsdformat: its headers are slow to compile.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <tinyxml2.h>

#include <assimp/Importer.hpp>
#include <cctype>
#include <limits>
#include <optional>
#include <regex>
#include <sdf/sdf.hh>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "simulator/core/shapes.h"
#include "simulator/core/world.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ignition::math::Pose3d;

/// An sdf plane is infinite; its picture is not.
constexpr double kGroundPlaneSize_m = 200.0;

/// ground_plane and sun ship with Gazebo, not with the worlds that include them.
constexpr const char* kGroundPlane = R"(<model name="ground_plane"><static>true</static><link name="link">
<visual name="visual"><geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry>
<material><ambient>0.5 0.5 0.5 1</ambient><diffuse>0.5 0.5 0.5 1</diffuse></material></visual></link></model>)";
constexpr const char* kSun = R"(<light name="sun" type="directional"><pose>0 0 10 0 0 0</pose>
<diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light>)";

std::string withBuiltIns(const std::string& text) {
  const auto include = [](const char* name) {
    return std::regex("<include>\\s*<uri>\\s*model://" + std::string(name) + "\\s*</uri>\\s*</include>");
  };
  return std::regex_replace(std::regex_replace(text, include("ground_plane"), kGroundPlane), include("sun"),
                            kSun);
}

Pose3 toPose3(const Pose3d& pose) {
  Pose3 result = Pose3::Identity();
  result.linear() =
      Eigen::Quaterniond(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z()).toRotationMatrix();
  result.translation() = Eigen::Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  return result;
}

class WorldBuilder {
 public:
  WorldBuilder(fs::path file, std::vector<fs::path> search)
      : file_(std::move(file)), search_(std::move(search)) {}

  void warn(const std::string& text) { loaded_.warnings.push_back(file_.string() + ": " + text); }

  /// Where a uri of the world leads; empty if nowhere.
  fs::path resolve(const std::string& uri) const {
    std::string name = uri;
    for (const char* scheme : {"model://", "file://"}) {
      if (name.rfind(scheme, 0) == 0) name = name.substr(std::string(scheme).size());
    }
    if (fs::path(name).is_absolute() && fs::exists(name)) return name;
    for (const auto& folder : search_) {
      if (fs::exists(folder / name)) return folder / name;
    }
    return {};
  }

  void addModel(const sdf::Model& model) {
    WorldModel result;
    result.name = freeName(model.Name());
    result.pose = poseOf(model);
    addParts(model, "", Pose3::Identity(), result);
    for (auto& obstacle : result.outlines) {
      // Outlines are kept in the plan frame of the model as it stands.
      const Pose2 T_plan_world = inverse(toPose2(result.pose));
      for (auto& p : obstacle.outline) p = transform(T_plan_world, p);
    }
    if (!result.bodies.empty() || !result.outlines.empty()) {
      loaded_.world.models.push_back(std::move(result));
    }
  }

  void addLight(const sdf::Light& light) {
    if (light.Type() != sdf::LightType::DIRECTIONAL) {
      warn("light \"" + light.Name() + "\" is not directional: only a sun is simulated");
      return;
    }
    const auto direction = light.Direction();
    Eigen::Vector3d d(direction.X(), direction.Y(), direction.Z());
    Pose3d pose;
    if (light.SemanticPose().Resolve(pose).empty()) d = toPose3(pose).linear() * d;
    if (d.norm() < 1e-9) {
      warn("light \"" + light.Name() + "\" has a direction of no length: ignored");
      return;
    }
    Light result;
    result.name = light.Name();
    result.direction = d.normalized().cast<float>();
    result.color = toColor(light.Diffuse());
    result.shadows = true;
    loaded_.world.lights.push_back(result);
  }

  void setScene(const sdf::Scene& scene) { loaded_.world.ambient = toColor(scene.Ambient()); }

  LoadedWorld take(std::string name) {
    loaded_.world.name = std::move(name);
    if (loaded_.world.bodyCount() == 0) {
      throw ConfigError({file_.string() + ": the world has nothing to show (no visual with triangles" +
                         (loaded_.warnings.empty() ? "" : "; " + loaded_.warnings.front()) + ")"});
    }
    // A world that says nothing about light is not dark.
    if (loaded_.world.lights.empty()) loaded_.world.lights.emplace_back();
    return std::move(loaded_);
  }

 private:
  static Eigen::Vector3f toColor(const ignition::math::Color& color) {
    return {color.R(), color.G(), color.B()};
  }
  /// In the frame of what it is part of.
  template <typename Part>
  static Pose3 poseOf(const Part& part) {
    Pose3d pose;
    if (!part.SemanticPose().Resolve(pose).empty()) pose = part.RawPose();
    return toPose3(pose);
  }
  /// Names of models are how scenarios name them: each only once.
  std::string freeName(const std::string& wanted) const {
    std::string name = wanted;
    for (int i = 1; loaded_.world.modelNamed(name); ++i) name = wanted + "_" + std::to_string(i);
    return name;
  }

  /// Links of a model and of the models nested in it. @param T_model_parts of its frame in the whole model.
  void addParts(const sdf::Model& model, const std::string& prefix, const Pose3& T_model_parts,
                WorldModel& out) {
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      addLink(prefix + link.Name(), link, T_model_parts * poseOf(link), out);
    }
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& nested = *model.ModelByIndex(i);
      addParts(nested, prefix + nested.Name() + "/", T_model_parts * poseOf(nested), out);
    }
  }

  void addLink(const std::string& name, const sdf::Link& link, const Pose3& T_model_link, WorldModel& out) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
      const sdf::Visual& visual = *link.VisualByIndex(i);
      WorldBody body;
      body.name = name + "/" + visual.Name();
      const auto mesh = meshOf(out.name + "/" + body.name, visual.Geom());
      if (!mesh || mesh->triangles.empty()) continue;
      if (const sdf::Material* material = visual.Material()) body.color = toColor(material->Diffuse());
      const Eigen::Isometry3f T = (T_model_link * poseOf(visual)).template cast<float>();
      body.vertices.reserve(mesh->vertices.size());
      for (const auto& vertex : mesh->vertices) body.vertices.push_back(T * vertex);
      body.triangles = mesh->triangles;
      out.bodies.push_back(std::move(body));
    }
    for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
      const sdf::Collision& collision = *link.CollisionByIndex(i);
      const std::string shape_name = name + "/" + collision.Name();
      if (collision.Geom() != nullptr && collision.Geom()->Type() == sdf::GeometryType::PLANE) continue;
      const auto mesh = meshOf(out.name + "/" + shape_name, collision.Geom());
      if (mesh) addObstacle(shape_name, *mesh, out.pose * T_model_link * poseOf(collision), out);
    }
  }

  /// The outline in the world's plan view; addModel turns it into the model's.
  static void addObstacle(const std::string& name, const TriangleMesh& mesh, const Pose3& T_world_shape,
                          WorldModel& out) {
    if (mesh.vertices.empty()) return;
    std::vector<Eigen::Vector2d> points;
    double low = std::numeric_limits<double>::max();
    double high = std::numeric_limits<double>::lowest();
    for (const auto& vertex : mesh.vertices) {
      const Eigen::Vector3d p = T_world_shape * vertex.cast<double>();
      points.emplace_back(p.head<2>());
      low = std::min(low, p.z());
      high = std::max(high, p.z());
    }
    auto outline = convexHull(std::move(points));
    const double z = out.pose.translation().z();
    if (outline.size() >= 3) out.outlines.push_back({name, std::move(outline), low - z, high - z});
  }

  std::optional<TriangleMesh> meshOf(const std::string& name, const sdf::Geometry* geometry) {
    if (geometry == nullptr) return std::nullopt;
    switch (geometry->Type()) {
      case sdf::GeometryType::BOX: {
        const auto size = geometry->BoxShape()->Size();
        return boxMesh({size.X(), size.Y(), size.Z()});
      }
      case sdf::GeometryType::PLANE: {
        auto size = geometry->PlaneShape()->Size();
        if (size.X() <= 0 || size.Y() <= 0) size.Set(kGroundPlaneSize_m, kGroundPlaneSize_m);
        auto mesh = planeMesh({size.X(), size.Y()});
        const auto n = geometry->PlaneShape()->Normal();
        const auto turn = Eigen::Quaternionf::FromTwoVectors(
            Eigen::Vector3f::UnitZ(), Eigen::Vector3d(n.X(), n.Y(), n.Z()).cast<float>());
        for (auto& vertex : mesh.vertices) vertex = turn * vertex;
        return mesh;
      }
      case sdf::GeometryType::CYLINDER:
        return cylinderMesh(geometry->CylinderShape()->Radius(), geometry->CylinderShape()->Length());
      case sdf::GeometryType::SPHERE:
        return sphereMesh(geometry->SphereShape()->Radius());
      case sdf::GeometryType::MESH:
        return importMesh(name, *geometry->MeshShape());
      default:
        // libsdformat 12 has no class for polylines, but it keeps the element.
        if (geometry->Element() && geometry->Element()->HasElement("polyline")) {
          return polylineMesh(name, geometry->Element());
        }
        warn("\"" + name +
             "\" has a geometry that is not simulated (box, plane, cylinder, sphere, polyline, mesh are)");
        return std::nullopt;
    }
  }

  TriangleMesh polylineMesh(const std::string& name, const sdf::ElementPtr& geometry) {
    TriangleMesh whole;
    for (auto e = geometry->GetElement("polyline"); e; e = e->GetNextElement("polyline")) {
      std::vector<Eigen::Vector2d> outline;
      for (auto p = e->FindElement("point"); p; p = p->GetNextElement("point")) {
        const auto point = p->Get<ignition::math::Vector2d>();
        outline.emplace_back(point.X(), point.Y());
      }
      const TriangleMesh part = prismMesh(std::move(outline), e->Get<double>("height"));
      if (part.triangles.empty()) {
        warn("\"" + name + "\": a polyline that has no area or crosses itself: left out");
      }
      const auto first = static_cast<std::uint32_t>(whole.vertices.size());
      whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
      for (const auto& t : part.triangles) {
        whole.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
      }
    }
    return whole;
  }

  std::optional<TriangleMesh> importMesh(const std::string& name, const sdf::Mesh& shape) {
    const fs::path path = resolve(shape.Uri());
    if (path.empty()) {
      warn("\"" + name + "\": mesh " + shape.Uri() + " not found");
      return std::nullopt;
    }
    Assimp::Importer importer;
    // Gazebo ignores a Collada file's up axis, and its worlds are made for that.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    const aiScene* scene =
        importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                             aiProcess_JoinIdenticalVertices);
    if (scene == nullptr) {
      warn("\"" + name + "\": mesh " + path.string() + ": " + importer.GetErrorString());
      return std::nullopt;
    }
    const auto scale = shape.Scale();
    TriangleMesh mesh;
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
      const aiMesh& part = *scene->mMeshes[m];
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (unsigned v = 0; v < part.mNumVertices; ++v) {
        const aiVector3D& p = part.mVertices[v];
        mesh.vertices.emplace_back(
            Eigen::Vector3d(p.x * scale.X(), p.y * scale.Y(), p.z * scale.Z()).cast<float>());
      }
      for (unsigned f = 0; f < part.mNumFaces; ++f) {
        const aiFace& face = part.mFaces[f];
        if (face.mNumIndices != 3) continue;
        mesh.triangles.emplace_back(first + face.mIndices[0], first + face.mIndices[1],
                                    first + face.mIndices[2]);
      }
    }
    return mesh;
  }

  fs::path file_;
  std::vector<fs::path> search_;
  LoadedWorld loaded_;
};

/// "XML_ERROR_EMPTY_DOCUMENT" -> "empty document".
std::string inWords(std::string name) {
  constexpr std::string_view kBeginning = "XML_ERROR_";
  if (name.starts_with(kBeginning)) name.erase(0, kBeginning.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// Looks at the document first: libsdformat's own words for what is no XML or no SDF are the whole text.
void checkDocument(const std::string& text, const fs::path& file) {
  const auto failure = [&](int line, const std::string& what) {
    return ConfigError({file.string() + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what +
                        " (must be a world in SDF)"});
  };
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw failure(document.ErrorLineNum(), "not XML: " + inWords(document.ErrorName()));
  }
  const auto* root = document.RootElement();
  if (root == nullptr) throw failure(0, "no XML element");
  if (std::string(root->Name()) != "sdf") {
    throw failure(root->GetLineNum(), std::string("begins with the element <") + root->Name() + ">");
  }
}

}  // namespace

LoadedWorld loadWorld(const fs::path& file, const std::vector<fs::path>& model_paths) {
  const std::string text = readTextFile(file, "a world in SDF");
  checkDocument(text, file);
  std::vector<fs::path> search = model_paths;
  search.push_back(file.parent_path());
  WorldBuilder builder(file, search);

  // Its complaints come back as values; on the console they would stand there twice.
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Root root;
  sdf::ParserConfig config;
  config.SetFindCallback([&](const std::string& uri) { return builder.resolve(uri).string(); });
  sdf::Errors errors;
  try {
    errors = root.LoadSdfString(withBuiltIns(text), config);
  } catch (const std::exception& error) {
    throw ConfigError({file.string() + ": " + error.what()});
  }
  for (const auto& error : errors) builder.warn(error.Message());
  if (root.WorldCount() == 0) {
    std::string why = errors.empty() ? "no <world> element" : errors.front().Message();
    throw ConfigError({file.string() + ": not a world in SDF: " + why});
  }
  const sdf::World& world = *root.WorldByIndex(0);
  if (world.Scene() != nullptr) builder.setScene(*world.Scene());
  for (std::uint64_t i = 0; i < world.LightCount(); ++i) builder.addLight(*world.LightByIndex(i));
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i) {
    builder.addModel(*world.ModelByIndex(i));
  }
  return builder.take(world.Name());
}

}  // namespace vismem
