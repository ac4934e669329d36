// Tests C3, C4: localization over a real connection.
#include "localization/ice/localization_ice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <limits>
#include <numbers>
#include <set>

#include "localization/ice/map_ice.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PoseEstimate estimateWith(std::uint64_t revision) {
  PoseEstimate estimate;
  estimate.stamp_us = 1000;
  estimate.revision = revision;
  estimate.T_world_robot = Pose2{1.5, -2, std::numbers::pi / 2};
  estimate.T_odom_robot = {3, 4, 0.25};
  estimate.P << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  estimate.reliability = 0.75;
  estimate.races = {{7, {1.5, -2, 0.5}, 0.9, 0.8, 12, 34, true}, {8, {0, 0, 0}, 0.4, 0.2, 1, 2, false}};
  return estimate;
}

TEST(LocalizationConversions, EveryFieldComesBack) {
  const PoseEstimate original = estimateWith(5);
  const PoseEstimate back = fromIce(toIce(original));
  EXPECT_EQ(back.stamp_us, 1000);
  EXPECT_EQ(back.revision, 5U);
  EXPECT_EQ(back.T_world_robot, original.T_world_robot);
  EXPECT_EQ(back.T_odom_robot, original.T_odom_robot);
  EXPECT_EQ(back.P, original.P);
  EXPECT_EQ(back.reliability, 0.75);
  ASSERT_EQ(back.races.size(), 2U);
  EXPECT_EQ(back.races[0].id, 7U);
  EXPECT_EQ(back.races[0].T_world_robot, original.races[0].T_world_robot);
  EXPECT_EQ(back.races[0].health, 0.9);
  EXPECT_EQ(back.races[0].weight, 0.8);
  EXPECT_EQ(back.races[0].victories, 12);
  EXPECT_EQ(back.races[0].age, 34);
  EXPECT_TRUE(back.races[0].winner);
  EXPECT_FALSE(back.races[1].winner);
  PoseEstimate none;
  EXPECT_FALSE(fromIce(toIce(none)).T_world_robot);
}

/// A heading of 90 degrees is the quaternion (cos 45, 0, 0, sin 45).
TEST(LocalizationConversions, JdeRobotsPoseIsAQuaternionWithWFirst) {
  const jderobot::Pose3DData data = toPose3D({1.5, -2, std::numbers::pi / 2}, 1.0);
  EXPECT_FLOAT_EQ(data.x, 1.5F);
  EXPECT_FLOAT_EQ(data.y, -2.F);
  EXPECT_FLOAT_EQ(data.h, 1.F);
  EXPECT_NEAR(data.q0, std::sqrt(0.5), 1e-6);
  EXPECT_EQ(data.q1, 0.F);
  EXPECT_EQ(data.q2, 0.F);
  EXPECT_NEAR(data.q3, std::sqrt(0.5), 1e-6);
  EXPECT_FLOAT_EQ(toPose3D({1.5, 0, 0}, 1000.0).x, 1500.F);
  for (double heading = -3.0; heading < 3.1; heading += 0.5) {
    const auto back = fromPose3D(toPose3D({0.25, 4, heading}, 1000.0), 1000.0);
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->x, 0.25, 1e-6);
    EXPECT_NEAR(back->theta, heading, 1e-5);  // floats on the wire
  }
}

TEST(LocalizationConversions, RefusesAQuaternionThatIsNoRotation) {
  jderobot::Pose3DData data = toPose3D({}, 1.0);
  data.q0 = 0;
  EXPECT_FALSE(fromPose3D(data, 1.0));
  data.q0 = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(fromPose3D(data, 1.0));
  data = toPose3D({}, 1.0);
  data.x = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(fromPose3D(data, 1.0));
}

TEST(MapIds, DifferForMapsThatDiffer) {
  const SegmentMap map{{{{{1, 2, 0}, {3, 4, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 1, 0}}, "line", 0.05}}};
  EXPECT_EQ(mapId(map), mapId(SegmentMap(map)));
  std::set<std::string> ids{mapId(map)};
  const auto changed = [&](auto&& change) {
    SegmentMap other = map;
    change(other.segments);
    ids.insert(mapId(other));
  };
  changed([](auto& s) { s[0].world.a.x() = std::nextafter(1.0, 2.0); });
  changed([](auto& s) { s[0].label = "skirtin"; });
  changed([](auto& s) { s[1].width_m = 0.06; });
  changed([](auto& s) { s.pop_back(); });
  changed([](auto& s) { std::swap(s[0], s[1]); });
  EXPECT_EQ(ids.size(), 6u);
}

