#include "evaluation/core/shape_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"

namespace vismem {
namespace {

constexpr const char* kHeader =
    "kind,name,on,width_m,outer_radius_m,inner_radius_m,x1_m,y1_m,x2_m,y2_m,x3_m,y3_m,x4_m,y4_m";
constexpr std::size_t kFields = 14;
constexpr std::size_t kFirstPoint = 6;

/// Both ends of the middle line of a long parallelogram.
std::vector<Eigen::Vector2d> middleLine(const std::vector<Eigen::Vector2d>& v) {
  const bool first_is_long = (v[1] - v[0]).norm() > (v[2] - v[1]).norm();
  if (first_is_long) return {0.5 * (v[0] + v[3]), 0.5 * (v[1] + v[2])};
  return {0.5 * (v[0] + v[1]), 0.5 * (v[2] + v[3])};
}

/// Reads one row.
/// @return what is wrong with it; empty: nothing.
std::string readShape(const std::vector<std::string_view>& cells, TrueShape& shape) {
  if (cells.size() != kFields) {
    return std::to_string(cells.size()) + " fields (expected " + std::to_string(kFields) + ")";
  }
  const std::vector<std::string> fields(cells.begin(), cells.end());
  static const std::vector<std::pair<std::string, std::pair<PrimitiveKind, std::size_t>>> kinds{
      {"parallelogram", {PrimitiveKind::kParallelogram, 4}},
      {"triangle", {PrimitiveKind::kTriangle, 3}},
      {"arrow", {PrimitiveKind::kArrow, 4}},
      {"circle", {PrimitiveKind::kCircle, 1}}};
  const auto kind =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == fields[0]; });
  if (kind == kinds.end()) {
    return "kind \"" + fields[0] + "\" (expected parallelogram, triangle, arrow or circle)";
  }
  shape.kind = kind->second.first;
  shape.name = fields[1];
  shape.painted = fields[2] != "box";
  for (std::size_t i = 0; i < kind->second.second; ++i) {
    const auto x = finiteNumber(fields[kFirstPoint + 2 * i]);
    const auto y = finiteNumber(fields[kFirstPoint + 2 * i + 1]);
    if (!x || !y) return "point " + std::to_string(i + 1) + " of a " + fields[0] + " (expected two numbers)";
    shape.vertices.emplace_back(*x, *y);
  }
  if (shape.kind == PrimitiveKind::kCircle) {
    const auto outer = finiteNumber(fields[4]);
    shape.inner_radius_m = finiteNumber(fields[5]).value_or(0.0);
    if (!outer || *outer <= 0.0 || shape.inner_radius_m < 0.0 || shape.inner_radius_m >= *outer) {
      return "radii \"" + fields[4] + "\" and \"" + fields[5] + "\" (expected outer > inner >= 0)";
    }
    shape.outer_radius_m = *outer;
    shape.centre = shape.vertices.front();
    shape.vertices.clear();
    return {};
  }
  shape.width_m = finiteNumber(fields[3]).value_or(0.0);
  // The file has the tail first, Primitive the tip.
  if (shape.kind == PrimitiveKind::kArrow) std::swap(shape.vertices[0], shape.vertices[1]);
  if (fields[2] == "stripe") {
    shape.kind = PrimitiveKind::kStripe;
    shape.vertices = middleLine(shape.vertices);
  }
  for (const auto& v : shape.vertices) shape.centre += v / static_cast<double>(shape.vertices.size());
  return {};
}

