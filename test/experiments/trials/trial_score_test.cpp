// Tests E5, E6, L11.
#include "experiments/trials/trial_score.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// A robot that stands at x = 1, and after a kidnapping at 20 s at x = 9. Poses every 0.1 s.
Trial standingTrial(int seconds_each = 20) {
  Trial trial;
  trial.seed = 7;
  trial.events_us = {0, seconds_each * kSecondUs + 1};
  for (StampUs t = 0; t <= 2 * seconds_each * kSecondUs; t += kSecondUs / 10) {
    append(trial.truth, {t, {t <= seconds_each * kSecondUs ? 1.0 : 9.0, 0.0, 0.0}});
    if (t == seconds_each * kSecondUs) append(trial.truth, {t + 1, {9.0, 0.0, 0.0}});
  }
  return trial;
}

PoseEstimate at(StampUs stamp_us, const Pose2& pose) {
  PoseEstimate estimate;
  estimate.stamp_us = stamp_us;
  estimate.T_world_robot = pose;
  return estimate;
}

TEST(TrialScore, CountsEachKidnappingFromItsOwnMoment) {
  const Trial trial = standingTrial();
  std::vector<PoseEstimate> estimates;
  for (StampUs t = kSecondUs / 10; t <= 40 * kSecondUs; t += kSecondUs / 10) {
    // Right from 3 s on, with 10 cm; after the kidnapping it notices after 5 s, with 20 cm.
    const double x = t < 3 * kSecondUs ? 5.0 : t < 25 * kSecondUs ? 1.1 : 9.2;
    estimates.push_back(at(t, {x, 0.0, degToRad(2.0)}));
  }
  const auto events = scoreEvents(trial, estimates);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_NEAR(*events[0].settled_after_s, 3.0, 1e-6);
  EXPECT_NEAR(*events[0].position_error_m, 0.1, 1e-6);
  EXPECT_NEAR(*events[1].settled_after_s, 5.0, 1e-3);
  EXPECT_NEAR(*events[1].position_error_m, 0.2, 1e-6);
  EXPECT_NEAR(*events[1].heading_error_rad, degToRad(2.0), 1e-9);
  EXPECT_TRUE(events[0].right_at_end);
  EXPECT_TRUE(events[1].right_at_end);
}

TEST(TrialScore, MeasuresHowOftenTheTruthIsInTheReportedRegion) {
  const Trial trial = standingTrial();
  std::vector<PoseEstimate> estimates;
  for (StampUs t = kSecondUs / 10; t <= 40 * kSecondUs; t += kSecondUs / 10) {
    // 3 cm beside the truth; reported as 1 cm in every fourth image, as 2 cm else. After 20 s nothing is
    // reported.
    estimates.push_back(at(t, {t <= 20 * kSecondUs ? 1.03 : 9.03, 0.0, 0.0}));
    const double std = t / (kSecondUs / 10) % 4 == 0 ? 0.01 : 0.02;
    if (t <= 20 * kSecondUs) estimates.back().P = std * std * Eigen::Matrix3d::Identity();
  }
  const auto events = scoreEvents(trial, estimates);
  ASSERT_EQ(events.size(), 2u);
  // (3 / 1)^2 is more than 7.8, (3 / 2)^2 less.
  EXPECT_NEAR(*events[0].inside_reported, 0.75, 0.01);
  EXPECT_NEAR(*events[0].error_over_reported, 1.5 / 1.538, 0.01);
  EXPECT_EQ(*events[1].inside_reported, 0.0);
}

TEST(TrialScore, APoseThatGoesWrongAfterSettlingCountsWithItsWholeError) {
  const Trial trial = standingTrial();
  std::vector<PoseEstimate> estimates;
  for (StampUs t = kSecondUs / 10; t <= 20 * kSecondUs; t += kSecondUs / 10) {
    estimates.push_back(at(t, {t <= 10 * kSecondUs ? 1.0 : 4.0, 0.0, 0.0}));
  }
  const auto events = scoreEvents(trial, estimates);
  EXPECT_NEAR(*events[0].settled_after_s, 0.1, 1e-6);
  EXPECT_NEAR(*events[0].position_error_m, 1.5, 0.02);  // half of the time 3 m off
  EXPECT_FALSE(events[0].right_at_end);
  EXPECT_FALSE(events[1].settled_after_s);
}

