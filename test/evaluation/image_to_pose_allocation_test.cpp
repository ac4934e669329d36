// Tests M7: allocations of each stage from an image to the pose, once everything has been seen.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/geometry/angles.h"
#include "common/profiling/stage_probe.h"
#include "evaluation/app/evaluation_setup.h"
#include "simulator/core/renderer.h"
#include "support/allocations.h"

namespace vismem {
namespace {

constexpr int kImages = 120;  // of a lap
constexpr double kRate_hz = 10.0;

class AllocationStages : public StageProbe {
 public:
  void enter(const char* stage) override {
    const long now = test::allocations();
    if (current_) current_->second += now - since_;
    std::size_t i = 0;
    while (stages_[i].first && std::strcmp(stages_[i].first, stage) != 0) ++i;
    stages_[i].first = stage;
    current_ = &stages_[i];
    since_ = now;
  }
  void clear() {
    for (auto& stage : stages_) stage.second = 0;
  }
  double perImage(const std::string& name) const {
    for (const auto& [stage, count] : stages_) {
      if (stage && name == stage) return static_cast<double>(count) / kImages;
    }
    return std::nan("");
  }

 private:
  std::array<std::pair<const char*, long>, 12> stages_{};
  std::pair<const char*, long>* current_ = nullptr;
  long since_ = 0;
};

/// A robot that drives round in a circle while its head turns, so that a lap ends where it began.
std::vector<RobotObservation> lap(const EvaluationOptions& options, const CameraMount& mount) {
  const World world = loadWorld(options.world).world;
  Renderer renderer(world);
  CameraIntrinsics camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 300.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  std::vector<RobotObservation> observations;
  for (int i = 0; i < kImages; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / kImages;
    RobotObservation o;
    o.T_odom_robot = {0.5 * std::cos(phase), 0.5 * std::sin(phase),
                      wrapAngle(phase + 0.5 * std::numbers::pi)};
    o.pan_tilt = PanTilt{0.8 * std::sin(2.0 * phase), -0.35};
    o.T_robot_camera = cameraPose(mount, o.pan_tilt->pan_rad, o.pan_tilt->tilt_rad);
    o.frame.intrinsics = camera;
    o.frame.image = renderer.render(camera, toPose3(o.T_odom_robot) * o.T_robot_camera);
    observations.push_back(std::move(o));
  }
  return observations;
}

class ImageToPose : public testing::TestWithParam<const char*> {};

TEST_P(ImageToPose, HasStagesWithoutAllocations) {
  const EvaluationOptions options = inProjectWorld("room", GetParam(), 1, kRate_hz);
  const EvaluationParams params = loadParams(options, true);
  const std::vector<RobotObservation> observations = lap(options, params.assembler.mount);
  MemoryPipeline pipeline(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, 1);
  localizer.setPose(observations.front().T_odom_robot);
  AllocationStages stages;
  std::size_t elements = 0;
  for (int i = 0; i < 3 * kImages; ++i) {
    RobotObservation o = observations[static_cast<std::size_t>(i % kImages)];
    o.frame.seq = static_cast<std::uint64_t>(i);
    o.frame.stamp_us = toStampUs((i + 1) / kRate_hz);
    if (i == 2 * kImages) stages.clear();
    const auto& result = pipeline.process(o, &stages);
    stages.enter("localization");
    localizer.update(result.update);
    stages.enter("outside");
    elements += result.update.snapshot->segments.size();
  }
  EXPECT_GT(elements, 3U * kImages * 10U) << "there is something to remember";
  for (const char* stage : {"detect", "label", "memory", "primitives", "gaze", "localization"})
    EXPECT_EQ(stages.perImage(stage), 0.0) << stage;
}

INSTANTIATE_TEST_SUITE_P(Robots, ImageToPose, testing::Values("sim", "humanoid"),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace vismem