/// The mean error of the corners in the best order, or nothing where one is too far off.
std::optional<double> cornerError(const Primitive& p, std::size_t index, const ShapeTruth& truth,
                                  const ShapeScoreParams& params) {
  const TrueShape& shape = truth.shapes()[index];
  const std::size_t n = shape.vertices.size();
  if (p.vertices.size() != n) return std::nullopt;
  const bool any_order = p.kind != PrimitiveKind::kArrow;
  std::optional<double> best;
  for (std::size_t shift = 0; shift < (any_order ? n : 1); ++shift) {
    for (const bool reversed : {false, true}) {
      if (reversed && !any_order) continue;
      double sum = 0.0;
      bool all = true;
      for (std::size_t i = 0; i < n && all; ++i) {
        const std::size_t j = reversed ? (shift + n - i) % n : (shift + i) % n;
        const double d = (p.vertices[i] - shape.vertices[j]).norm();
        all = d <= params.corner_m + truth.footprint(index, shape.vertices[j], params.focal_px);
        sum += d;
      }
      if (all && (!best || sum / n < *best)) best = sum / static_cast<double>(n);
    }
  }
  return best;
}

std::optional<double> circleError(const Primitive& p, std::size_t index, const ShapeTruth& truth,
                                  const ShapeScoreParams& params) {
  const TrueShape& shape = truth.shapes()[index];
  const double off = (p.centre - shape.centre).norm();
  const double inner = shape.inner_radius_m > 0.0 ? shape.inner_radius_m : shape.outer_radius_m;
  const bool fits = off <= params.corner_m + truth.footprint(index, shape.centre, params.focal_px) &&
                    p.radius_m >= inner - params.radius_m &&
                    p.radius_m <= shape.outer_radius_m + params.radius_m;
  if (!fits) return std::nullopt;
  return off;
}

}  // namespace

std::vector<TrueShape> parseTrueShapes(std::string_view text, const std::string& file_name) {
  std::vector<TrueShape> shapes;
  std::vector<std::string> problems;
  bool header = false;
  int row = 0;
  for (const std::string_view part : splitAt(text, '\n')) {
    ++row;
    const std::string line(trimmed(part));
    if (line.empty() || line.front() == '#') continue;
    const std::string where = file_name + ":" + std::to_string(row) + ": ";
    if (!header) {
      if (line != kHeader) throw ConfigError({where + "\"" + line + "\" (expected " + kHeader + ")"});
      header = true;
      continue;
    }
    TrueShape shape;
    const std::string problem = readShape(splitAt(line, ','), shape);
    if (problem.empty()) {
      shapes.push_back(std::move(shape));
    } else {
      problems.push_back(where + problem);
    }
  }
  if (problems.empty() && shapes.empty())
    problems.push_back(file_name + ": no shapes (expected at least one)");
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return shapes;
}

