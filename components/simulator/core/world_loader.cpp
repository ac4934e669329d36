#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sdf/sdf.hh>
#include <set>
#include <sstream>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "simulator/core/world.h"
#include "simulator/core/world_geometry.h"
#include "simulator/core/world_includes.h"
#include "simulator/core/world_optics.h"
#include "simulator/core/world_outlines.h"
#include "simulator/core/world_reading.h"
#include "simulator/core/world_repair/text_repair.h"
#include "simulator/core/world_repair/world_document.h"
#include "simulator/core/world_resolver.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ignition::math::Pose3d;

constexpr double kMaxPosition_m = 1e6;
constexpr std::size_t kMaxLights = 16;
/// Maximum number of libsdformat's errors in a message.
constexpr std::size_t kMaxReasons = 5;
constexpr std::size_t kShownReason = 200;
/// What libsdformat adds to any complaint, also when there is a world.
constexpr std::string_view kNoWorld = "Failed to load a world.";

class WorldBuilder {
 public:
  WorldBuilder(std::string file, std::vector<fs::path> search, int rescue_tries = kRescueTries)
      : file_(std::move(file)),
        rescue_tries_(rescue_tries),
        resolver_(std::move(search)),
        reader_([this](const std::string& uri) { return findInclude(uri); }),
        geometry_(resolver_, [this](const std::string& text) { warn(text); }) {}

  /// Equal warnings of many parts become one.
  void warn(const std::string& text) {
    if (warned_.insert(text).second) loaded_.warnings.push_back(file_ + ": " + text);
  }

  /// Path of an include for libsdformat: a folder with model.config, or a file.
  std::string findInclude(const std::string& uri) {
    const auto found = resolver_.find(uri);
    if (!found.note.empty()) warn(found.note);
    std::error_code error;
    if (fs::is_directory(found.path, error) && !pathExists(found.path / "model.config") &&
        !pathExists(found.path / "manifest.xml")) {
      if (!pathExists(found.path / "model.sdf")) return found.path.string();
      warn(found.path.string() + " has no model.config: its model.sdf is used");
      return (found.path / "model.sdf").string();
    }
    return found.path.string();
  }

  void checkIncludes(const std::string& xml) const { resolver_.checkIncludes(xml, file_); }

  /// The world of a document; after a rejection, the world without its invalid parts.
  std::unique_ptr<Reading> readWhatCanBe(WorldDocument& document, const std::string& xml,
                                         const std::string& of, std::vector<LostInclude>& lost) {
    auto reading = reader_.read(withBuiltInModels(xml));
    if (reading->hasWorld()) return reading;
    const auto refusal = [&](const std::string& text) { return reader_.refusal(withBuiltInModels(text)); };
    const auto taken_out = document.takeOutRefused(refusal, rescue_tries_, lost);
    if (taken_out.empty() && lost.empty()) return reading;
    auto rest = reader_.read(withBuiltInModels(document.text()));
    if (!rest->hasWorld()) return reading;
    for (const auto& note : taken_out) warn(of + note);
    return rest;
  }

  /// A model's file, read and repaired by itself. Invariant: it holds a reading or a reason without one.
  struct ModelFile {
    fs::path path;
    std::unique_ptr<Reading> reading;  ///< of a world with a model or a light
    std::string reason;
    int visuals_lost = 0;
  };
  const ModelFile& modelFile(const std::string& uri) {
    fs::path path = findInclude(uri);
    std::error_code error;
    if (fs::is_directory(path, error)) path = sdf::getModelFilePath(path.string());
    const auto [known, is_new] = model_files_.try_emplace(path.string());
    if (is_new) readModelFile(path, known->second);
    return known->second;
  }
  void readModelFile(const fs::path& path, ModelFile& file) {
    file.path = path;
    const auto bytes = path.empty() ? std::nullopt : readFile(path, kMaxWorld_bytes);
    if (!bytes) {
      file.reason = "no such model";
      return;
    }
    const WorldText text = repairWorldText(*bytes);
    const std::string of = path.string() + ": ";
    std::optional<WorldDocument> document;
    try {
      document.emplace(text.xml, path.string());
    } catch (const ConfigError& problem) {
      file.reason = problem.what();
      return;
    }
    for (const auto& note : text.notes) warn(of + note);
    for (const auto& note : document->repair()) warn(of + note);
    document->wrapModel();
    std::vector<LostInclude> deeper;
    file.reading = readWhatCanBe(*document, document->text(), of, deeper);
    const sdf::World* world = file.reading->hasWorld() ? file.reading->root.WorldByIndex(0) : nullptr;
    if (world == nullptr || world->ModelCount() + world->LightCount() == 0) {
      file.reason = file.reading->complaints.empty() ? "it holds no model" : file.reading->complaints.front();
      file.reading.reset();
    }
    for (const auto& inner : deeper) warn(of + inner.description + " is left out");
    file.visuals_lost = document->visualsLost() + static_cast<int>(deeper.size());
  }