TEST(TrialScore, TheTruePlaceMustStayAmongTheRacesOnceItWasThere) {
  const Trial trial = standingTrial();
  std::vector<PoseEstimate> estimates;
  for (StampUs t = kSecondUs; t <= 20 * kSecondUs; t += kSecondUs) {
    estimates.push_back(at(t, {5.0, 0.0, 0.0}));
    RaceReport race;
    // There from 11 s to 18 s, gone for the last two.
    race.T_world_robot = {t > 10 * kSecondUs && t <= 18 * kSecondUs ? 1.2 : 6.0, 0.0, 0.0};
    estimates.back().races = {race};
  }
  EXPECT_NEAR(*scoreEvents(trial, estimates)[0].true_alive, 0.8, 1e-9);
}

EventScore event(std::uint64_t seed, std::optional<double> settled_s, double error_m = 0.05) {
  EventScore score;
  score.seed = seed;
  score.event = 1;
  score.seconds = 60.0;
  score.settled_after_s = settled_s;
  if (settled_s) {
    score.position_error_m = error_m;
    score.heading_error_rad = 0.01;
    score.right_at_end = true;
  }
  return score;
}

TEST(TrialSummary, EventsThatNeverRecoveredCountAsInfinitelyLate) {
  std::vector<EventScore> events;
  for (int i = 0; i < 8; ++i) events.push_back(event(1 + i, 1.0 + i));
  events.push_back(event(9, std::nullopt));
  events.push_back(event(10, 61.0));  // later than a minute
  const TrialSummary summary = summarize(events);
  EXPECT_EQ(summary.events, 10);
  EXPECT_EQ(summary.recovered, 8);
  EXPECT_DOUBLE_EQ(summary.median_s->value, 5.5);
  EXPECT_TRUE(std::isinf(summary.p90_s->value));
  EXPECT_NEAR(summary.recovered_share.interval.low, 0.4902, 1e-3);
  EXPECT_NEAR(summary.position_error_m->value, 0.05, 1e-12);
}

TEST(TrialSummary, LeavesTheStartOutUnlessAsked) {
  std::vector<EventScore> events{event(1, 2.0), event(1, 4.0)};
  events.front().event = 0;
  EXPECT_EQ(summarize(events).events, 1);
  EXPECT_EQ(summarize(events, {.kidnaps_only = false}).events, 2);
}

TEST(TrialSummary, TheRightPlaceMustWinWithinTenSecondsOfTheEvidence) {
  std::vector<EventScore> events{event(1, 25.0), event(2, 25.0), event(3, std::nullopt), event(4, 1.0)};
  events[0].evidence_after_s = 20.0;
  events[1].evidence_after_s = 10.0;  // 15 s later: too late
  events[2].evidence_after_s = 55.0;  // too near the end to judge
  const TrialSummary summary = summarize(events);
  EXPECT_DOUBLE_EQ(summary.right_after_evidence->value, 0.5);
}

TEST(TrialSummary, QuantilesOfTwoAreComparedOverTheSameSeeds) {
  std::vector<EventScore> quick;
  std::vector<EventScore> slow;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EventScore event;
    event.seed = seed;
    event.event = 1;
    event.settled_after_s = 0.2 * static_cast<double>(seed);  // 0.2 .. 4 s
    quick.push_back(event);
    event.settled_after_s = 0.5 * static_cast<double>(seed);  // 0.5 .. 10 s
    slow.push_back(event);
  }
  for (const double q : {0.5, 0.9}) {
    const auto ratio = ratioOfQuantiles(quick, slow, q);
    ASSERT_TRUE(ratio);
    EXPECT_NEAR(ratio->value, 0.4, 1e-9);
    // Drawn in pairs, seed by seed, the ratio of two that are proportional is always the same.
    EXPECT_NEAR(ratio->interval.low, 0.4, 1e-9);
    EXPECT_NEAR(ratio->interval.high, 0.4, 1e-9);
  }
  // The quantile is infinite: there is no ratio.
  for (std::size_t i = 0; i < 5; ++i) slow[i].settled_after_s.reset();
  EXPECT_FALSE(ratioOfQuantiles(quick, slow, 0.9));
  EXPECT_TRUE(ratioOfQuantiles(quick, slow, 0.3));
}

}  // namespace
}  // namespace vismem
