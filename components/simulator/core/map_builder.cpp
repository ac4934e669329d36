#include "simulator/core/map_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "simulator/core/body_creases.h"
#include "simulator/core/map_builder_stripes.h"
#include "simulator/core/map_pieces.h"
#include "simulator/core/renderer.h"

namespace vismem {
namespace {

constexpr double kOnFloor_m = 0.005;
/// Growth of a segment by the rounding of its ends to millimetres [m].
constexpr double kRounding_m = 0.002;
/// Maximum depth difference between the edge and the visible surface at it [m].
constexpr double kDepthTolerance_m = 0.015;
constexpr int kEyeAzimuths = 12;
constexpr std::array<double, 2> kEyeRanges_m{0.4, 0.9};
constexpr int kBisections = 8;
/// Minimum sine of the angle between view ray and edge: views along the edge would sample its sides far from
/// the requested place.
constexpr double kMinAcross = 0.7;

/// A crease between two faces of a body, or the border of a face.
struct Crease {
  int model = 0;
  int body = 0;
  Segment3 line;
};

std::vector<Crease> findCreases(const World& world, double min_angle_rad) {
  std::vector<Crease> creases;
  for (std::size_t m = 0; m < world.models.size(); ++m) {
    const WorldModel& model = world.models[m];
    for (std::size_t b = 0; b < model.bodies.size(); ++b) {
      for (const Segment3& line : creasesOf(model.bodies[b], model.pose, min_angle_rad)) {
        creases.push_back({static_cast<int>(m), static_cast<int>(b), line});
      }
    }
  }
  return creases;
}

class EdgeLooker {
 public:
  EdgeLooker(const World& world, const Palette& palette, const MapBuilderParams& params)
      : params_(params), palette_(palette), renderer_(world) {}

  /// The most frequent label of all views of a place on a crease; empty without a named pair.
  std::optional<Label> labelAt(const Crease& crease, double fraction) const {
    const Eigen::Vector3d p = crease.line.a + fraction * (crease.line.b - crease.line.a);
    const Eigen::Vector3d along = (crease.line.b - crease.line.a).normalized();
    std::map<Label, int> votes;
    // From the camera's height, and from the height of places above it.
    std::vector<double> heights{params_.eye_height_m};
    if (p.z() > params_.eye_height_m) heights.push_back(p.z());
    for (const double height : heights) {
      for (const double range : kEyeRanges_m) {
        for (int i = 0; i < kEyeAzimuths; ++i) {
          // Off the axes, so that no view lies along a wall.
          const double azimuth = 2.0 * std::numbers::pi * (i + 0.37) / kEyeAzimuths;
          const Eigen::Vector3d eye(p.x() + range * std::cos(azimuth), p.y() + range * std::sin(azimuth),
                                    height);
          if (const auto label = seenFrom(eye, crease, p, along)) ++votes[*label];
        }
      }
    }
    const auto best = std::max_element(votes.begin(), votes.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (best == votes.end()) return std::nullopt;
    return best->first;
  }

 private:
  std::optional<Label> seenFrom(const Eigen::Vector3d& eye, const Crease& crease, const Eigen::Vector3d& p,
                                const Eigen::Vector3d& along) const {
    const Eigen::Vector3d across = along.cross((p - eye).normalized());
    if (across.norm() < kMinAcross) return std::nullopt;
    const Eigen::Vector3d beside = params_.side_m * across.normalized();
    const double depth = (p - eye).norm();
    std::array<ColorClass, 2> classes{};
    double nearest = 1e9;
    bool own_body = false;
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d target = side == 0 ? Eigen::Vector3d(p + beside) : Eigen::Vector3d(p - beside);
      const auto hit = renderer_.cast(eye, target - eye);
      if (!hit || hit->from_inside) return std::nullopt;
      const Eigen::Vector3d met = eye + hit->distance_m * (target - eye).normalized();
      if ((met - p).norm() > params_.contact_m) return std::nullopt;
      nearest = std::min(nearest, std::abs(hit->distance_m - depth));
      own_body = own_body || (hit->model == crease.model && hit->body == crease.body);
      const auto byte = [&](int c) {
        return static_cast<std::uint8_t>(std::clamp(255.0f * hit->color[c] + 0.5f, 0.0f, 255.0f));
      };
      classes[side] = palette_.classOf(byte(0), byte(1), byte(2));
    }
    if (!own_body || nearest > kDepthTolerance_m) return std::nullopt;
    const Label& label = palette_.label(classes[0], classes[1]);
    if (label == kUnknownLabel) return std::nullopt;
    return label;
  }

  MapBuilderParams params_;
  const Palette& palette_;
  Renderer renderer_;
};

/// The runs of equal label along a crease.
void addRuns(const EdgeLooker& looker, const Crease& crease, const MapBuilderParams& params,
             std::vector<MapSegment>& out) {
  const double length = crease.line.length();
  if (length < params.min_length_m - kRounding_m) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(length / params.step_m - 1e-6)));
  const auto fractionOf = [&](int i) { return (i + 0.5) / steps; };
  std::vector<std::optional<Label>> labels;
  for (int i = 0; i < steps; ++i) labels.push_back(looker.labelAt(crease, fractionOf(i)));
  /// Position of the label's end, by bisection between a place with it and one without it.
  const auto refine = [&](double has, double has_not, const Label& label) {
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (has + has_not);
      (looker.labelAt(crease, middle) == label ? has : has_not) = middle;
    }
    return has;
  };
  for (int first = 0; first < steps;) {
    int last = first;
    while (last + 1 < steps && labels[last + 1] == labels[first]) ++last;
    if (labels[first]) {
      const Label& label = *labels[first];
      const double from = first == 0 ? 0.0 : refine(fractionOf(first), fractionOf(first - 1), label);
      const double to = last + 1 == steps ? 1.0 : refine(fractionOf(last), fractionOf(last + 1), label);
      const Eigen::Vector3d d = crease.line.b - crease.line.a;
      MapSegment segment{{crease.line.a + from * d, crease.line.a + to * d}, label};
      for (Eigen::Vector3d* end : {&segment.world.a, &segment.world.b}) {
        if (std::abs(end->z()) < kOnFloor_m) end->z() = 0.0;
        // Rounded to millimetres for readability, without -0.
        *end = (*end * 1e3).array().round() / 1e3 + 0.0;
      }
      if (segment.world.length() >= params.min_length_m) out.push_back(std::move(segment));
    }
    first = last + 1;
  }
}

}  // namespace

SegmentMap buildSegmentMap(const World& world, const Palette& palette, const MapBuilderParams& params,
                           const std::function<void(std::size_t done, std::size_t all)>& progress) {
  const EdgeLooker looker(world, palette, params);
  std::vector<MapSegment> runs;
  const std::vector<Crease> creases = findCreases(world, params.crease_rad);
  for (std::size_t i = 0; i < creases.size(); ++i) {
    addRuns(looker, creases[i], params, runs);
    if (progress) progress(i + 1, creases.size());
  }

  SegmentMap map{joinPieces(runs, params.same_place_m)};
  const bool join = params.join_stripes && !palette.stripes().empty();
  return join ? joinStripes(map, palette.stripes()) : map;
}

}  // namespace vismem
