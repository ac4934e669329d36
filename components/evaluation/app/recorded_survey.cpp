#include "evaluation/app/recorded_survey.h"

#include <nlohmann/json.hpp>

#include "common/config/text_file.h"

namespace vismem {
namespace {

std::vector<Segment3> rowsOf(const std::filesystem::path& file) {
  if (file.empty()) return {};
  return parseSurvey(readTextFile(file, "rows x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,name"), file.string());
}

}  // namespace

RecordedSurvey::RecordedSurvey(const SurveyFiles& files, const SegmentMap& map_edges, const Trajectory& truth)
    : truth_(truth),
      floor_(expandStripes(loadSegmentMap(files.edges), {}), rowsOf(files.neutral), rowsOf(files.obstacles)),
      labels_(map_edges, rowsOf(files.obstacles)) {}

void RecordedSurvey::add(const RobotObservation& observation, const ImageAnalysis* analysis) {
  const auto T_world_robot = poseAt(truth_, observation.frame.stamp_us);
  if (!T_world_robot) return;
  params_.focal_px = observation.frame.intrinsics.fx;
  const Pose3 T_world_camera = toPose3(*T_world_robot) * observation.T_robot_camera;
  floor_.addView(observation.frame.intrinsics, T_world_camera);
  if (analysis != nullptr) labels_.add(analysis->observed, analysis->intrinsics, T_world_camera);
}

nlohmann::json RecordedSurvey::labels() const {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [label, lengths] : labels_.lengths()) {
    const double right = lengths.share(label);
    const double unknown = lengths.share(kUnknownLabel);
    json[label] = {{"length_px", lengths.total_px()},
                   {"right_share", right},
                   {"wrong_share", 1.0 - right - unknown},
                   {"unknown_share", unknown}};
  }
  return json;
}

nlohmann::json RecordedSurvey::score(const MemorySnapshot& memory) const {
  const auto T_world_robot = poseAt(truth_, memory.stamp_us);
  if (!T_world_robot) return {};
  const SurveyScore score = floor_.score(rememberedIn(memory, *T_world_robot), params_);
  return {{"precision", score.precision()},
          {"recall", score.recall()},
          {"confirmed", score.judged},
          {"edges_shown", score.shown},
          {"elements_per_edge", score.elements_per_edge},
          {"line_rms_m", score.line_rms_m}};
}

}  // namespace vismem
