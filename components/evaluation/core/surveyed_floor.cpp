#include "evaluation/core/surveyed_floor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kLeastPiece_px = 1.0;
constexpr double kTouching_m = 5e-3;  // a box that begins this near to the floor point stands on it
constexpr double kOffEdge_m = 0.05;   // distance of a neutral edge

std::optional<Segment3> rowOf(const std::vector<std::string_view>& cells) {
  if (cells.size() < 6) return std::nullopt;
  Segment3 row;
  for (int i = 0; i < 6; ++i) {
    const auto value = finiteNumber(cells[static_cast<std::size_t>(i)]);
    if (!value || std::abs(*value) > kFarthest_m) return std::nullopt;
    (i < 3 ? row.a : row.b)[i % 3] = *value;
  }
  return row;
}

/// @return whether most of an element lies beside one of the edges, in its direction.
bool liesOn(const Segment2& element, const std::vector<Segment3>& edges, const MemoryScoreParams& params) {
  const std::array places{element.a, element.middle(), element.b};
  return std::any_of(edges.begin(), edges.end(), [&](const Segment3& row) {
    const Segment2 edge = row.floor();
    return lineAngleDifference(edge.direction(), element.direction()) <= params.angle_rad &&
           std::count_if(places.begin(), places.end(), [&](const Eigen::Vector2d& p) {
             return distanceToSegment(p, edge) <= kOffEdge_m;
           }) >= 2;
  });
}

}  // namespace

std::vector<Segment3> parseSurvey(std::string_view text, const std::string& file_name) {
  std::vector<Segment3> rows;
  std::vector<std::string> problems;
  bool header = true;
  int number = 0;
  for (const std::string_view line : splitAt(text, '\n')) {
    ++number;
    const std::string_view content = contentOf(line);
    if (content.empty() || std::exchange(header, false)) continue;
    if (const auto row = rowOf(splitAt(content, ','))) {
      rows.push_back(*row);
    } else {
      problems.push_back(file_name + ":" + std::to_string(number) + ": \"" + std::string(content) +
                         "\" (expected numbers x1_m,y1_m,z1_m,x2_m,y2_m,z2_m and a name)");
    }
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return rows;
}

bool isHidden(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const std::vector<Segment3>& boxes) {
  const Eigen::Vector3d way = to - from;
  const double last = 1.0 - kTouching_m / std::max(kTouching_m, way.norm());
  return std::any_of(boxes.begin(), boxes.end(), [&](const Segment3& box) {
    double enter = 0.0;
    double leave = last;
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(box.a[i], box.b[i]);
      if (way[i] == 0.0) {
        if (from[i] <= low || from[i] >= high) return false;
        continue;
      }
      const double a = (low - from[i]) / way[i];
      const double b = (high - from[i]) / way[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter < leave;
  });
}

SurveyedFloor::SurveyedFloor(const SegmentMap& edges, std::vector<Segment3> neutral,
                             std::vector<Segment3> obstacles)
    : edges_(edges), neutral_(std::move(neutral)), obstacles_(std::move(obstacles)) {}

void SurveyedFloor::addView(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera) {
  const auto sees = [this](const Eigen::Vector3d& camera, const Eigen::Vector3d& floor) {
    return !isHidden(camera, floor, obstacles_);
  };
  edges_.addView(intrinsics, T_world_camera, sees, kLeastPiece_px);
}

SurveyScore SurveyedFloor::score(const std::vector<RememberedEdge>& memory,
                                 const MemoryScoreParams& params) const {
  const MemoryScore all = scoreMemory(memory, edges_.edges(), params);
  SurveyScore score;
  score.shown = all.shown;
  score.found = all.found;
  score.elements_per_edge = all.duplicates();
  double squares_m2 = 0.0;
  int ends = 0;
  for (const MemoryScore::Judgement& judgement : all.judged) {
    const bool right = judgement.verdict == MemoryScore::Verdict::kRight;
    if (!right && liesOn(judgement.edge.world, neutral_, params)) continue;
    ++score.judged;
    score.right += right;
    if (judgement.true_edge < 0) continue;
    const TrueEdge& edge = edges_.edges()[static_cast<std::size_t>(judgement.true_edge)];
    if (edge.curve) continue;
    const Segment2& line = edge.pieces.front();
    for (const Eigen::Vector2d& end : {judgement.edge.world.a, judgement.edge.world.b}) {
      const double off = cross2((line.b - line.a).normalized(), end - line.a);
      squares_m2 += off * off;
      ++ends;
    }
  }
  score.line_rms_m = ends > 0 ? std::sqrt(squares_m2 / ends) : 0.0;
  return score;
}

}  // namespace vismem
