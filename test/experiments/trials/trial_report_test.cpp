// Tests E6. Files of a comparison, also after an interrupted run.
#include "experiments/app/trial_report.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/app/experiment_files.h"

namespace vismem {
namespace {

/// Estimates the same pose at every step.
class ConstantPose : public TrialMethod {
 public:
  explicit ConstantPose(const Pose2& pose) : pose_(pose) {}
  PoseEstimate step(const MemoryUpdate& update) override {
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
  Comparison comparison("both", "two who never move", {"ahead", "left"});
  for (int trials = 1; trials <= 3; ++trials) {
    const Trial trial = standing(static_cast<std::uint64_t>(trials));
    comparison.add(runMethod(constantPose("ahead", {0, 0, 0}), trial, {}, false));
    comparison.add(runMethod(constantPose("left", {0, 0, 1.57}), trial, {}, false));
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

TEST_F(ComparisonFiles, EachMethodHasItsOwnEvents) {
  Comparison comparison("own", "", {"ahead", "left"});
  MethodOutcome ahead = runMethod(constantPose("ahead", {0, 0, 0}), standing(1), {}, false);
  noteEvidence({std::nullopt, 2.0}, ahead);
  comparison.add(ahead);
  comparison.add(runMethod(constantPose("left", {0, 0, 1.57}), standing(1), {}, false));
  ASSERT_EQ(comparison.records()[0].events.size(), 2u);
  ASSERT_EQ(comparison.records()[1].events.size(), 2u);
  EXPECT_EQ(comparison.records()[0].events[1].evidence_after_s, 2.0);
  EXPECT_FALSE(comparison.records()[1].events[1].evidence_after_s);
  MethodOutcome right;
  right.method = "right";
  EXPECT_THROW(comparison.add(right), std::invalid_argument);
}

TEST(TrialOutcome, IsTheSameAfterItsJson) {
  TrialOutcome outcome;
  outcome.seed = 1003;
  RecordOutcome record;
  record.methods.push_back(runMethod(constantPose("left", {0, 0, 1.57}), standing(1003), {}, true));
  EventScore& event = record.methods[0].events[1];
  event.settled_after_s = 0.1 + 0.2;  // not exact in few digits
  event.error_over_reported = std::numeric_limits<double>::infinity();
  event.evidence_after_s = std::nullopt;
  record.gaze_plan_ms = {1.0 / 3.0};
  record.gaze_requests = 7;
  record.truth = standing(1003).truth;
  record.events_us = standing(1003).events_us;
  outcome.records = {record};
  const auto json = toJson(outcome, true);
  const TrialOutcome read = trialOutcomeFrom(nlohmann::json::parse(json.dump()));
  EXPECT_EQ(toJson(read, true), json);
  const EventScore& same = read.records[0].methods[0].events[1];
  EXPECT_EQ(same.settled_after_s, event.settled_after_s);
  EXPECT_EQ(same.error_over_reported, event.error_over_reported);
  EXPECT_FALSE(same.evidence_after_s);
  EXPECT_EQ(read.records[0].truth.size(), record.truth.size());
  EXPECT_EQ(read.records[0].methods[0].poses.size(), 101u);
  EXPECT_FALSE(read.is_whole);
  EXPECT_TRUE(trialOutcomeFrom(toJson(outcome, false)).records[0].truth.empty());
  EXPECT_THROW(trialOutcomeFrom({{"seed", 1}}), nlohmann::json::exception);
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