class LocalizationLoopback : public ::testing::Test, public PoseCommands, public HealthMapSource {
 protected:
  LocalizationLoopback() {
    server.add("Localization", std::make_shared<LocalizationServant>(*this, estimates, *this, map));
    server.activate();
  }
  ~LocalizationLoopback() override { estimates.stop(); }

  void publish(std::uint64_t revision) {
    estimates.publish(std::make_shared<const PoseEstimate>(estimateWith(revision)),
                      static_cast<std::int64_t>(revision));
  }
  PortReply setPose(const Pose2& pose) override {
    if (pose.x > 100) return PortReply::rejected("outside the map");
    place = pose;
    return PortReply::accepted();
  }
  PortReply relocalize() override {
    ++relocalizations;
    return PortReply::accepted();
  }
  std::string check(const HealthMapRequest& request) const override {
    return request.cell_m > 0.0 ? "" : "cell_m = 0 (must be > 0)";
  }
  PortReply draw(const HealthMapRequest& request, Done done) override {
    drawn = request;
    if (request.headings == 3) return PortReply::rejected("4 health maps are waiting already");
    if (request.headings == 2) {
      done(std::nullopt, "no observation yet");
    } else {
      done(health_map, {});
    }
    return PortReply::accepted();
  }
  std::shared_ptr<avm::LocalizationPrx> proxy() {
    return client.proxy<avm::LocalizationPrx>("Localization", server.port());
  }

  LatestEstimate estimates{"no estimate yet"};
  const SegmentMap map_of_two{
      {{{{1, 2, 0}, {3, 4, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 1, 0}}, "line", 0.05}}};
  avm::MapContents map = toIce(map_of_two, "two.csv");
  Pose2 place;
  int relocalizations = 0;
  HealthMapRequest drawn;
  HealthMap health_map{77, {1, -2}, 0.5, 2, 1, {0.25F, 1.0F}, {-3.0F, 0.5F}};
  LoopbackServer server;
  LoopbackClient client;
};

TEST_F(LocalizationLoopback, GivesTheNewestEstimateOnce) {
  RemoteLocalization remote(proxy());
  EXPECT_FALSE(remote.latest());
  EXPECT_FALSE(remote.next(0, 10ms));
  publish(1);
  ASSERT_TRUE(remote.latest());
  EXPECT_EQ(remote.latest()->revision, 1U);
  EXPECT_EQ(remote.next(0, 2s)->revision, 1U);
  EXPECT_FALSE(remote.next(1, 10ms));
  publish(2);
  EXPECT_EQ(remote.next(1, 2s)->revision, 2U);
  // A restarted server counts from the beginning.
  EXPECT_EQ(remote.next(900, 2s)->revision, 2U);
  EXPECT_EQ(estimates.waitOther(900, 0ms).value->revision, 2U);
  EXPECT_FALSE(estimates.waitOther(2, 0ms).value);
}

TEST_F(LocalizationLoopback, CommandsAreTakenOrRefusedWithAReason) {
  RemoteLocalization remote(proxy());
  EXPECT_TRUE(remote.setPose({1, 2, 3}).ok());
  EXPECT_EQ(place, (Pose2{1, 2, 3}));
  EXPECT_EQ(remote.setPose({101, 0, 0}).message, "outside the map");
  EXPECT_THAT(remote.setPose({0, kNaN, 0}).message, HasSubstr("robotInWorld.y = nan (must be finite)"));
  EXPECT_TRUE(remote.relocalize().ok());
  EXPECT_EQ(relocalizations, 1);
}

