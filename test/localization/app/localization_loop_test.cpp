// Tests L2: the loop feeds the Localizer, publishes, and takes commands.
#include "localization/app/localization_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <condition_variable>

#include "common/geometry/angles.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

SegmentMap corner() {
  SegmentMap map;
  map.segments = {{{{0, 0, 0}, {4, 0, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 4, 0}}, "skirting", 0.0}};
  return map;
}

const Pose2 kTruth{1.5, 1.5, degToRad(-135)};

/// A source whose updates the test provides.
class ScriptedSource : public VisualMemorySource {
 public:
  MemoryResult next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout,
                      [&] { return result_.state != SourceState::kWaiting && !isOld(after_revision); });
    if (result_.state == SourceState::kRunning && isOld(after_revision))
      return {SourceState::kWaiting, {}, "none"};
    return result_;
  }
  void provide(std::uint64_t revision) {
    MemoryUpdate update =
        test::viewFrom(corner(), kTruth, static_cast<StampUs>(revision) * kSecondUs / 5, 0.0, degToRad(-20));
    auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
    snapshot->revision = revision;
    snapshot->T_odom_robot = update.analysis->T_odom_robot;
    update.snapshot = snapshot;
    set({SourceState::kRunning, std::move(update), ""});
  }
  void finish() { set({SourceState::kFinished, {}, "the end of the log"}); }

 private:
  bool isOld(std::uint64_t after_revision) const {
    return result_.update.snapshot && result_.update.snapshot->revision <= after_revision;
  }
  void set(MemoryResult result) {
    {
      const std::lock_guard lock(mutex_);
      result_ = std::move(result);
    }
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  MemoryResult result_;
};

/// What the loop publishes, with waits for it.
class LocalizationLoopTest : public testing::Test {
 protected:
  ~LocalizationLoopTest() override { loop_.stop(); }
  void start() {
    loop_.start(
        [this](const PoseEstimate& estimate, double) { note([&] { estimates_.push_back(estimate); }); },
        [this](SourceState state, const std::string& why) {
          note([&] { states_.emplace_back(state, why); });
        },
        [this](std::exception_ptr) { note([&] { failed_ = true; }); }, [] {});
  }
  template <typename Change>
  void note(Change change) {
    {
      const std::lock_guard lock(mutex_);
      change();
    }
    changed_.notify_all();
  }
  template <typename Condition>
  bool waitFor(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), condition);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<PoseEstimate> estimates_;
  std::vector<std::pair<SourceState, std::string>> states_;
  bool failed_ = false;
  ScriptedSource source_;
  LocalizationLoop loop_{Localizer(localizerPreset(LocalizationMode::kDefault), corner(), 1), source_};
};

TEST_F(LocalizationLoopTest, PublishesOneEstimatePerUpdate) {
  start();
  EXPECT_FALSE(loop_.newest().snapshot);
  for (std::uint64_t revision = 1; revision <= 3; ++revision) {
    source_.provide(revision);
    ASSERT_TRUE(waitFor([&] { return estimates_.size() == revision; }));
    EXPECT_EQ(estimates_.back().stamp_us, static_cast<StampUs>(revision) * kSecondUs / 5);
  }
  EXPECT_EQ(loop_.newest().snapshot->revision, 3u);
  EXPECT_FALSE(failed_);
}

TEST_F(LocalizationLoopTest, AGivenPoseReachesTheLocalizer) {
  start();
  source_.provide(1);
  ASSERT_TRUE(waitFor([&] { return !estimates_.empty(); }));
  ASSERT_TRUE(loop_.setPose(kTruth).ok());
  ASSERT_TRUE(waitFor([&] { return estimates_.size() == 2; })) << "published without a further update";
  ASSERT_TRUE(estimates_.back().T_world_robot);
  EXPECT_EQ(*estimates_.back().T_world_robot, kTruth);
  ASSERT_TRUE(loop_.relocalize().ok());
  ASSERT_TRUE(waitFor([&] { return estimates_.size() == 3; }));
  EXPECT_TRUE(estimates_.back().races.empty());
}

TEST_F(LocalizationLoopTest, ACommandBeforeTheFirstUpdateIsPublishedWithIt) {
  ASSERT_TRUE(loop_.setPose(kTruth).ok());
  start();
  source_.provide(1);
  ASSERT_TRUE(waitFor([&] { return !estimates_.empty(); }));
  EXPECT_EQ(estimates_.front().stamp_us, kSecondUs / 5);
  ASSERT_TRUE(estimates_.front().T_world_robot);
  EXPECT_LT((estimates_.front().T_world_robot->position() - kTruth.position()).norm(), 0.05);
}

TEST_F(LocalizationLoopTest, RejectsPosesThatAreNotFiniteAndAFullQueue) {
  EXPECT_EQ(loop_.setPose({std::nan(""), 0.0, 0.0}).message, "the pose is not finite");
  for (int i = 0; i < 16; ++i) EXPECT_TRUE(loop_.relocalize().ok()) << i;
  EXPECT_EQ(loop_.relocalize().message, "16 commands are waiting already");
}

TEST_F(LocalizationLoopTest, RejectsPosesOutsideTheMap) {
  // The map is a corner from (0, 0) to (4, 4).
  EXPECT_EQ(loop_.setPose({7.0, 1.5, 0.0}).message,
            "7 1.5 m lies outside the map (must be within -2..6, -2..6 m: its box and what lies beside it)");
  EXPECT_FALSE(loop_.setPose({1.0, -1e6, 0.0}).ok());
  EXPECT_TRUE(loop_.setPose({-1.9, 5.9, 0.0}).ok()) << "beside the map's edges";
}

TEST_F(LocalizationLoopTest, ReportsEachStateOfTheSourceOnce) {
  start();
  source_.provide(1);
  ASSERT_TRUE(waitFor([&] { return states_.size() == 1; }));
  EXPECT_EQ(states_[0].first, SourceState::kRunning);
  source_.provide(2);
  ASSERT_TRUE(waitFor([&] { return estimates_.size() == 2; }));
  source_.finish();
  ASSERT_TRUE(waitFor([&] { return states_.size() == 2; }));
  EXPECT_EQ(states_[1].first, SourceState::kFinished);
  EXPECT_EQ(states_[1].second, "the end of the log");
}

TEST_F(LocalizationLoopTest, PlansGazeForEveryUpdate) {
  int plans = 0;
  loop_.seekGaze(GazePlanner({}, {}, {}, corner()),
                 [&](const GazePlan& plan, double) { note([&] { plans += plan.request.has_value(); }); });
  start();
  source_.provide(1);
  ASSERT_TRUE(waitFor([&] { return plans == 1; })) << "the first pose is uncertain";
  loop_.stop();
}

}  // namespace
}  // namespace vismem