  /// Adds an included model of a world that libsdformat rejects.
  void addLost(const LostInclude& include) {
    const ModelFile& file = modelFile(include.uri);
    loaded_.visuals += file.visuals_lost;
    if (!file.reading) {
      ++loaded_.visuals;
      return warn(include.description + " is left out: " + file.reason);
    }
    const sdf::World& world = *file.reading->root.WorldByIndex(0);
    if (world.ModelCount() == 0) return addLight(*world.LightByIndex(0));
    const sdf::Model& model = *world.ModelByIndex(0);
    Pose3d pose;
    std::istringstream stream(include.pose);
    const bool placed = static_cast<bool>(stream >> pose);
    geometry_.readAs(file.path);
    addModel(model, include.name.empty() ? model.Name() : include.name,
             placed ? std::optional(toPose3(pose)) : std::nullopt);
    geometry_.readAs({});
  }

  void addModel(const sdf::Model& model) { addModel(model, model.Name(), std::nullopt); }
  /// @param placed instead of the model's own pose.
  void addModel(const sdf::Model& model, const std::string& name, const std::optional<Pose3>& placed) {
    WorldModel result;
    result.name = freeName(name);
    const auto pose = placed && isUsable(*placed) ? placed : poseOf(model, "model \"" + name + "\"");
    if (!pose) return countLost(model);
    result.pose = *pose;
    if (const auto moved = states_.find(name); moved != states_.end()) result.pose = moved->second;
    addParts(model, "", Pose3::Identity(), result);
    if (!result.bodies.empty() || !result.outlines.empty()) {
      loaded_.world.models.push_back(std::move(result));
    }
  }

  /// @param T_world_parent pose of its link; the light keeps its pose when the link's model moves.
  void addLight(const sdf::Light& light, const Pose3& T_world_parent = Pose3::Identity()) {
    if (loaded_.world.lights.size() >= kMaxLights) {
      warn("light \"" + light.Name() + "\": only the first " + std::to_string(kMaxLights) + " are simulated");
      return;
    }
    const auto pose = poseOf(light, "light \"" + light.Name() + "\"");
    if (!pose) return;
    const auto result = readLight(light, T_world_parent * *pose);
    if (!result) return warn("light \"" + light.Name() + "\" has a direction of no length: ignored");
    loaded_.world.lights.push_back(*result);
  }

  void setScene(const sdf::Scene& scene) {
    loaded_.world.ambient = lightColor(scene.Ambient());
    // libsdformat replaces a missing background by its own grey.
    const auto background = scene.Element() ? scene.Element()->FindElement("background") : nullptr;
    if (background && background->GetExplicitlySetInFile()) {
      loaded_.world.sky = lightColor(scene.Background()).cwiseMin(1.0f);
    }
  }

