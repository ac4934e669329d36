// Tests E5, E6. Runs with kidnappings in closed loop, and a method on their record.
#include "experiments/app/trial_run.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "experiments/trials/trial_method.h"
#include "experiments/trials/trial_score.h"

namespace vismem {
namespace {

using ::testing::Contains;

TrialOptions shortTrial() {
  TrialOptions options;
  options.world = "corridor_irregular";
  options.seed = 3;
  options.events = 2;
  options.event_s = 12.0;
  return options;
}

std::vector<PoseEstimate> estimatesOf(const Trial& trial, const MethodMaker& maker, const SegmentMap& edges) {
  const auto method = maker.make(edges, trial.seed);
  std::vector<PoseEstimate> estimates;
  for (std::size_t i = 0; i < trial.updates.size(); ++i) {
    estimates.push_back(method->step(trial.updates[i]));
  }
  return estimates;
}

TEST(TrialRun, RecordsWhatEveryMethodIsGivenAndTheTruth) {
  TrialRun run(shortTrial());
  const Trial trial = run.record();
  ASSERT_EQ(trial.events_us.size(), 2u);
  EXPECT_NEAR(toSeconds(trial.events_us[1]), 12.0, 0.2);
  EXPECT_GT(trial.updates.size(), 150u);  // of 240 images; the memory passes over some that show nothing new
  EXPECT_NEAR(toSeconds(trial.truth.back().stamp_us), 24.0, 0.2);
  std::size_t segments = 0;
  for (const MemoryUpdate& update : trial.updates) segments += update.analysis->observed.size();
  EXPECT_GT(segments, 5 * trial.updates.size());
  // The kidnapping is a jump of the truth, and of nothing else.
  const Trajectory before = truthOfEvent(trial, 0);
  const Trajectory after = truthOfEvent(trial, 1);
  EXPECT_LT(before.back().stamp_us, after.front().stamp_us);
  const Pose2 jump = inverse(before.back().pose) * after.front().pose;
  EXPECT_TRUE(jump.position().norm() >= 1.9 || std::abs(jump.theta) >= 1.5);
}

TEST(TrialRun, TheDefaultModeFindsTheKidnappedRobot) {
  TrialRun run(shortTrial());
  const Trial trial = run.record();
  const auto events = scoreEvents(
      trial, estimatesOf(trial, localizerMethod("default", run.params().localizer), run.params().map_edges));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_TRUE(events[1].settled_after_s);
  EXPECT_TRUE(events[1].right_at_end);
}

TEST(TrialRun, ImagesGetTheFalseSegmentsThatAreAsked) {
  TrialOptions options = shortTrial();
  options.events = 1;
  options.event_s = 4.0;
  const auto falseShare = [&] {
    double labelled = 0.0;
    double added = 0.0;
    for (const MemoryUpdate& update : TrialRun(options).record().updates) {
      for (const ImageSegment& segment : update.analysis->observed) {
        if (segment.label == kUnknownLabel) continue;
        ++labelled;
        // Added segments have one contrast, a whole number; measured ones are means over pixels.
        if (segment.strength == 40.0) ++added;
      }
    }
    return added / labelled;
  };
  EXPECT_EQ(falseShare(), 0.0);
  options.disturbance.false_share = 0.3;
  EXPECT_NEAR(falseShare(), 0.3, 0.08);
}

// The comparison of B4: the same kidnappings, another gaze, and a localization that gives the same
// estimates on the record that it gave in the loop.
TEST(TrialRun, LocalizationSteersTheGazeInClosedLoop) {
  TrialOptions options = shortTrial();
  TrialRun alone(options);
  const Trial by_salience = alone.record();
  EXPECT_EQ(by_salience.gaze_requests, 0);
  options.gaze = TrialGaze::kLocalization;
  TrialRun run(options);
  std::vector<AttentionKind> targets;
  const Trial trial = run.record([&](const TrialRun::Step& step, GazeClient&) {
    if (step.gaze.target) targets.push_back(step.gaze.target->kind);
  });
  EXPECT_GT(trial.gaze_requests, 0);
  EXPECT_THAT(targets, Contains(AttentionKind::kClient));
  EXPECT_EQ(trial.gaze_plan_ms.size(), trial.updates.size());
  ASSERT_EQ(trial.events_us, by_salience.events_us);
  for (std::size_t event = 0; event < trial.events_us.size(); ++event) {
    EXPECT_EQ(truthOfEvent(trial, event).front().pose, truthOfEvent(by_salience, event).front().pose);
  }
  // Another gaze sees other things.
  const auto panOf = [](const MemoryUpdate& update) {
    return update.analysis->T_robot_camera.linear()(1, 2);
  };
  bool differs = false;
  for (std::size_t i = 0; i < std::min(trial.updates.size(), by_salience.updates.size()); ++i) {
    differs = differs || std::abs(panOf(trial.updates[i]) - panOf(by_salience.updates[i])) > 0.1;
  }
  EXPECT_TRUE(differs);
  const auto events = scoreEvents(
      trial, estimatesOf(trial, localizerMethod("default", run.params().localizer), run.params().map_edges));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_TRUE(events[1].right_at_end);
}

// The oracle knows the truth: it requests gaze while the winner is wrong, and at no other time.
TEST(TrialRun, TheOracleAsksWhileThePoseIsWrong) {
  TrialOptions options = shortTrial();
  options.events = 6;  // some are found again in three images
  options.gaze = TrialGaze::kOracle;
  TrialRun run(options);
  const auto method =
      localizerMethod("default", run.params().localizer).make(run.params().map_edges, options.seed);
  int wrong_since = 0;  // images
  int right_since = 0;
  int asked_while_wrong = 0;
  int long_wrong = 0;
  run.record([&](const TrialRun::Step& step, GazeClient&) {
    const bool asks = std::any_of(step.gaze.points.begin(), step.gaze.points.end(),
                                  [](const auto& point) { return point.kind == AttentionKind::kClient; });
    const PoseEstimate estimate = method->step(step.update);
    const Pose2 truth = run.simulation().truth().T_world_robot;
    const bool is_right = estimate.T_world_robot && isRight(*estimate.T_world_robot, truth);
    wrong_since = is_right ? 0 : wrong_since + 1;
    right_since = is_right ? right_since + 1 : 0;
    if (wrong_since > 2) ++long_wrong;
    if (wrong_since > 2 && asks) ++asked_while_wrong;
    if (right_since > 15) {
      EXPECT_FALSE(asks);
    }
  });
  EXPECT_GT(long_wrong, 0);
  EXPECT_EQ(asked_while_wrong, long_wrong);
}

TEST(TrialRun, TheSameSeedGivesTheSameRecord) {
  TrialOptions options = shortTrial();
  options.events = 1;
  options.event_s = 5.0;
  options.disturbance = {.false_share = 0.3, .lost_share = 0.2};
  const Trial first = TrialRun(options).record();
  const Trial second = TrialRun(options).record();
  ASSERT_EQ(first.updates.size(), second.updates.size());
  for (std::size_t i = 0; i < first.updates.size(); ++i) {
    const auto& a = first.updates[i].analysis->observed;
    const auto& b = second.updates[i].analysis->observed;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].px.a, b[k].px.a);
  }
  options.seed = 4;
  EXPECT_NE(TrialRun(options).record().truth.front().pose, first.truth.front().pose);
}

TEST(TrialRun, NothingIsSeenInABlackout) {
  TrialOptions options = shortTrial();
  options.events = 1;
  options.event_s = 6.0;
  options.blackout_from_s = 2.0;
  options.blackout_s = 2.0;
  const Trial trial = TrialRun(options).record();
  int dark = 0;
  for (const MemoryUpdate& update : trial.updates) {
    const double at_s = toSeconds(update.analysis->stamp_us);
    if (at_s < 2.0 || at_s >= 4.0) continue;
    ++dark;
    EXPECT_TRUE(update.analysis->observed.empty());
  }
  EXPECT_GT(dark, 5);
}

}  // namespace
}  // namespace vismem
