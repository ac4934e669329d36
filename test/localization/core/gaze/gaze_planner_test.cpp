// Tests B4, A6.
#include "localization/core/gaze/gaze_planner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

/// A corridor with a door to the right ahead of `kHere`, and none there ahead of `kThere`.
SegmentMap corridor() {
  SegmentMap map;
  const auto add = [&map](double x1, double y, double x2, const char* label) {
    map.segments.push_back({{{x1, y, 0.0}, {x2, y, 0.0}}, label, 0.0});
  };
  add(-12, 0.75, 12, "skirting");
  add(-12, -0.75, 3.1, "skirting");
  add(3.1, -0.75, 3.9, "door_foot");
  add(3.9, -0.75, 12, "skirting");
  return map;
}
const Pose2 kHere{2, 0, 0};
const Pose2 kThere{-8, 0, 0};

PoseEstimate estimateOf(double weight_here, double health, double support) {
  PoseEstimate estimate;
  estimate.P = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
  estimate.support = support;
  RaceReport here;
  here.T_world_robot = kHere;
  here.weight = weight_here;
  here.health = health;
  here.winner = true;
  RaceReport there = here;
  there.T_world_robot = kThere;
  there.weight = 1.0 - weight_here;
  there.winner = false;
  estimate.races = {here, there};
  estimate.T_world_robot = kHere;
  return estimate;
}
const PoseEstimate kCertain = estimateOf(1.0, 0.95, 0.95);
const PoseEstimate kAmbiguous = estimateOf(0.5, 0.9, 0.5);

/// Images of a robot at the origin of odom.
class GazePlannerTest : public testing::Test {
 protected:
  GazePlan see(const PoseEstimate& estimate, double pan_rad, double tilt_rad) {
    stamp_us_ += kSecondUs / 10;
    MemoryUpdate update = test::viewFrom(map_, kHere, stamp_us_, pan_rad, tilt_rad);
    auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
    snapshot->epoch = epoch_;
    update.snapshot = snapshot;
    return planner_.plan(estimate, update);
  }
  GazePlan seeAhead(const PoseEstimate& estimate) { return see(estimate, 0.0, degToRad(-15)); }
  /// An image in the requested direction.
  GazePlan seeRequested(const PoseEstimate& estimate) {
    const PanTilt at = planner_.requested() ? planner_.requested()->direction : PanTilt{0.0, degToRad(-15)};
    return see(estimate, at.pan_rad, at.tilt_rad);
  }

  const SegmentMap map_ = corridor();
  GazePlannerParams params_;
  GazePlanner planner_{params_, {}, {}, map_};
  StampUs stamp_us_ = kSecondUs;
  std::uint32_t epoch_ = 0;
};

TEST_F(GazePlannerTest, ACertainPoseRequestsNothing) {
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(seeAhead(kCertain).isEmpty());
  EXPECT_FALSE(planner_.requested());
}

TEST_F(GazePlannerTest, UncertaintyIsTheComplementOfBeliefTimesReliability) {
  // Reliability 0.95, belief 1, good health.
  EXPECT_NEAR(GazePlanner::uncertainty(kCertain), 0.05, 1e-9);
  EXPECT_NEAR(GazePlanner::uncertainty(kAmbiguous), 0.75, 1e-9);
  EXPECT_EQ(GazePlanner::uncertainty(PoseEstimate{}), 1.0);
  // Low health raises uncertainty at once, at any support.
  EXPECT_GT(GazePlanner::uncertainty(estimateOf(1.0, 0.2, 0.95)), 0.6);
}

TEST_F(GazePlannerTest, ARequestHasAPlaceAPriorityAndADeadline) {
  const GazePlan plan = seeAhead(kAmbiguous);
  ASSERT_TRUE(plan.request);
  EXPECT_FALSE(plan.withdrawn);
  const GazeRequest& request = *plan.request;
  EXPECT_EQ(request.client, kGazeClientName);
  EXPECT_FALSE(request.key.empty());
  ASSERT_TRUE(request.p_odom);
  EXPECT_FALSE(request.direction);
  // Uncertainty 0.75: three quarters from the least to the most priority, which is urgent.
  EXPECT_NEAR(request.priority, 50.0 + 0.75 * 50.0, 1e-6);
  EXPECT_GE(request.priority, kUrgentPriority);
  EXPECT_EQ(request.deadline_us, stamp_us_ + toStampUs(params_.deadline_s));
  // One at a time.
  EXPECT_TRUE(seeAhead(kAmbiguous).isEmpty() || planner_.requested());
}

TEST_F(GazePlannerTest, ARequestMovesOnWithTheSameKey) {
  const GazePlan asked = seeAhead(kAmbiguous);
  ASSERT_TRUE(asked.request);
  const GazeAdvice first = *planner_.requested();
  GazePlan plan;
  for (int image = 0; image < 20 && plan.isEmpty(); ++image) plan = seeRequested(kAmbiguous);
  // The direction loses novelty, and the request moves with its key, which keeps its salience.
  ASSERT_TRUE(plan.request);
  EXPECT_FALSE(plan.withdrawn);
  EXPECT_EQ(plan.request->key, asked.request->key);
  const GazeAdvice second = *planner_.requested();
  EXPECT_GT(std::abs(angleDifference(first.direction.pan_rad, second.direction.pan_rad)),
            params_.move_rad - 1e-9);
}

