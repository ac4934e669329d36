#include "evaluation/core/floor_truth.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kOnFloor_m = 1e-6;

bool touch(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double touching_m) {
  return (a - b).norm() <= touching_m;
}

Segment2 reversed(const Segment2& s) {
  return {s.b, s.a};
}

/// Moves the piece that continues the chain's end from the rest to the chain.
/// @return false when there is none.
bool extend(std::vector<Segment2>& chain, std::vector<Segment2>& rest, const FloorTruthParams& params) {
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (const Segment2& next : {rest[i], reversed(rest[i])}) {
      if (!touch(chain.back().b, next.a, params.touching_m)) continue;
      if (std::abs(angleDifference(next.direction(), chain.back().direction())) > params.curve_turn_rad)
        continue;
      chain.push_back(next);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
  }
  return false;
}

TrueEdge makeEdge(const Label& label, std::vector<Segment2> pieces, bool curve,
                  const FloorTruthParams& params) {
  TrueEdge edge;
  edge.label = label;
  edge.curve = curve;
  edge.closed = curve && touch(pieces.front().a, pieces.back().b, params.touching_m);
  for (const Segment2& piece : pieces) {
    const double length = piece.length();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / params.step_m)));
    for (int i = 0; i <= steps; ++i) {
      if (i == 0 && !edge.samples.empty()) continue;  // where the piece before ended
      const double t = static_cast<double>(i) / steps;
      TrueEdge::Sample sample;
      sample.p = piece.a + t * (piece.b - piece.a);
      sample.along_m = edge.length_m + t * length;
      edge.samples.push_back(sample);
    }
    edge.length_m += length;
  }
  edge.pieces = std::move(pieces);
  return edge;
}

}  // namespace

double floorFootprint(const TrueEdge::Sample& sample, double focal_px) {
  const double d = sample.nearest_m;
  const double h = sample.camera_height_m;
  return (d * d + h * h) / (h * focal_px);
}

FloorTruth::FloorTruth(const SegmentMap& edges, const Params& params) : params_(params) {
  struct Short {
    Label label;
    Segment2 floor;
  };
  std::vector<Short> short_ones;
  for (const MapSegment& segment : edges.segments) {
    if (std::abs(segment.world.a.z()) > kOnFloor_m || std::abs(segment.world.b.z()) > kOnFloor_m) continue;
    const Segment2 floor = segment.world.floor();
    if (floor.length() <= params_.curve_piece_m) {
      short_ones.push_back({segment.label, floor});
    } else {
      edges_.push_back(makeEdge(segment.label, {floor}, false, params_));
    }
  }
  std::vector<Label> labels;
  for (const Short& s : short_ones) {
    if (std::find(labels.begin(), labels.end(), s.label) == labels.end()) labels.push_back(s.label);
  }
  for (const Label& label : labels) {
    std::vector<Segment2> rest;
    for (const Short& s : short_ones) {
      if (s.label == label) rest.push_back(s.floor);
    }
    while (!rest.empty()) {
      std::vector<Segment2> chain{rest.front()};
      rest.erase(rest.begin());
      while (extend(chain, rest, params_)) {
      }
      // And backwards from its beginning.
      std::reverse(chain.begin(), chain.end());
      for (Segment2& s : chain) s = reversed(s);
      while (extend(chain, rest, params_)) {
      }
      if (static_cast<int>(chain.size()) >= params_.curve_pieces) {
        edges_.push_back(makeEdge(label, std::move(chain), true, params_));
      } else {
        for (const Segment2& s : chain) edges_.push_back(makeEdge(label, {s}, false, params_));
      }
    }
  }
}

int FloorTruth::addView(const CameraIntrinsics& k, const Pose3& T_world_camera, const SeesFloor& sees,
                        double least_px) {
  const Pose3 T_camera_world = T_world_camera.inverse(Eigen::Isometry);
  const Eigen::Vector3d camera = T_world_camera.translation();
  int shown = 0;
  for (TrueEdge& edge : edges_) {
    bool all = true;
    double px_length = 0.0;
    bool goes_on = false;  // the sample before was visible, too
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    for (TrueEdge::Sample& sample : edge.samples) {
      const Eigen::Vector3d p{sample.p.x(), sample.p.y(), 0.0};
      const double distance = (sample.p - camera.head<2>()).norm();
      std::optional<Eigen::Vector2d> px;
      if (distance <= params_.range_m) px = projectToIdeal(k, T_camera_world * p);
      if (px) {
        const Eigen::Vector2d raw = distortPixel(k, *px);
        const double b = params_.border_px;
        const bool inside = raw.x() >= b && raw.y() >= b && raw.x() <= k.width - 1 - b &&
                            raw.y() <= k.height - 1 - b && (T_camera_world * p).z() > kNearPlane_m;
        if (!inside || !sees(camera, p)) px.reset();
      }
      if (px) {
        sample.seen = true;
        if (distance < sample.nearest_m) {
          sample.nearest_m = distance;
          sample.camera = camera.head<2>();
          sample.camera_height_m = camera.z();
        }
        if (goes_on) px_length += (*px - last).norm();
        last = *px;
      } else {
        all = false;
      }
      goes_on = px.has_value();
    }
    if (px_length >= least_px) ++shown;
    if (all) {
      edge.shown_in_full = true;
      edge.longest_view_px = std::max(edge.longest_view_px, px_length);
    }
  }
  return shown;
}

}  // namespace vismem
