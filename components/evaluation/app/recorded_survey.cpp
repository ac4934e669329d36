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

RecordedSurvey::RecordedSurvey(const SurveyFiles& files, const Trajectory& truth)
    : truth_(truth),
      floor_(expandStripes(loadSegmentMap(files.edges), {}), rowsOf(files.neutral), rowsOf(files.obstacles)) {}

void RecordedSurvey::add(const RobotObservation& observation) {
  const auto T_world_robot = poseAt(truth_, observation.frame.stamp_us);
  if (!T_world_robot) return;
  params_.focal_px = observation.frame.intrinsics.fx;
  floor_.addView(observation.frame.intrinsics, toPose3(*T_world_robot) * observation.T_robot_camera);
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
