// Tests L11.
#include "evaluation/core/metrics.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// A robot that drives along x at 1 m/s from 0 to `seconds`, sampled every 0.1 s.
Trajectory straightDrive(double seconds) {
  Trajectory truth;
  for (int i = 0; i <= static_cast<int>(seconds * 10 + 0.5); ++i)
    truth.push_back({i * 100'000, {0.1 * i, 0.0, 0.0}});
  return truth;
}

/// Estimates every 0.2 s whose error the caller decides.
template <typename ErrorAt>
std::vector<PublishedPose> published(double seconds, ErrorAt error_at) {
  std::vector<PublishedPose> poses;
  for (int i = 0; i <= static_cast<int>(seconds * 5 + 0.5); ++i) {
    const double t = 0.2 * i;
    PublishedPose p{i * 200'000, std::nullopt, 1.0};
    if (const std::optional<Pose2> error = error_at(t))
      p.T_world_robot = Pose2{t + error->x, error->y, error->theta};
    poses.push_back(p);
  }
  return poses;
}

TEST(Metrics, SettlesAtTheFirstOfTwoSecondsOfRightPoses) {
  // Wrong until 1 s, right from 1 s to 2 s, wrong again until 4 s, then right with 0.1 m and 2 degrees to 10
  // s.
  const auto poses = published(10.0, [](double t) -> std::optional<Pose2> {
    const bool wrong = t < 0.99 || (t > 2.01 && t < 3.99);
    return wrong ? Pose2{3.0, 0.0, 0.0} : Pose2{0.0, 0.1, degToRad(2.0)};
  });
  const LocalizationScore score = scoreLocalization(poses, straightDrive(10.0));
  ASSERT_TRUE(score.settled_after_s);
  EXPECT_NEAR(*score.settled_after_s, 4.0, 1e-9);
  EXPECT_NEAR(*score.position_error_m, 0.1, 1e-9);
  EXPECT_NEAR(*score.heading_error_rad, degToRad(2.0), 1e-9);
  EXPECT_TRUE(score.recovered);
  EXPECT_EQ(score.errors.size(), 51u);
  // Wrong at 0 to 0.8 s and at 2.2 to 3.8 s: 5 and 9 poses.
  EXPECT_NEAR(score.right_share.value(), 37.0 / 51.0, 1e-9);
  EXPECT_NEAR(score.median_position_error_m.value(), 0.1, 1e-9);
  EXPECT_NEAR(score.median_heading_error_rad.value(), degToRad(2.0), 1e-9);
}

TEST(Metrics, CountsLossesAfterSettling) {
  // Right with 0.1 m from 0 to 8 s (40 poses), 2.1 m off from 8 s to 10 s (11 poses):
  // (40 * 0.1 + 11 * 2.1) / 51 = 27.1 / 51.
  const auto poses = published(10.0, [](double t) -> std::optional<Pose2> {
    return Pose2{0.0, t < 7.99 ? 0.1 : 2.1, 0.0};
  });
  const LocalizationScore score = scoreLocalization(poses, straightDrive(10.0));
  ASSERT_TRUE(score.position_error_m);
  EXPECT_NEAR(*score.position_error_m, 27.1 / 51.0, 1e-9);
  EXPECT_FALSE(score.recovered) << "it ended wrong";
}

TEST(Metrics, ErrorsCountAgainstTheNearestSymmetricTwin) {
  // The half turn about (5, 0) maps the drive's places p to (10, 0) - p.
  const Pose2 half_turn{10.0, 0.0, degToRad(180.0)};
  auto poses = published(10.0, [](double) -> std::optional<Pose2> { return Pose2{0.0, 0.1, 0.0}; });
  for (PublishedPose& p : poses) p.T_world_robot = half_turn * *p.T_world_robot;
  EXPECT_FALSE(scoreLocalization(poses, straightDrive(10.0)).recovered);
  ScoreParams params;
  params.symmetries = {half_turn};
  const LocalizationScore score = scoreLocalization(poses, straightDrive(10.0), {}, params);
  EXPECT_TRUE(score.recovered);
  EXPECT_TRUE(score.is_twin);
  EXPECT_NEAR(score.position_error_m.value(), 0.1, 1e-9);
}

TEST(Metrics, AJumpToTheTwinWithoutAKidnappingIsAnError) {
  const Pose2 half_turn{10.0, 0.0, degToRad(180.0)};
  auto poses = published(10.0, [](double) -> std::optional<Pose2> { return Pose2{}; });
  for (PublishedPose& p : poses) {
    if (p.stamp_us > 7 * kSecondUs) p.T_world_robot = half_turn * *p.T_world_robot;
  }
  ScoreParams params;
  params.symmetries = {half_turn};
  EXPECT_FALSE(scoreLocalization(poses, straightDrive(10.0), {}, params).recovered);
  EXPECT_TRUE(scoreLocalization(poses, straightDrive(10.0), {7 * kSecondUs}, params).recovered);
}

TEST(Metrics, HeadingAloneMakesAPoseWrong) {
  const auto poses = published(5.0, [](double) -> std::optional<Pose2> {
    return Pose2{0.0, 0.0, degToRad(16.0)};
  });
  const LocalizationScore score = scoreLocalization(poses, straightDrive(5.0));
  EXPECT_FALSE(score.settled_after_s);
  EXPECT_FALSE(score.position_error_m);
  EXPECT_FALSE(score.recovered);
  EXPECT_NEAR(*score.errors.front().heading_rad, degToRad(16.0), 1e-9);
}

TEST(Metrics, NeverRightForTwoSecondsIsNotSettled) {
  // Right for 1.8 s of every 2 s.
  const auto poses = published(20.0, [](double t) -> std::optional<Pose2> {
    return Pose2{std::fmod(t + 1e-6, 2.0) < 1.79 ? 0.0 : 1.0, 0.0, 0.0};
  });
  EXPECT_FALSE(scoreLocalization(poses, straightDrive(20.0)).settled_after_s);
}

TEST(Metrics, AMissingPoseCountsAsTheLastOneHeld) {
  // Perfect until 4 s, then no pose: the robot drives on, the held pose falls behind by 0.2 m per image.
  // From 0 to 3.8 s 20 zero errors, then t - 3.8 for 4.0, 4.2 ... 5.0: 0.2+0.4+...+1.2 = 4.2 over 26.
  const auto poses = published(5.0, [](double t) -> std::optional<Pose2> {
    if (t > 3.99) return std::nullopt;
    return Pose2{};
  });
  const LocalizationScore score = scoreLocalization(poses, straightDrive(5.0));
  EXPECT_EQ(score.without_pose, 6);
  ASSERT_TRUE(score.position_error_m);
  EXPECT_NEAR(*score.position_error_m, 4.2 / 26.0, 1e-9);
  EXPECT_FALSE(score.recovered);
}

TEST(Metrics, SilenceIsFilledWithTheHeldPose) {
  // Perfect poses from 0 to 3 s (16), then silence to 10 s: filled at 4, 5 ... 9 s with errors 1, 2 ... 6 m.
  const auto poses = published(3.0, [](double) -> std::optional<Pose2> { return Pose2{}; });
  const LocalizationScore score = scoreLocalization(poses, straightDrive(10.0));
  ASSERT_TRUE(score.position_error_m);
  EXPECT_NEAR(*score.position_error_m, 21.0 / 22.0, 1e-9);
  EXPECT_FALSE(score.recovered) << "it had stopped speaking";
}

TEST(Metrics, ASilenceBreaksTheRowOfRightPoses) {
  std::vector<PublishedPose> poses;
  for (const StampUs t : {0, 500'000, 1'000'000, 2'500'000, 3'000'000, 3'500'000}) {
    poses.push_back({t, Pose2{toSeconds(t), 0.0, 0.0}, 1.0});
  }
  EXPECT_FALSE(scoreLocalization(poses, straightDrive(4.0)).settled_after_s);
}

TEST(Metrics, InterpolatesTheTruthAtThePosesStamp) {
  // Truth at 0 and 1 s; a pose at 0.25 s at x = 0.25 has no error.
  const Trajectory truth{{0, {0.0, 0.0, 0.0}}, {kSecondUs, {1.0, 0.0, 0.2}}};
  const LocalizationScore score = scoreLocalization({{250'000, Pose2{0.25, 0.0, 0.05}, 1.0}}, truth);
  ASSERT_EQ(score.errors.size(), 1u);
  EXPECT_NEAR(*score.errors[0].position_m, 0.0, 1e-12);
  EXPECT_NEAR(*score.errors[0].heading_rad, 0.0, 1e-12);
}

TEST(Metrics, RecoveryMeansSettlingAgainAfterTheLastKidnap) {
  const auto recovers = published(20.0, [](double t) -> std::optional<Pose2> {
    return Pose2{t > 10.0 && t < 15.0 ? 4.0 : 0.0, 0.0, 0.0};
  });
  EXPECT_TRUE(scoreLocalization(recovers, straightDrive(20.0), {10 * kSecondUs}).recovered);
  // Right again only 1 s before the end: not yet settled again.
  const auto too_late = published(20.0, [](double t) -> std::optional<Pose2> {
    return Pose2{t > 10.0 && t < 18.99 ? 4.0 : 0.0, 0.0, 0.0};
  });
  EXPECT_FALSE(scoreLocalization(too_late, straightDrive(20.0), {10 * kSecondUs}).recovered);
}

TEST(Metrics, WithoutTruthThereIsNoScore) {
  const auto poses = published(1.0, [](double) -> std::optional<Pose2> { return Pose2{}; });
  const LocalizationScore score = scoreLocalization(poses, {});
  EXPECT_EQ(score.without_truth, 6);
  EXPECT_FALSE(score.settled_after_s);
}

TEST(Metrics, MedianOfOddAndEvenCounts) {
  EXPECT_EQ(median({}), std::nullopt);
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5);
}

}  // namespace
}  // namespace vismem
