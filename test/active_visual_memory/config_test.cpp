#include "active_visual_memory/app/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

const std::string kPeers =
    "ActiveVisualMemory.Camera.Proxy = cameraA:tcp -p 9999\n"
    "ActiveVisualMemory.Odometry.Proxy = Encoders:tcp -p 9997\n"
    "ActiveVisualMemory.PanTilt.Proxy = PanTilt:tcp -p 9977\n";

ActiveVisualMemoryConfig parse(const std::string& text) {
  const Properties properties = Properties::parse(text, "test.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("ActiveVisualMemory");
  auto config = readActiveVisualMemoryConfig(reader);
  reader.finish();
  return config;
}

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    parse(text);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(ActiveVisualMemoryConfig, DefaultsAreThePresets) {
  const auto ours = parse(kPeers);
  EXPECT_EQ(ours.pipeline.memory.memory.fusion, SegmentMemory::Fusion::kCovariance);
  EXPECT_EQ(ours.pipeline.vision.detector, "solis");
  EXPECT_NEAR(ours.pipeline.memory.gaze.max_pan_rad, degToRad(159.0), 1e-3);
  const auto chapter = parse(kPeers + "ActiveVisualMemory.Mode = chapter\n");
  EXPECT_EQ(chapter.pipeline.memory.memory.fusion, SegmentMemory::Fusion::kChapter);
  EXPECT_EQ(chapter.pipeline.vision.detector, "chapter");
  EXPECT_DOUBLE_EQ(chapter.pipeline.memory.gaze.track_s, 3.0);
}

TEST(ActiveVisualMemoryConfig, AKeyOverridesThePreset) {
  const auto config = parse(kPeers +
                            "ActiveVisualMemory.Mode = chapter\n"
                            "ActiveVisualMemory.Gaze.Track_s = 1.5\n"
                            "ActiveVisualMemory.Gaze.Pan.Maximum_deg = 90\n"
                            "ActiveVisualMemory.Mount.PanTilt.Position_m = 0.1 0 0.4\n"
                            "ActiveVisualMemory.Memory.Life.Maximum = 50\n");
  EXPECT_DOUBLE_EQ(config.pipeline.memory.gaze.track_s, 1.5);
  EXPECT_NEAR(config.pipeline.memory.gaze.max_pan_rad, degToRad(90.0), 1e-12);
  EXPECT_NEAR(config.pipeline.memory.attention.max_pan_rad, degToRad(90.0), 1e-12);
  EXPECT_DOUBLE_EQ(config.assembler.mount.T_robot_pantilt.translation().x(), 0.1);
  EXPECT_DOUBLE_EQ(config.pipeline.memory.memory.life.maximum, 50.0);
}

TEST(ActiveVisualMemoryConfig, SlipsOfTheFeetAreToldByKeys) {
  const SegmentMemory::Params p = parse(kPeers +
                                        "ActiveVisualMemory.Memory.Align.TurnNoise_deg = 2\n"
                                        "ActiveVisualMemory.Memory.Align.Slip.LeastImages = 4\n"
                                        "ActiveVisualMemory.Memory.Align.Slip.Images = 8\n"
                                        "ActiveVisualMemory.Memory.Align.Slip.Sigmas = 5\n"
                                        "ActiveVisualMemory.Memory.Align.Slip.Least_deg = 3\n")
                                      .pipeline.memory.memory;
  EXPECT_DOUBLE_EQ(p.jointly.turn_noise, degToRad(2.0));
  EXPECT_EQ(p.slip.least_images, 4);
  EXPECT_EQ(p.slip.images, 8);
  EXPECT_DOUBLE_EQ(p.slip.sigmas, 5.0);
  EXPECT_DOUBLE_EQ(p.slip.least_rad, degToRad(3.0));
  EXPECT_THAT(problemsOf(kPeers + "ActiveVisualMemory.Memory.Align.Slip.LeastImages = 11\n"),
              Contains(AllOf(HasSubstr("Align.Slip.LeastImages"), HasSubstr("Align.Slip.Images"))));
}

TEST(ActiveVisualMemoryConfig, WithoutAPanTiltUnitTheGazeIsOff) {
  const auto config = parse(
      "ActiveVisualMemory.Camera.Proxy = cameraA:tcp -p 9999\n"
      "ActiveVisualMemory.Odometry.Proxy = Encoders:tcp -p 9997\n");
  EXPECT_FALSE(config.hasPanTilt());
  EXPECT_FALSE(config.assembler.has_pan_tilt);
  EXPECT_EQ(config.pipeline.memory.gaze.initial_mode, GazeMode::kOff);
}

TEST(ActiveVisualMemoryConfig, ReportsAllProblemsTogether) {
  const auto problems = problemsOf(
      "ActiveVisualMemory.Camera.Proxy = cameraA:tcp -p 9999\n"
      "ActiveVisualMemory.Gaze.Track_s = -1\n"
      "ActiveVisualMemory.Gaze.Trak_s = 1\n"
      "ActiveVisualMemory.Gaze.Pan.Minimum_deg = 170\n"
      "ActiveVisualMemory.Memory.Fusion = newest\n");
  EXPECT_THAT(problems,
              Contains(AllOf(HasSubstr("test.cfg:2"), HasSubstr("ActiveVisualMemory.Gaze.Track_s"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("test.cfg:3"), HasSubstr("did you mean"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("Gaze.Pan.Minimum_deg"), HasSubstr("must be less than"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("Memory.Fusion"), HasSubstr("covariance"))));
  EXPECT_THAT(problems, Contains(HasSubstr("ActiveVisualMemory.Odometry.Proxy")));
}

}  // namespace
}  // namespace vismem