  /// A world saved by Gazebo has two poses of each model: the state is the displayed one.
  void readStates(const sdf::World& world) {
    const auto state = world.Element() ? world.Element()->FindElement("state") : nullptr;
    for (auto model = state ? state->FindElement("model") : nullptr; model;
         model = model->GetNextElement("model")) {
      if (!model->HasAttribute("name")) continue;
      if (model->HasElement("scale")) {
        const auto scale = model->Get<ignition::math::Vector3d>("scale");
        // Gazebo's versions differ in whether the model's own sizes include the scale.
        if (!scale.Equal(ignition::math::Vector3d::One, 1e-6)) {
          warn("the scale of model \"" + model->Get<std::string>("name") + "\" in <state> is not applied");
        }
      }
      if (!model->HasElement("pose")) continue;
      const Pose3 pose = toPose3(model->Get<Pose3d>("pose"));
      if (isUsable(pose)) states_[model->Get<std::string>("name")] = pose;
    }
  }

  void warnOfTheRest(const sdf::World& world) {
    for (const char* what : {"actor", "population", "road"}) {
      if (world.Element() && world.Element()->HasElement(what)) {
        warn(std::string("<") + what + "> is not simulated");
      }
    }
  }

  /// @param visuals_lost of the parts that were removed before the reading.
  LoadedWorld take(std::string name, int visuals_lost) {
    loaded_.world.name = std::move(name);
    loaded_.visuals += visuals_lost;
    if (loaded_.world.bodyCount() == 0) {
      std::string why;
      for (const auto& warning : loaded_.warnings) why += "\n" + warning;
      throw ConfigError({file_ + ": the world has nothing to show (no visual with triangles)" + why});
    }
    // A world without lights gets a default light.
    if (loaded_.world.lights.empty()) loaded_.world.lights.emplace_back();
    return std::move(loaded_);
  }

 private:
  static Pose3 toPose3(const Pose3d& pose) {
    Pose3 result = Pose3::Identity();
    const Eigen::Quaterniond q(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z());
    result.linear() = q.toRotationMatrix();
    result.translation() = Eigen::Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
    return result;
  }
  static bool isUsable(const Pose3& pose) {
    return pose.matrix().allFinite() && pose.translation().cwiseAbs().maxCoeff() <= kMaxPosition_m &&
           std::abs(pose.linear().determinant() - 1.0) < 1e-3;
  }
  /// The pose of a part in the frame of its parent; empty (with a warning) if it is invalid.
  template <typename Part>
  std::optional<Pose3> poseOf(const Part& part, const std::string& name) {
    Pose3d pose;
    if (!part.SemanticPose().Resolve(pose).empty()) pose = part.RawPose();
    const Pose3 result = toPose3(pose);
    if (isUsable(result)) return result;
    warn(name + " has a pose that is not finite or farther than 1000 km: left out");
    return std::nullopt;
  }
  /// Scenarios refer to models by their names, which must be unique.
  std::string freeName(const std::string& wanted) const {
    std::string name = wanted;
    for (int i = 1; loaded_.world.modelNamed(name); ++i) name = wanted + "_" + std::to_string(i);
    return name;
  }