std::vector<Segment2> outlineOf(const TrueShape& shape) {
  std::vector<Segment2> outline;
  const auto& v = shape.vertices;
  switch (shape.kind) {
    case PrimitiveKind::kCircle: {
      constexpr int kPieces = 36;
      const auto at = [&](int i) {
        const double angle = 2.0 * std::numbers::pi * (i % kPieces) / kPieces;
        return Eigen::Vector2d(shape.centre +
                               shape.outer_radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      };
      for (int i = 0; i < kPieces; ++i) outline.push_back({at(i), at(i + 1)});
      break;
    }
    case PrimitiveKind::kArrow:
      outline = {{v[0], v[1]}, {v[0], v[2]}, {v[0], v[3]}};
      break;
    case PrimitiveKind::kStripe:
      outline = {{v[0], v[1]}};
      break;
    case PrimitiveKind::kParallelogram:
    case PrimitiveKind::kTriangle:
      for (std::size_t i = 0; i < v.size(); ++i) outline.push_back({v[i], v[(i + 1) % v.size()]});
      break;
  }
  return outline;
}

ShapeTruth::ShapeTruth(std::vector<TrueShape> shapes) : shapes_(std::move(shapes)) {
  for (const TrueShape& shape : shapes_) {
    SegmentMap map;
    for (const Segment2& side : outlineOf(shape)) {
      map.segments.push_back(
          {{{side.a.x(), side.a.y(), 0.0}, {side.b.x(), side.b.y(), 0.0}}, shape.name, 0.0});
    }
    FloorTruthParams params;
    params.curve_piece_m = 0.0;  // every side for itself
    outlines_.emplace_back(map, params);
  }
}

void ShapeTruth::addView(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera,
                         const SeesFloor& sees) {
  for (FloorTruth& outline : outlines_) outline.addView(intrinsics, T_world_camera, sees, 1.0);
}

double ShapeTruth::seenShare(std::size_t shape) const {
  double seen = 0.0;
  double all = 0.0;
  for (const TrueEdge& side : outlines_.at(shape).edges()) {
    const auto count = std::count_if(side.samples.begin(), side.samples.end(),
                                     [](const auto& sample) { return sample.seen; });
    seen += side.length_m * static_cast<double>(count) / static_cast<double>(side.samples.size());
    all += side.length_m;
  }
  return all > 0.0 ? seen / all : 0.0;
}

bool ShapeTruth::seenCorner(std::size_t shape, std::size_t corner) const {
  const Eigen::Vector2d p = shapes_.at(shape).vertices.at(corner);
  for (const TrueEdge& side : outlines_.at(shape).edges()) {
    for (const auto& sample : {side.samples.front(), side.samples.back()}) {
      if (sample.seen && (sample.p - p).norm() < 1e-6) return true;
    }
  }
  return false;
}

double ShapeTruth::footprint(std::size_t shape, const Eigen::Vector2d& corner, double focal_px) const {
  double nearest = std::numeric_limits<double>::max();
  double footprint = 0.0;
  for (const TrueEdge& side : outlines_.at(shape).edges()) {
    for (const auto& sample : side.samples) {
      const double d = (sample.p - corner).norm();
      if (!sample.seen || d >= nearest) continue;
      nearest = d;
      footprint = floorFootprint(sample, focal_px);
    }
  }
  return footprint;
}

std::vector<JudgedShape> judgeShapes(const std::vector<Primitive>& world, const ShapeTruth& truth,
                                     const ShapeScoreParams& params) {
  struct Pair {
    double error;
    std::size_t primitive;
    std::size_t shape;
  };
  std::vector<JudgedShape> judged;
  std::vector<Pair> pairs;
  for (const Primitive& primitive : world) {
    for (std::size_t i = 0; i < truth.shapes().size(); ++i) {
      if (truth.shapes()[i].kind != primitive.kind) continue;
      const auto error = primitive.kind == PrimitiveKind::kCircle ? circleError(primitive, i, truth, params)
                                                                  : cornerError(primitive, i, truth, params);
      if (error) pairs.push_back({*error, judged.size(), i});
    }
    judged.push_back({primitive, -1, 0.0});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.error < b.error; });
  std::vector<bool> taken(truth.shapes().size(), false);
  for (const Pair& pair : pairs) {
    if (taken[pair.shape] || judged[pair.primitive].true_shape >= 0) continue;
    taken[pair.shape] = true;
    judged[pair.primitive].true_shape = static_cast<int>(pair.shape);
    judged[pair.primitive].error_m = pair.error;
  }
  return judged;
}

std::vector<Primitive> shapesIn(const MemorySnapshot& memory, const Pose2& T_world_robot) {
  const Pose2 T_world_odom = T_world_robot * inverse(memory.T_odom_robot);
  std::vector<Primitive> shapes = memory.primitives;
  for (Primitive& shape : shapes) {
    for (auto& v : shape.vertices) v = transform(T_world_odom, v);
    shape.centre = transform(T_world_odom, shape.centre);
    shape.heading_rad += T_world_odom.theta;
  }
  return shapes;
}

const char* nameOf(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kStripe:
      return "stripe";
    case PrimitiveKind::kParallelogram:
      return "parallelogram";
    case PrimitiveKind::kTriangle:
      return "triangle";
    case PrimitiveKind::kArrow:
      return "arrow";
    case PrimitiveKind::kCircle:
      return "circle";
  }
  return "";
}

}  // namespace vismem
