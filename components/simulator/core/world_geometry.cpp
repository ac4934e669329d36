#include "simulator/core/world_geometry.h"

#include <algorithm>
#include <cmath>
#include <sdf/sdf.hh>
#include <sstream>
#include <system_error>

namespace vismem {
namespace fs = std::filesystem;
namespace {

/// Size of the mesh of an SDF plane, which is infinite [m].
constexpr double kGroundPlaneSize_m = 200.0;
constexpr double kMaxLength_m = 1e5;
constexpr std::size_t kMaxScript_bytes = 4u << 20;
/// Larger height maps are subsampled: terrain for wheels needs no finer resolution.
constexpr int kMaxHeights = 513;

Eigen::Vector3f toVector(const ignition::math::Color& c) {
  const Eigen::Vector3f color(c.R(), c.G(), c.B());
  return color.allFinite() ? color.cwiseMax(0.0f).cwiseMin(1.0f).eval() : Eigen::Vector3f(0.7f, 0.7f, 0.7f);
}

}  // namespace

bool GeometryReader::usable(const std::string& name, const std::string& what,
                            std::initializer_list<double> lengths) {
  for (const double length : lengths) {
    if (length > 0.0 && length <= kMaxLength_m) continue;  // false for NaN, too
    warn_("\"" + name + "\": " + what + " of " + std::to_string(length) +
          " m (must be above 0, at most 100 km)");
    return false;
  }
  return true;
}

fs::path GeometryReader::fileOf(const std::string& named_in) const {
  return file_.empty() ? fs::path(named_in) : file_;
}

fs::path GeometryReader::resolve(const std::string& uri, const std::string& named_in) {
  const auto found = resolver_.find(uri, fileOf(named_in));
  if (!found.note.empty()) warn_(found.note);
  return found.path;
}

bool GeometryReader::isToBeSeen(const sdf::Geometry* geometry) {
  if (geometry == nullptr) return false;
  if (geometry->Type() != sdf::GeometryType::EMPTY) return true;
  const auto shape = geometry->Element() ? geometry->Element()->GetFirstElement() : nullptr;
  return shape && shape->GetName() != "empty";
}

std::optional<GeometryReader::Shape> GeometryReader::read(const std::string& name,
                                                          const sdf::Geometry* geometry) {
  if (!isToBeSeen(geometry)) return std::nullopt;
  const auto plain = [](TriangleMesh mesh, bool solid = true) {
    Shape shape;
    shape.parts.emplace_back().mesh = std::move(mesh);
    shape.solid = solid;
    return shape;
  };
  switch (geometry->Type()) {
    case sdf::GeometryType::BOX: {
      const auto size = geometry->BoxShape()->Size();
      if (!usable(name, "a box", {size.X(), size.Y(), size.Z()})) return std::nullopt;
      return plain(boxMesh({size.X(), size.Y(), size.Z()}));
    }
    case sdf::GeometryType::PLANE: {
      auto size = geometry->PlaneShape()->Size();
      if (!(size.X() > 0 && size.Y() > 0)) size.Set(kGroundPlaneSize_m, kGroundPlaneSize_m);
      if (!usable(name, "a plane", {size.X(), size.Y()})) return std::nullopt;
      auto mesh = planeMesh({size.X(), size.Y()});
      const auto n = geometry->PlaneShape()->Normal();
      const Eigen::Vector3d normal(n.X(), n.Y(), n.Z());
      if (normal.allFinite() && normal.norm() > 1e-9) {
        transformMesh(mesh,
                      Eigen::Affine3d(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal)));
      }
      return plain(std::move(mesh));
    }
    case sdf::GeometryType::CYLINDER: {
      const auto& shape = *geometry->CylinderShape();
      if (!usable(name, "a cylinder", {shape.Radius(), shape.Length()})) return std::nullopt;
      return plain(cylinderMesh(shape.Radius(), shape.Length()));
    }
    case sdf::GeometryType::CAPSULE: {
      const auto& shape = *geometry->CapsuleShape();
      if (!usable(name, "a capsule", {shape.Radius(), shape.Length()})) return std::nullopt;
      return plain(capsuleMesh(shape.Radius(), shape.Length()));
    }
    case sdf::GeometryType::SPHERE: {
      if (!usable(name, "a sphere", {geometry->SphereShape()->Radius()})) return std::nullopt;
      return plain(sphereMesh(geometry->SphereShape()->Radius()));
    }
    case sdf::GeometryType::ELLIPSOID: {
      const auto radii = geometry->EllipsoidShape()->Radii();
      if (!usable(name, "an ellipsoid", {radii.X(), radii.Y(), radii.Z()})) return std::nullopt;
      return plain(ellipsoidMesh({radii.X(), radii.Y(), radii.Z()}));
    }
    case sdf::GeometryType::MESH:
      return readMesh(name, *geometry->MeshShape());
    case sdf::GeometryType::HEIGHTMAP:
      return readHeightmap(name, *geometry->HeightmapShape());
    default:
      break;
  }
  // libsdformat 12 has no class for polylines, but it keeps the element.
  if (geometry->Element() && geometry->Element()->HasElement("polyline")) {
    auto mesh = readPolylines(name, geometry->Element());
    if (!mesh) return std::nullopt;
    return plain(std::move(*mesh), false);
  }
  // Nor for cones, which came with SDF 1.11.
  if (geometry->Element() && geometry->Element()->HasElement("cone")) {
    const auto cone = geometry->Element()->GetElement("cone");
    const auto length = [&](const char* what, double otherwise) {
      const auto text = cone->FindElement(what);
      const auto value = text && text->GetValue() ? text->GetValue()->GetAsString() : "";
      double result = otherwise;
      if (!value.empty()) std::istringstream(value) >> result;
      return result;
    };
    const double radius = length("radius", 0.5);
    const double height = length("length", 1.0);
    if (!usable(name, "a cone", {radius, height})) return std::nullopt;
    return plain(coneMesh(radius, height));
  }
  const auto shape = geometry->Element() ? geometry->Element()->GetFirstElement() : nullptr;
  warn_("\"" + name + "\": <" + (shape ? shape->GetName() : "geometry") +
        "> is not simulated (box, plane, cylinder, capsule, cone, sphere, ellipsoid, polyline, heightmap, "
        "mesh are)");
  return std::nullopt;
}