  /// Links of a model and of the models nested in it.
  /// @param T_model_parts of its frame in the whole model.
  void addParts(const sdf::Model& model, const std::string& prefix, const Pose3& T_model_parts,
                WorldModel& out) {
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      const std::string name = prefix + link.Name();
      const auto pose = poseOf(link, "\"" + out.name + "/" + name + "\"");
      if (pose) {
        addLink(name, link, T_model_parts * *pose, out);
      } else {
        countLost(link);
      }
    }
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& nested = *model.ModelByIndex(i);
      const std::string name = prefix + nested.Name();
      const auto pose = poseOf(nested, "\"" + out.name + "/" + name + "\"");
      if (pose) {
        addParts(nested, name + "/", T_model_parts * *pose, out);
      } else {
        countLost(nested);
      }
    }
  }

  static bool isToBeSeen(const sdf::Visual& visual) {
    return visual.Transparency() < 1.0f && GeometryReader::isToBeSeen(visual.Geom());
  }
  void countLost(const sdf::Link& link) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
      if (isToBeSeen(*link.VisualByIndex(i))) ++loaded_.visuals;
    }
  }
  void countLost(const sdf::Model& model) {
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) countLost(*model.LinkByIndex(i));
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) countLost(*model.ModelByIndex(i));
  }

  void addLink(const std::string& name, const sdf::Link& link, const Pose3& T_model_link, WorldModel& out) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
      const sdf::Visual& visual = *link.VisualByIndex(i);
      if (!isToBeSeen(visual)) continue;
      ++loaded_.visuals;
      const std::string short_name = name + "/" + visual.Name();
      const std::string long_name = out.name + "/" + short_name;
      const auto pose = poseOf(visual, "\"" + long_name + "\"");
      auto shape = pose ? geometry_.read(long_name, visual.Geom()) : std::nullopt;
      if (!shape) continue;
      if (const sdf::Material* material = visual.Material())
        geometry_.apply(long_name, *material, shape->parts);
      const std::size_t bodies = out.bodies.size();
      for (auto& part : shape->parts) addBody(short_name, long_name, part, T_model_link * *pose, out);
      if (out.bodies.size() > bodies) ++loaded_.visuals_shown;
    }
    for (std::uint64_t i = 0; i < link.SensorCount(); ++i) {
      addCamera(name, *link.SensorByIndex(i), T_model_link, out);
    }
    for (std::uint64_t i = 0; i < link.LightCount(); ++i) {
      addLight(*link.LightByIndex(i), out.pose * T_model_link);
    }
    for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
      const sdf::Collision& collision = *link.CollisionByIndex(i);
      const std::string short_name = name + "/" + collision.Name();
      if (collision.Geom() != nullptr && collision.Geom()->Type() == sdf::GeometryType::PLANE) continue;
      const auto pose = poseOf(collision, "\"" + out.name + "/" + short_name + "\"");
      const auto shape = pose ? geometry_.read(out.name + "/" + short_name, collision.Geom()) : std::nullopt;
      if (shape) addOutlines(short_name, *shape, T_model_link * *pose, out);
    }
  }

  void addCamera(const std::string& link, const sdf::Sensor& sensor, const Pose3& T_model_link,
                 const WorldModel& model) {
    if (sensor.CameraSensor() == nullptr) return;
    const std::string name = model.name + "/" + link + "/" + sensor.Name();
    const auto pose = poseOf(sensor, "camera \"" + name + "\"");
    if (!pose) return;
    std::string problem;
    auto camera = readCamera(sensor, model.pose * T_model_link * *pose, problem);
    if (!camera) return warn("camera \"" + name + "\": " + problem + ": left out");
    camera->name = name;
    loaded_.world.cameras.push_back(std::move(*camera));
  }

  void addBody(const std::string& short_name, const std::string& long_name, MeshPart& part,
               const Pose3& T_model_shape, WorldModel& out) {
    transformMesh(part.mesh, Eigen::Affine3d(T_model_shape.matrix()));
    for (const auto& v : part.mesh.vertices) {
      if (v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxPosition_m) continue;
      warn("\"" + long_name + "\" has points that are not finite or farther than 1000 km: left out");
      return;
    }
    for (const auto& t : part.mesh.triangles) {
      if (t.maxCoeff() < part.mesh.vertices.size()) continue;
      warn("\"" + long_name + "\" has triangles without corners: left out");
      return;
    }
    if (part.mesh.triangles.empty()) return;
    WorldBody body;
    body.name = short_name + (part.name.empty() ? "" : "/" + part.name);
    body.color = part.color;
    body.emissive = part.emissive;
    body.texture = std::move(part.texture);
    body.vertices = std::move(part.mesh.vertices);
    body.uvs = std::move(part.mesh.uvs);
    body.normals = std::move(part.mesh.normals);
    body.triangles = std::move(part.mesh.triangles);
    if (!body.texture) body.uvs.clear();
    out.bodies.push_back(std::move(body));
  }

  static void addOutlines(const std::string& name, const GeometryReader::Shape& shape,
                          const Pose3& T_model_shape, WorldModel& out) {
    TriangleMesh whole;
    for (const auto& part : shape.parts) append(whole, part.mesh);
    // In the plan frame of the model as it stands, heights above the floor.
    const Pose3 T_plan_world = toPlan(out.pose).inverse();
    transformMesh(whole, Eigen::Affine3d((T_plan_world * out.pose * T_model_shape).matrix()));
    const double z = out.pose.translation().z();
    for (auto& outline : outlinesOf(whole, shape.solid, kRobotBodyBottom_m, kRobotBodyTop_m)) {
      outline.name = name;
      outline.low_m -= z;
      outline.high_m -= z;
      out.outlines.push_back(std::move(outline));
    }
  }
  static Pose3 toPlan(const Pose3& pose) { return vismem::toPose3(toPose2(pose)); }

  std::string file_;
  int rescue_tries_;
  UriResolver resolver_;
  SdfReader reader_;
  GeometryReader geometry_;
  LoadedWorld loaded_;
  std::set<std::string> warned_;
  std::map<std::string, Pose3> states_;
  std::map<std::string, ModelFile> model_files_;
};

