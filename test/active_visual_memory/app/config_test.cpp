// Tests C2.
#include "active_visual_memory/app/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "support/build_paths.h"

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
  EXPECT_NEAR(ours.pipeline.memory.rig.max_pan_rad, degToRad(159.0), 1e-3);
  const auto chapter = parse(kPeers + "ActiveVisualMemory.Mode = chapter\n");
  EXPECT_EQ(chapter.pipeline.memory.memory.fusion, SegmentMemory::Fusion::kChapter);
  EXPECT_EQ(chapter.pipeline.vision.detector, "chapter");
  EXPECT_DOUBLE_EQ(chapter.pipeline.memory.gaze.track_s, 3.0);
}

TEST(ActiveVisualMemoryConfig, AKeyOverridesThePreset) {
  const auto config = parse(kPeers +
                            "ActiveVisualMemory.Mode = chapter\n"
                            "ActiveVisualMemory.Gaze.Rate.Pan_degps = 45\n"
                            "ActiveVisualMemory.Gaze.Pan.Maximum_deg = 90\n"
                            "ActiveVisualMemory.Mount.PanTilt.Position_m = 0.1 0 0.4\n"
                            "ActiveVisualMemory.Memory.GapVotes = 4\n");
  EXPECT_NEAR(config.pipeline.memory.gaze.pan.rate_radps, degToRad(45.0), 1e-12);
  EXPECT_NEAR(config.pipeline.memory.rig.max_pan_rad, degToRad(90.0), 1e-12);
  EXPECT_DOUBLE_EQ(config.assembler.mount.T_robot_pantilt.translation().x(), 0.1);
  EXPECT_EQ(config.pipeline.memory.memory.gap_votes, 4);
}

TEST(ActiveVisualMemoryConfig, FarLinesSetsWhatDistantNarrowLinesNeed) {
  const auto shapes = [](const std::string& text) {
    return parse(kPeers + text).pipeline.memory.shape_edges;
  };
  EXPECT_FALSE(shapes("").crosses.enabled);
  const auto far = shapes("ActiveVisualMemory.ShapeEdges.FarLines = yes\n");
  EXPECT_TRUE(far.crosses.enabled);
  EXPECT_TRUE(far.junctions.by_one_side);
  EXPECT_DOUBLE_EQ(far.corners.reach.sigmas, 2.0);
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
      "ActiveVisualMemory.Attention.ForcedSearch_s = -1\n"
      "ActiveVisualMemory.Attention.ForcedSerch_s = 1\n"
      "ActiveVisualMemory.Gaze.Pan.Minimum_deg = 170\n"
      "ActiveVisualMemory.Gaze.Mode = stare\n");
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("test.cfg:2"),
                                       HasSubstr("ActiveVisualMemory.Attention.ForcedSearch_s"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("test.cfg:3"), HasSubstr("did you mean"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("Gaze.Pan.Minimum_deg"), HasSubstr("must be less than"))));
  EXPECT_THAT(problems, Contains(AllOf(HasSubstr("Gaze.Mode"), HasSubstr("attend, hold, off"))));
  EXPECT_THAT(problems, Contains(HasSubstr("ActiveVisualMemory.Odometry.Proxy")));
}