std::optional<TriangleMesh> GeometryReader::readPolylines(const std::string& name,
                                                          const sdf::ElementPtr& geometry) {
  TriangleMesh whole;
  for (auto e = geometry->GetElement("polyline"); e; e = e->GetNextElement("polyline")) {
    std::vector<Eigen::Vector2d> outline;
    bool finite = true;
    for (auto p = e->FindElement("point"); p; p = p->GetNextElement("point")) {
      const auto point = p->Get<ignition::math::Vector2d>();
      outline.emplace_back(point.X(), point.Y());
      finite = finite && outline.back().allFinite() && outline.back().norm() <= kMaxLength_m;
    }
    const double height = e->Get<double>("height");
    if (!usable(name, "a polyline's height", {height})) continue;
    const TriangleMesh part = finite ? prismMesh(std::move(outline), height) : TriangleMesh();
    if (part.triangles.empty()) {
      warn_("\"" + name +
            "\": a polyline that has no area, crosses itself or has points that are not finite: left out");
    }
    append(whole, part);
  }
  if (whole.triangles.empty()) return std::nullopt;
  return whole;
}

std::optional<GeometryReader::Shape> GeometryReader::readMesh(const std::string& name,
                                                              const sdf::Mesh& mesh) {
  const fs::path path = resolve(mesh.Uri(), mesh.FilePath());
  if (path.empty()) {
    warn_("\"" + name + "\": mesh " + mesh.Uri() + " not found");
    return std::nullopt;
  }
  const std::string key = path.string() + "\n" + mesh.Submesh() + (mesh.CenterSubmesh() ? "\n1" : "\n0");
  auto known = meshes_.find(key);
  if (known == meshes_.end()) {
    std::optional<MeshFile> file;
    try {
      file = loadMeshFile(path, mesh.Submesh(), mesh.CenterSubmesh());
      for (const auto& note : file->notes) warn_("\"" + name + "\": " + note);
    } catch (const std::exception& error) {
      warn_("\"" + name + "\": mesh " + error.what());
    }
    known = meshes_.emplace(key, std::move(file)).first;
  }
  if (!known->second) return std::nullopt;
  const auto s = mesh.Scale();
  const Eigen::Vector3d scale(s.X(), s.Y(), s.Z());
  if (!scale.allFinite() || scale.cwiseAbs().minCoeff() <= 0.0 ||
      scale.cwiseAbs().maxCoeff() > kMaxLength_m) {
    warn_("\"" + name + "\": a mesh scale that is zero, too large or not finite: left out");
    return std::nullopt;
  }
  Shape shape{known->second->parts, false};
  for (auto& part : shape.parts) transformMesh(part.mesh, Eigen::Affine3d(Eigen::Scaling(scale)));
  return shape;
}