TEST_F(GazePlannerTest, ARequestIsRenewedBeforeItsDeadline) {
  StampUs deadline_us = 0;
  for (int image = 0; image < 60; ++image) {
    if (const GazePlan plan = seeRequested(kAmbiguous); plan.request) deadline_us = plan.request->deadline_us;
    ASSERT_GT(deadline_us, stamp_us_);
  }
}

TEST_F(GazePlannerTest, ADirectionThatIsNotReachedIsAbandoned) {
  const double away = degToRad(-150);
  see(kAmbiguous, away, degToRad(-15));
  ASSERT_TRUE(planner_.requested());
  const GazeAdvice first = *planner_.requested();
  ASSERT_GT(std::abs(angleDifference(first.direction.pan_rad, away)), params_.seen_rad);
  const StampUs begun_us = stamp_us_;
  const auto isElsewhere = [&] {
    const double moved = angleDifference(planner_.requested()->direction.pan_rad, first.direction.pan_rad);
    return std::abs(moved) > degToRad(20);
  };
  // The camera does not turn: a stuck unit, or a more urgent client.
  for (int image = 0; image < 100 && !isElsewhere(); ++image) see(kAmbiguous, away, degToRad(29));
  EXPECT_TRUE(isElsewhere());
  EXPECT_LE(toSeconds(stamp_us_ - begun_us), 2.0 * params_.deadline_s);
}

TEST_F(GazePlannerTest, TheRequestEndsAfterASecondOfCertainPoses) {
  seeAhead(kAmbiguous);
  ASSERT_TRUE(planner_.requested());
  const StampUs uncertain_us = stamp_us_;
  GazePlan plan;
  for (int image = 0; image < 100 && planner_.requested(); ++image) plan = seeRequested(kCertain);
  EXPECT_FALSE(planner_.requested());
  EXPECT_TRUE(plan.withdrawn);
  EXPECT_NEAR(toSeconds(stamp_us_ - uncertain_us), params_.confirm_s, 0.11);
  EXPECT_TRUE(seeAhead(kCertain).isEmpty());
}

TEST_F(GazePlannerTest, ANewEpochWithdrawsTheRequest) {
  seeAhead(kAmbiguous);
  const std::string key = [&] {
    GazePlan plan;
    epoch_ = 1;
    plan = seeAhead(kAmbiguous);
    EXPECT_TRUE(plan.withdrawn);
    EXPECT_TRUE(plan.request);  // places in the old odom frame are invalid
    return plan.request ? plan.request->key : std::string();
  }();
  EXPECT_FALSE(key.empty());
  // A restarted source, whose stamps went back.
  stamp_us_ = 0;
  const GazePlan plan = seeAhead(kAmbiguous);
  ASSERT_TRUE(plan.request);
  EXPECT_LT(plan.request->deadline_us, 5 * kSecondUs);
}

TEST_F(GazePlannerTest, DirectionsStayInsideTheLimitsOfTheHead) {
  for (int i = 0; i < 30; ++i) {
    if (planner_.requested()) {
      const PanTilt at = planner_.requested()->direction;
      EXPECT_LE(std::abs(at.pan_rad), params_.advisor.maximum_pan_rad + 1e-9);
      EXPECT_GE(at.tilt_rad, params_.advisor.minimum_tilt_rad - 1e-9);
      EXPECT_LE(at.tilt_rad, params_.advisor.maximum_tilt_rad + 1e-9);
      seeRequested(kAmbiguous);
    } else {
      seeAhead(kAmbiguous);
    }
  }
}

class RecordingClient : public GazeClient {
 public:
  PortReply setMode(GazeMode) override { return PortReply::accepted(); }
  PortReply fixate(const Eigen::Vector3d&) override { return PortReply::accepted(); }
  PortReply request(const GazeRequest& request) override {
    calls.push_back("request " + request.key);
    return accepts ? PortReply::accepted() : PortReply::rejected("no");
  }
  PortReply withdraw(const std::string& client, const std::string& key) override {
    calls.push_back("withdraw " + key);
    EXPECT_EQ(client, kGazeClientName);
    return PortReply::accepted();
  }
  std::optional<GazeStatus> status() override { return std::nullopt; }
  std::vector<std::string> calls;
  bool accepts = true;
};

TEST(GazePlan, WithdrawsBeforeItRequestsAndCountsRejections) {
  GazePlan plan;
  plan.withdrawn = "a";
  plan.request.emplace().key = "b";
  RecordingClient client;
  EXPECT_EQ(carryOut(plan, client), 0);
  EXPECT_EQ(client.calls, (std::vector<std::string>{"withdraw a", "request b"}));
  client.accepts = false;
  EXPECT_EQ(carryOut(plan, client), 1);
}

}  // namespace
}  // namespace vismem
