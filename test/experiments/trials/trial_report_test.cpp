// Tests E6. Files of a comparison, also after an interrupted run.
#include "experiments/app/trial_report.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/experiment_files.h"

namespace vismem {
namespace {

/// Estimates the same pose at every step.
class ConstantPose : public TrialMethod {
 public:
  explicit ConstantPose(const Pose2& pose) : pose_(pose) {}
  PoseEstimate step(const MemoryUpdate& update, const Pose2&) override {
    PoseEstimate estimate;
    estimate.stamp_us = update.snapshot->stamp_us;
    estimate.T_world_robot = pose_;
    return estimate;
  }
  void setPose(const Pose2& pose) override { pose_ = pose; }

 private:
  Pose2 pose_;
};

MethodMaker constantPose(const std::string& name, const Pose2& pose) {
  return {name, [pose](const SegmentMap&, std::uint64_t) { return std::make_unique<ConstantPose>(pose); }};
}

/// A robot that stands at the origin for 5 s, and is turned there by 90 degrees for 5 s more.
Trial standing(std::uint64_t seed) {
  Trial trial;
  trial.seed = seed;
  trial.events_us = {0, 5 * kSecondUs + 1};
  for (StampUs t = 0; t <= 10 * kSecondUs; t += kSecondUs / 10) {
    append(trial.truth, {t, {0.0, 0.0, t <= 5 * kSecondUs ? 0.0 : 1.57}});
    if (t == 5 * kSecondUs) append(trial.truth, {t + 1, {0.0, 0.0, 1.57}});
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = t;
    trial.updates.push_back({snapshot, std::make_shared<ImageAnalysis>()});
    trial.T_odom_robot_now.emplace_back();
  }
  return trial;
}

std::vector<std::string> linesOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class ComparisonFiles : public testing::Test {
 protected:
  ComparisonFiles()
      : out_(std::filesystem::path(testing::TempDir()) / ("trials_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(out_);
  }
  ~ComparisonFiles() override { std::filesystem::remove_all(out_); }
  const std::filesystem::path out_;
};

TEST_F(ComparisonFiles, HoldAllTrialsSoFarAfterEachOfThem) {
  Comparison comparison("both", "two who never move",
                        {constantPose("ahead", {0, 0, 0}), constantPose("left", {0, 0, 1.57})});
  for (int trials = 1; trials <= 3; ++trials) {
    comparison.add(standing(static_cast<std::uint64_t>(trials)), {});
    comparison.write(out_);
    // A head, and two events of two methods a trial.
    EXPECT_EQ(linesOf(out_ / "both_events.csv").size(), 1u + 4u * static_cast<unsigned>(trials));
    const auto json = nlohmann::json::parse(std::ifstream(out_ / "both.json"));
    EXPECT_EQ(json["ahead"]["events"], trials);
    EXPECT_EQ(json["ahead"]["recovered"], 0);  // of the kidnappings
    EXPECT_EQ(json["left"]["recovered"], trials);
  }
  // Nothing half-written stays behind.
  for (const auto& entry : std::filesystem::directory_iterator(out_)) {
    EXPECT_NE(entry.path().extension(), ".unfinished");
  }
}

TEST_F(ComparisonFiles, AMethodMayHaveTrialsOfItsOwn) {
  Comparison comparison("own", "", {constantPose("ahead", {0, 0, 0}), constantPose("left", {0, 0, 1.57})});
  comparison.addTo("ahead", standing(1), {});
  comparison.noteEvidence({std::nullopt, 2.0});
  comparison.addTo("left", standing(1), {});
  ASSERT_EQ(comparison.records()[0].events.size(), 2u);
  ASSERT_EQ(comparison.records()[1].events.size(), 2u);
  EXPECT_EQ(comparison.records()[0].events[1].evidence_after_s, 2.0);
  EXPECT_FALSE(comparison.records()[1].events[1].evidence_after_s);
  EXPECT_THROW(comparison.addTo("right", standing(1), {}), std::invalid_argument);
}

TEST_F(ComparisonFiles, AFileThatCannotBeWrittenIsNamed) {
  try {
    replaceFile(out_ / "no" / "such.csv", "text");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("such.csv: cannot be written"));
  }
}

}  // namespace
}  // namespace vismem