std::optional<GeometryReader::Shape> GeometryReader::readHeightmap(const std::string& name,
                                                                   const sdf::Heightmap& heightmap) {
  const fs::path path = resolve(heightmap.Uri(), heightmap.FilePath());
  const auto size = heightmap.Size();
  if (path.empty()) {
    warn_("\"" + name + "\": heightmap " + heightmap.Uri() + " not found");
    return std::nullopt;
  }
  if (!usable(name, "a heightmap", {size.X(), size.Y(), size.Z()})) return std::nullopt;
  const auto picture = texture(name, path);
  if (!picture) return std::nullopt;
  if (picture->width < 2 || picture->height < 2) {
    warn_("\"" + name + "\": heightmap " + path.string() + " is smaller than 2 x 2 pixels");
    return std::nullopt;
  }
  const int columns = std::min(picture->width, kMaxHeights);
  const int rows = std::min(picture->height, kMaxHeights);
  std::vector<float> heights;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = column * (picture->width - 1) / (columns - 1);
      const int y = row * (picture->height - 1) / (rows - 1);
      const std::uint8_t* p = &picture->rgb[3 * (static_cast<std::size_t>(y) * picture->width + x)];
      heights.push_back(static_cast<float>(size.Z() * (p[0] + p[1] + p[2]) / (3.0 * 255.0)));
    }
  }
  Shape shape;
  shape.solid = false;
  MeshPart part;
  part.mesh = heightmapMesh({size.X(), size.Y()}, columns, rows, heights);
  const auto offset = heightmap.Position();
  const Eigen::Vector3d position(offset.X(), offset.Y(), offset.Z());
  if (position.allFinite()) transformMesh(part.mesh, Eigen::Affine3d(Eigen::Translation3d(position)));
  if (const sdf::HeightmapTexture* look = heightmap.TextureByIndex(0)) {
    const fs::path file = resolve(look->Diffuse(), heightmap.FilePath());
    if (file.empty()) {
      warn_("\"" + name + "\": texture " + look->Diffuse() + " of the heightmap not found");
    } else if ((part.texture = texture(name, file)) != nullptr && look->Size() > 0.0) {
      part.color.setOnes();
      const auto repeat = static_cast<float>(1.0 / look->Size());
      for (auto& uv : part.mesh.uvs) {
        uv = uv.cwiseProduct(Eigen::Vector2d(size.X(), size.Y()).cast<float>()) * repeat;
      }
    }
  }
  shape.parts.push_back(std::move(part));
  return shape;
}

std::shared_ptr<const Texture> GeometryReader::texture(const std::string& name, const fs::path& file) {
  const auto known = textures_.find(file.string());
  if (known != textures_.end()) return known->second;
  std::shared_ptr<const Texture> result;
  try {
    result = loadTexture(file);
  } catch (const std::exception& error) {
    warn_("\"" + name + "\": texture " + error.what());
  }
  textures_.emplace(file.string(), result);
  return result;
}