/// @param notes earlier repairs of the text.
LoadedWorld build(WorldDocument& document, const std::string& xml, const std::string& file,
                  const std::vector<std::string>& notes, WorldBuilder& builder,
                  const LoadingProgress& progress) {
  builder.checkIncludes(xml);
  std::vector<LostInclude> lost;
  const auto reading = builder.readWhatCanBe(document, xml, "", lost);
  for (const auto& note : notes) builder.warn(note);
  if (!reading->hasWorld()) {
    std::string why = reading->root.Model() != nullptr ? "it holds a model, no <world>"
                      : reading->complaints.empty()    ? "no <world> element"
                                                       : "";
    for (std::size_t i = 0; i < std::min(reading->complaints.size(), kMaxReasons); ++i) {
      why += (i == 0 ? "" : "; ") + shown(reading->complaints[i], kShownReason);
    }
    std::vector<std::string> reasons;
    for (const auto& note : notes) reasons.push_back(file + ": " + note);
    reasons.push_back(file + ": not a world in SDF: " + why);
    throw ConfigError(std::move(reasons));
  }
  for (const auto& complaint : reading->complaints) {
    if (complaint != kNoWorld) builder.warn(complaint);
  }
  const sdf::World& world = *reading->root.WorldByIndex(0);
  if (world.Scene() != nullptr) builder.setScene(*world.Scene());
  builder.readStates(world);
  builder.warnOfTheRest(world);
  for (std::uint64_t i = 0; i < world.LightCount(); ++i) builder.addLight(*world.LightByIndex(i));
  const std::size_t models = world.ModelCount() + lost.size();
  std::size_t done = 0;
  const auto next = [&] {
    if (progress) progress(++done, models);
  };
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i, next()) builder.addModel(*world.ModelByIndex(i));
  for (const auto& include : lost) {
    builder.addLost(include);
    next();
  }
  return builder.take(world.Name(), document.visualsLost());
}

/// @throws ConfigError for bytes that are no text.
WorldText repairedText(const std::string& bytes, const std::string& file) {
  WorldText text = repairWorldText(bytes);
  if (text.xml.empty() && !text.notes.empty()) throw ConfigError({file + ": " + text.notes.front()});
  return text;
}

/// The world of a repaired text.
LoadedWorld buildFrom(const WorldText& text, const std::string& file, WorldBuilder& builder,
                      const LoadingProgress& progress = {}) {
  WorldDocument document(text.xml, file);
  std::vector<std::string> notes = text.notes;
  const auto repaired = document.repair();
  notes.insert(notes.end(), repaired.begin(), repaired.end());
  return build(document, document.text(), file, notes, builder, progress);
}

}  // namespace

LoadedWorld loadWorld(const fs::path& file, const std::vector<fs::path>& model_paths,
                      const LoadingProgress& progress) {
  const std::string bytes = readTextFile(file, "a world in SDF");
  std::vector<fs::path> search = model_paths;
  search.push_back(file.parent_path());
  WorldBuilder builder(file.string(), search);
  return buildFrom(repairedText(bytes, file.string()), file.string(), builder, progress);
}

LoadedWorld parseWorld(const std::string& bytes, const std::string& file, const std::vector<fs::path>& search,
                       int rescue_tries) {
  WorldBuilder builder(file, search, rescue_tries);
  return buildFrom(repairedText(bytes, file), file, builder);
}

}  // namespace vismem
