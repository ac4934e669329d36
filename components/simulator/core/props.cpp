#include "simulator/core/props.h"

#include <algorithm>
#include <sstream>

#include "simulator/core/shapes.h"

namespace vismem {
namespace {

constexpr double kMaxSize_m = 50.0;

void addPart(WorldModel& model, const std::string& name, TriangleMesh mesh, double lift_m,
             const Eigen::Vector3f& color) {
  WorldBody body;
  body.name = "link/" + name;
  body.color = color;
  ModelOutline obstacle;
  obstacle.name = "link/" + name;
  obstacle.low_m = 1e9;
  obstacle.high_m = -1e9;
  std::vector<Eigen::Vector2d> points;
  for (auto& vertex : mesh.vertices) {
    vertex.z() += static_cast<float>(lift_m);
    points.emplace_back(vertex.head<2>().cast<double>());
    obstacle.low_m = std::min<double>(obstacle.low_m, vertex.z());
    obstacle.high_m = std::max<double>(obstacle.high_m, vertex.z());
  }
  obstacle.outline = convexHull(std::move(points));
  body.vertices = std::move(mesh.vertices);
  body.triangles = std::move(mesh.triangles);
  model.bodies.push_back(std::move(body));
  model.outlines.push_back(std::move(obstacle));
}

}  // namespace

std::string checkProp(const PropShape& shape) {
  const auto good = [](double v) { return v > 0.0 && v <= kMaxSize_m; };
  if (!good(shape.size_m.x()) || !good(shape.size_m.y()) || !good(shape.size_m.z())) {
    std::ostringstream text;
    text << "size " << shape.size_m.transpose() << " m (each must be above 0, at most " << kMaxSize_m << ")";
    return text.str();
  }
  if (!(shape.color.minCoeff() >= 0.0 && shape.color.maxCoeff() <= 1.0)) {
    std::ostringstream text;
    text << "color " << shape.color.transpose() << " (R, G and B must be 0..1)";
    return text.str();
  }
  return {};
}

WorldModel makeProp(const std::string& name, const PropShape& shape, const Pose3& T_world_model) {
  WorldModel model;
  model.name = name;
  model.pose = T_world_model;
  const Eigen::Vector3d size = shape.size_m;
  const Eigen::Vector3f color = shape.color.cast<float>();
  switch (shape.kind) {
    case PropShape::Kind::kBox:
      addPart(model, "box", boxMesh(size), 0.5 * size.z(), color);
      break;
    case PropShape::Kind::kCylinder:
      addPart(model, "cylinder", cylinderMesh(0.5 * size.x(), size.z()), 0.5 * size.z(), color);
      break;
    case PropShape::Kind::kRobot: {
      const double base = std::min(0.25, 0.5 * size.z());
      addPart(model, "base", cylinderMesh(0.5 * size.x(), base), 0.5 * base, color);
      const Eigen::Vector3d pillar(0.7 * size.x(), 0.7 * size.y(), size.z() - base);
      addPart(model, "pillar", boxMesh(pillar), base + 0.5 * pillar.z(), 0.6f * color);
      break;
    }
  }
  return model;
}

}  // namespace vismem