std::optional<OgreMaterial> GeometryReader::script(const std::string& name, const sdf::Material& material) {
  const std::string wanted = material.ScriptName();
  if (wanted.empty()) return std::nullopt;
  std::vector<fs::path> folders;
  const auto element = material.Element() ? material.Element()->FindElement("script") : nullptr;
  for (auto uri = element ? element->FindElement("uri") : nullptr; uri; uri = uri->GetNextElement("uri")) {
    const auto path = resolver_.find(uri->Get<std::string>(), fileOf(material.FilePath())).path;
    if (!path.empty()) folders.push_back(path);
  }
  for (const fs::path& path : folders) {
    std::vector<fs::path> files{path};
    std::error_code error;
    if (fs::is_directory(path, error)) {
      files.clear();
      for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
        if (it->path().extension() == ".material") files.push_back(it->path());
      }
      std::sort(files.begin(), files.end());
    }
    for (const fs::path& file : files) {
      auto known = scripts_.find(file.string());
      if (known == scripts_.end()) {
        const auto text = readFile(file, kMaxScript_bytes);
        known = scripts_.emplace(file.string(), parseOgreScript(text.value_or(""))).first;
      }
      const auto found = known->second.find(wanted);
      if (found == known->second.end()) continue;
      OgreMaterial result = found->second;
      if (result.texture.empty()) return result;
      // OGRE searches all named folders by the image's name alone.
      folders.push_back(file.parent_path());
      folders.push_back(file.parent_path() / "../textures");
      const fs::path base = fs::path(result.texture).filename();
      for (const fs::path& folder : folders) {
        if (!fs::is_regular_file(folder / base, error)) continue;
        result.texture = (folder / base).string();
        return result;
      }
      warn_("\"" + name + "\": texture " + result.texture + " of material " + wanted + " not found");
      result.texture.clear();
      return result;
    }
  }
  if (const auto known = gazeboMaterial(wanted)) return known;
  warn_("\"" + name + "\": material " + wanted + " not found");
  return std::nullopt;
}

void GeometryReader::apply(const std::string& name, const sdf::Material& material,
                           std::vector<MeshPart>& parts) {
  const auto says = [&](const char* what) {
    return material.Element() && material.Element()->HasElement(what);
  };
  std::optional<Eigen::Vector3f> color;
  std::optional<Eigen::Vector3f> emissive;
  std::shared_ptr<const Texture> look;
  if (says("diffuse")) {
    color = toVector(material.Diffuse());
  } else if (says("ambient")) {
    color = toVector(material.Ambient());
  }
  if (says("emissive")) emissive = toVector(material.Emissive());
  if (const auto ogre = script(name, material)) {
    color = ogre->diffuse;
    emissive = ogre->emissive;
    if (!ogre->texture.empty()) look = texture(name, ogre->texture);
  }
  if (const sdf::Pbr* pbr = material.PbrMaterial()) {
    for (const auto type : {sdf::PbrWorkflowType::METAL, sdf::PbrWorkflowType::SPECULAR}) {
      const sdf::PbrWorkflow* workflow = pbr->Workflow(type);
      if (workflow == nullptr || workflow->AlbedoMap().empty() || look) continue;
      const fs::path file = resolve(workflow->AlbedoMap(), material.FilePath());
      if (file.empty()) {
        warn_("\"" + name + "\": albedo map " + workflow->AlbedoMap() + " not found");
      } else {
        look = texture(name, file);
      }
    }
  }
  for (auto& part : parts) {
    if (color) {
      part.color = *color;
      part.texture = nullptr;
    }
    if (emissive) part.emissive = *emissive;
    if (look && part.mesh.uvs.empty()) {
      warn_("\"" + name + "\" has no texture coordinates: its texture is left out");
    } else if (look) {
      part.texture = look;
      if (!color) part.color.setOnes();
    }
  }
}

}  // namespace vismem