TEST_F(LocalizationLoopback, HealthMapsAreReturnedOrRefusedWithAReason) {
  RemoteLocalization remote(proxy());
  HealthMapRequest request;
  request.rating = PlaceRating::kLikelihood;
  request.theta_rad = 0.25;
  request.cell_m = 0.5;
  request.low = {1, -2};
  request.high = {2, -2};
  const auto result = remote.healthMap(request);
  ASSERT_TRUE(result.map) << result.why;
  EXPECT_EQ(drawn.rating, PlaceRating::kLikelihood);
  EXPECT_EQ(drawn.theta_rad, 0.25);
  EXPECT_EQ(drawn.headings, 36);
  EXPECT_EQ(drawn.cell_m, 0.5);
  EXPECT_EQ(*drawn.low, Eigen::Vector2d(1, -2));
  EXPECT_EQ(*drawn.high, Eigen::Vector2d(2, -2));
  EXPECT_EQ(result.map->stamp_us, 77);
  EXPECT_EQ(result.map->low, Eigen::Vector2d(1, -2));
  EXPECT_EQ(result.map->cell_m, 0.5);
  EXPECT_EQ(result.map->columns, 2);
  EXPECT_EQ(result.map->rows, 1);
  EXPECT_EQ(result.map->health, health_map.health);
  EXPECT_EQ(result.map->theta_rad, health_map.theta_rad);
  // A request without heading and area.
  EXPECT_TRUE(remote.healthMap({}).map);
  EXPECT_FALSE(drawn.theta_rad || drawn.low || drawn.high);
  request.cell_m = 0.0;
  EXPECT_THAT(remote.healthMap(request).why, HasSubstr("cell_m = 0 (must be > 0)"));
  request.cell_m = 0.5;
  request.headings = 2;
  EXPECT_THAT(remote.healthMap(request).why, HasSubstr("no observation yet"));
  request.headings = 3;
  EXPECT_THAT(remote.healthMap(request).why, HasSubstr("4 health maps are waiting already"));
  // A server with an inconsistent answer.
  health_map.rows = 2;
  EXPECT_THAT(remote.healthMap({}).why, HasSubstr("invalid health map"));
}

TEST_F(LocalizationLoopback, GivesItsMap) {
  const auto contents = proxy()->getMap();
  EXPECT_EQ(contents.id, mapId(map_of_two));
  EXPECT_EQ(contents.name, "two.csv");
  ASSERT_EQ(contents.segments.size(), 2u);
  EXPECT_EQ(contents.segments[0].label, "skirting");
  EXPECT_EQ(contents.segments[0].a.y, 2.0);
  EXPECT_EQ(contents.segments[0].b.x, 3.0);
  EXPECT_EQ(contents.segments[1].widthM, 0.05);
}

TEST_F(LocalizationLoopback, ServesJdeRobotsPose3D) {
  const auto pose = Ice::checkedCast<jderobot::Pose3DPrx>(proxy());
  ASSERT_TRUE(pose);
  EXPECT_THROW(pose->getPose3DData(), Ice::UnknownException);
  publish(1);
  EXPECT_FLOAT_EQ(pose->getPose3DData()->x, 1.5F);
  auto wanted = std::make_shared<jderobot::Pose3DData>(toPose3D({4, 5, -0.5}, 1.0));
  EXPECT_EQ(pose->setPose3DData(wanted), 0);
  EXPECT_NEAR(place.theta, -0.5, 1e-6);
  EXPECT_EQ(pose->setPose3DData(nullptr), -1);
  wanted->x = 1e6F;
  EXPECT_EQ(pose->setPose3DData(wanted), -1);
}

TEST_F(LocalizationLoopback, StopAnswersWaitingRequests) {
  std::promise<avm::SourceState> state;
  proxy()->nextAsync(0, [&](avm::EstimateResult result) { state.set_value(result.state); });
  ASSERT_TRUE(eventually([&] { return estimates.waiting() == 1; }));
  estimates.stop();
  EXPECT_EQ(state.get_future().get(), avm::SourceState::Waiting);
}

TEST_F(LocalizationLoopback, AnAbsentPeerGivesNoException) {
  std::string failure;
  RemoteLocalization remote(client.proxy<avm::LocalizationPrx>("Localization", 1),
                            [&](const std::string& why) { failure = why; });
  EXPECT_FALSE(remote.latest());
  EXPECT_FALSE(remote.next(0, 300ms));
  EXPECT_THAT(failure, HasSubstr("refused"));
  EXPECT_THAT(remote.relocalize().message, HasSubstr("refused"));
}

}  // namespace
}  // namespace vismem