TEST(ActiveVisualMemoryConfig, OldNamesOfKeysAreAcceptedWithAWarningThatNamesTheNewOne) {
  const std::string prefix = "ActiveVisualMemory.Memory.";
  const std::pair<std::string, std::string> renamed[] = {{"Lean.Mount_deg = 0.25", "CameraTilt.Mount_deg"},
                                                         {"Lean.Camera_deg = 0.3", "CameraTilt.Camera_deg"},
                                                         {"Lean.Sway_deg = 0.75", "CameraTilt.PerFrame_deg"},
                                                         {"Align.Compass = yes", "Align.DominantDirection"},
                                                         {"TellInCourse = yes", "SnapToDominantDirection"}};
  std::string text = kPeers + "ActiveVisualMemory.ShapeEdges.PartAtJunctions = no\n";  // old name
  for (const auto& [setting, name] : renamed) text += prefix + setting + "\n";
  // A value that no release accepted is no problem either.
  for (const char* retired : {"Align.Joint = yes", "Align.MapFilter = no", "CameraTilt.PerFrameInflation = 2",
                              "Lean.Course_deg = 3", "Life.Covered_per_s = 7",  // old names
                              "Confirm.LeastLength_m = 0.1", "Fusion = newest"}) {
    text += prefix + retired + "\n";
  }
  const Properties properties = Properties::parse(text, "test.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("ActiveVisualMemory");
  const AttentiveVisualMemoryParams params = readActiveVisualMemoryConfig(reader).pipeline.memory;
  reader.finish();
  EXPECT_NEAR(params.memory.estimation.tilt_prior.mount_rad, degToRad(0.25), 1e-12);
  EXPECT_NEAR(params.memory.estimation.tilt_prior.camera_rad, degToRad(0.3), 1e-12);
  EXPECT_NEAR(params.memory.estimation.tilt_prior.per_frame_rad, degToRad(0.75), 1e-12);
  EXPECT_TRUE(params.memory.estimation.use_dominant_direction);
  EXPECT_TRUE(params.memory.confirmation.snap_to_dominant_direction);
  EXPECT_EQ(params.memory.fusion, SegmentMemory::Fusion::kCovariance) << "Memory.Fusion has no effect";
  EXPECT_FALSE(params.shape_edges.junctions.enabled);
  std::string warnings;
  for (const auto& warning : root.renamedKeys()) warnings += warning.text() + "\n";
  for (const auto& [setting, name] : renamed) EXPECT_THAT(warnings, HasSubstr(prefix + name));
  for (const char* retired : {"Align.Joint", "Align.MapFilter", "CameraTilt.PerFrameInflation", "Fusion",
                              "Lean.Course_deg", "Life.Covered_per_s"}) {  // old names
    EXPECT_THAT(warnings, HasSubstr("key \"" + prefix + retired + "\" has no effect any more"));
  }
  EXPECT_THAT(warnings, HasSubstr("ActiveVisualMemory.ShapeEdges.SplitAtJunctions"));
}

TEST(ActiveVisualMemoryConfig, TheTiltOfSingleImagesIsTheProjectorsErrorToo) {
  const auto sigma = [](const std::string& text) {
    return parse(kPeers + text).pipeline.memory.projector.pitch_sigma_rad;
  };
  EXPECT_DOUBLE_EQ(sigma(""), GroundProjector::Params().pitch_sigma_rad) << "its least value";
  EXPECT_NEAR(sigma("ActiveVisualMemory.Memory.CameraTilt.PerFrame_deg = 1\n"), degToRad(1.0), 1e-12);
}

TEST(ActiveVisualMemoryConfig, TheSimulatorsSetupShowsEveryBasicKeyWithItsValue) {
  const Properties properties =
      Properties::load(std::string(VISMEM_SOURCE_DIR) + "/cfg/sim/active_visual_memory.cfg");
  ConfigReader root(properties);
  ConfigReader reader = root.group("ActiveVisualMemory");
  readActiveVisualMemoryConfig(reader);
  int basic_keys = 0;
  for (const KeyDescription& one : reader.keys()) {
    EXPECT_FALSE(one.meaning.empty()) << one.key << " says nothing of itself";
    if (!one.is_basic) continue;
    ++basic_keys;
    EXPECT_NE(properties.find(one.key), nullptr) << one.key << " is not in cfg/sim";
  }
  EXPECT_GT(basic_keys, 20);
}

TEST(ActiveVisualMemoryConfig, LineWidthsAreOneRangeForAllEdgesOfShapes) {
  const auto range = [](const std::string& text) {
    return parse(kPeers + text).pipeline.memory.shape_edges.line_width;
  };
  EXPECT_EQ(range("").min_m, 0.03);
  EXPECT_EQ(range("").minMeasured_m(), 0.02) << "a third narrower";
  const auto wide = range(
      "ActiveVisualMemory.ShapeEdges.Line.MinimumWidth_m = 0.12\n"
      "ActiveVisualMemory.ShapeEdges.Line.MaximumWidth_m = 0.2\n");
  EXPECT_EQ(wide.min_m, 0.12);
  EXPECT_EQ(wide.max_m, 0.2);
}

}  // namespace
}  // namespace vismem
