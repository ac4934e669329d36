// Scenarios: their format with its messages, and the execution of their events (docs/scenarios.md).
#include "simulator/core/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"
#include "simulator/core/simulation.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> problemsOf(std::string_view text) {
  try {
    parseScenario(text, "s");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(Scenario, ReadsEveryKindOfLine) {
  const Scenario scenario = parseScenario(R"(# a comment
scenario 1
object crate shape=box size_m=0.4,0.5,0.6 color=1,0.5,0   # another
object visitor shape=robot

at 5 remove crate
at 2.5 place crate at_m=1,2,0.5 heading_deg=90
at 3 walk visitor way=once speed_mps=0.7 points_m=0,0;1,0;1,2
at 4 stand visitor
at 6 kidnap at_m=-1,2 heading_deg=-90
at 7 slip left_m=0.05
at 0 drive way=closed speed_mps=0.25 points_m=0,0;2,0;2,2
at 9 halt
)",
                                          "s");
  EXPECT_EQ(scenario.objects.at("crate").size_m, Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(scenario.objects.at("visitor").kind, PropShape::Kind::kRobot);
  ASSERT_EQ(scenario.events.size(), 8U);
  EXPECT_EQ(scenario.events[0].kind, ScenarioEvent::Kind::kDrive) << "by time";
  EXPECT_TRUE(scenario.events[0].way.closed);
  const auto& place = scenario.events[1];
  EXPECT_EQ(place.model, "crate");
  EXPECT_EQ(place.line, 7);
  EXPECT_TRUE(place.T_world_model.isApprox(poseFromXyzRpy(1, 2, 0.5, 0, 0, std::numbers::pi / 2), 1e-12));
  EXPECT_EQ(scenario.events[2].way.at_end, WayEnd::kStand);
  EXPECT_EQ(scenario.events[2].way.points.size(), 3U);
  EXPECT_NEAR(scenario.events[5].T_world_robot.theta, -std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(scenario.events[6].slip.left, 0.05);
  EXPECT_EQ(scenario.events[6].slip.right, 0.0);
}

TEST(Scenario, ModelsMayBeTilted) {
  const Scenario scenario = parseScenario("scenario 1\nat 1 place a at_m=1,2,3 rotation_deg=10,-20,30\n", "s");
  const double degree = std::numbers::pi / 180.0;
  EXPECT_TRUE(scenario.events[0].T_world_model.isApprox(
      poseFromXyzRpy(1, 2, 3, 10 * degree, -20 * degree, 30 * degree), 1e-12));
  EXPECT_THAT(problemsOf("scenario 1\nat 1 place a at_m=1,2 heading_deg=3 rotation_deg=1,2,3\n"),
              ElementsAre("s:2: heading_deg and rotation_deg (only one of them can be)"));
  EXPECT_THAT(problemsOf("scenario 1\nat 1 place a at_m=1,2 rotation_deg=1,2\n"),
              ElementsAre("s:2: rotation_deg=1,2 (must be 3 numbers joined by ',' -360..360)"));
}

TEST(Scenario, NamesEveryMistakeWithItsLine) {
  EXPECT_THAT(problemsOf(""), ElementsAre("s: empty (the first line must be: scenario 1)"));
  EXPECT_THAT(problemsOf("scenario 2\n"),
              ElementsAre("s:1: \"scenario 2\" (the first line must be: scenario 1)"));
  EXPECT_THAT(
      problemsOf("scenario 1\n"
                 "at x remove a\n"
                 "at 1 remov a\n"
                 "at 1 remove\n"
                 "at 1 kidnap heading_deg=1\n"
                 "at 1 kidnap at_m=1,nan\n"
                 "at 1 kidnap at_m=1,2 headin_deg=4\n"
                 "at 1 walk a points_m=0,0;0,0.01\n"
                 "at 1 walk a way=round points_m=0,0;1,b\n"
                 "object a shape=box size_m=1,0,1\n"
                 "object a\n"
                 "at 1 slip left_m=1e99 left_m=1\n"
                 "at 1 drive speed_mps=-1\n"
                 "go\n"),
      ElementsAre(
          "s:2: \"at x remove a\" (must be: object NAME ..., or: at SECONDS VERB ..., with 0 to 1000000 "
          "seconds)",
          "s:3: unknown verb \"remov\" (did you mean \"remove\"?)",
          "s:4: \"at 1 remove\" (must be: at SECONDS remove NAME ...)", "s:5: no at_m (expected at_m=x,y)",
          "s:6: at_m=1,nan (must be 2 numbers joined by ',' -10000..10000)",
          "s:7: unknown key \"headin_deg\" (did you mean \"heading_deg\"?)",
          "s:8: way-point 1 (must be 0.05 m or more from the next)",
          "s:9: way=round (must be one of closed, once, open)",
          "s:9: points_m: \"1,b\" (must be x,y, each -10000..10000; points are joined by ';')",
          "s:10: size 1 0 1 m (each must be above 0, at most 50)", "s:11: object \"a\" (was declared before)",
          "s:12: \"left_m=1\" (its key stands there twice)", "s:12: left_m=1e99 (must be 1 number -1..1)",
          "s:13: speed_mps=-1 (must be 1 number 0.01..10)",
          "s:13: no points_m (expected points_m=x,y;x,y...)",
          "s:14: \"go\" (must be: object NAME ..., or: at SECONDS VERB ..., with 0 to 1000000 seconds)"));
}

/// A wide floor with nothing on it but a far wall that can be taken away.
SimulationConfig onAFloor() {
  SimulationConfig config;
  const auto slab = [](const std::string& name, const Eigen::Vector3d& size, const Pose3& pose) {
    WorldModel model;
    model.name = name;
    model.pose = pose;
    WorldBody body;
    body.name = "link/visual";
    const Eigen::Vector3f h = (0.5 * size).cast<float>();
    for (const float x : {-1.0f, 1.0f})
      for (const float y : {-1.0f, 1.0f})
        for (const float z : {-1.0f, 1.0f}) body.vertices.emplace_back(x * h.x(), y * h.y(), z * h.z());
    body.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    model.bodies.push_back(std::move(body));
    return model;
  };
  config.world.name = "floor";
  config.world.models = {slab("floor", {40, 40, 0.1}, poseFromXyzRpy(0, 0, -0.05, 0, 0, 0)),
                         slab("wall", {0.1, 40, 2}, poseFromXyzRpy(10, 0, 1, 0, 0, 0))};
  config.cameras.front().rate_hz = 10.0;
  config.cameras.front().errors.gaussian = 0.0;
  config.odometry = noOdometryError();
  return config;
}

PortReply play(Simulation& simulation, const std::string& lines) {
  return simulation.play(parseScenario("scenario 1\n" + lines, "s"));
}

/// The model straight ahead of the camera.
std::string modelAhead(Simulation& simulation) {
  simulation.takeFrame();
  const auto truth = simulation.truthImages();
  EXPECT_TRUE(truth.has_value());
  if (!truth) return {};
  const int model = truth->model.at<int>(120, 160);
  return model == TruthImages::kNothing ? "nothing" : simulation.scene().status()[model].name;
}

TEST(ScenarioPlayer, BringsMovesAndRemovesModelsAsImagesShowThem) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation,
                   "object crate size_m=1,1,1\n"
                   "at 1 place crate at_m=3,0\n"
                   "at 2 remove crate\n"
                   "at 3 place crate at_m=3,5\n"
                   "at 4 place crate at_m=4,0\n"
                   "at 5 remove wall\n"
                   "at 5 remove crate\n")
                  .ok());
  const auto at = [&](double seconds) {
    simulation.advance(toStampUs(seconds) - simulation.now());
    return modelAhead(simulation);
  };
  EXPECT_EQ(at(0.5), "wall");
  EXPECT_EQ(at(1.5), "crate");
  EXPECT_EQ(at(2.5), "wall");
  EXPECT_EQ(at(3.5), "wall");
  EXPECT_EQ(at(4.5), "crate");
  EXPECT_EQ(at(5.5), "nothing");
  EXPECT_THAT(simulation.takeScenarioProblems(), IsEmpty());
  simulation.reset(2);
  EXPECT_EQ(at(0.5), "wall") << "everything from the beginning";
  EXPECT_EQ(at(1.5), "crate");
}

TEST(ScenarioPlayer, AFrameShowsTheWorldOfItsOwnMomentHoweverLateItIsTaken) {
  auto config = onAFloor();
  config.cameras.front().latency_s = 0.1;
  Simulation simulation(config);
  ASSERT_TRUE(play(simulation, "object crate size_m=1,1,1\nat 0.95 place crate at_m=3,0\n").ok());
  simulation.advance(1'000'000);  // the frame of 0.9 s arrives; the crate stands there since 0.95 s
  EXPECT_EQ(modelAhead(simulation), "wall");
  simulation.advance(100'000);
  EXPECT_EQ(modelAhead(simulation), "crate");
}

TEST(ScenarioPlayer, AWalkerCoversTheViewAndKeepsItsWay) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation,
                   "object visitor shape=robot\n"
                   "at 1 walk visitor way=open speed_mps=0.5 points_m=2,-2;2,2\n"
                   "at 14 stand visitor\n")
                  .ok());
  simulation.advance(1'500'000);
  EXPECT_EQ(modelAhead(simulation), "wall");
  simulation.advance(3'510'000);  // 4 s of walking: half way
  EXPECT_EQ(modelAhead(simulation), "visitor");
  const auto place = [&] {
    return Eigen::Vector3d(simulation.scene().status().back().T_world_model.translation());
  };
  EXPECT_NEAR(place().y(), 0.0, 0.02);
  simulation.advance(8'000'000);  // to the end and back again
  EXPECT_NEAR(place().y(), 0.0, 0.04);
  EXPECT_NEAR(place().x(), 2.0, 1e-9);
  simulation.advance(2'000'000);
  const double stands = place().y();
  simulation.advance(2'000'000);
  EXPECT_EQ(place().y(), stands);
}

TEST(ScenarioPlayer, AWalkerWaitsForARobotInItsWay) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation,
                   "object visitor shape=robot size_m=0.4,0.4,1\n"
                   "at 0 walk visitor speed_mps=0.5 points_m=3,0;-3,0\n")
                  .ok());
  simulation.advance(20'000'000);
  // It stands 5 cm before the robot: radii 0.2 m (a polygon's, a little less) and 0.22 m.
  EXPECT_NEAR(simulation.scene().status().back().T_world_model.translation().x(), 0.47, 0.02);
  EXPECT_FALSE(simulation.truth().in_collision);
  ASSERT_TRUE(simulation.kidnap({0.0, 3.0, 0.0}).ok());
  simulation.advance(3'000'000);
  EXPECT_LT(simulation.scene().status().back().T_world_model.translation().x(), -0.5) << "and goes on";
}

TEST(ScenarioPlayer, AModelThatCameStopsTheRobotAndOneThatWentLetsItPass) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation,
                   "object crate size_m=0.4,2,0.4\n"
                   "at 0 place crate at_m=1.2,0\n"
                   "at 0 drive speed_mps=0.4 points_m=0,0;6,0\n"
                   "at 6 remove crate\n")
                  .ok());
  simulation.advance(5'500'000);
  EXPECT_TRUE(simulation.truth().in_collision);
  EXPECT_NEAR(simulation.truth().T_world_robot.x, 1.0 - 0.22, 0.01);
  simulation.advance(6'000'000);
  EXPECT_FALSE(simulation.truth().in_collision);
  EXPECT_GT(simulation.truth().T_world_robot.x, 1.5);
}

TEST(ScenarioPlayer, DrivesKidnapsAndSlips) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation,
                   "at 0 drive way=closed speed_mps=0.3 points_m=0,0;3,0;3,3;0,3\n"
                   "at 5 kidnap at_m=3,1 heading_deg=90\n"
                   "at 8 slip left_m=0.033 right_m=0\n"
                   "at 10 halt\n")
                  .ok());
  simulation.advance(4'900'000);
  EXPECT_NEAR(simulation.truth().T_world_robot.y, 0.0, 0.05);
  EXPECT_NEAR(simulation.truth().T_world_robot.x, 0.3 * 4.7, 0.15);
  simulation.advance(2'900'000);
  EXPECT_EQ(simulation.truth().kidnaps, 1U);
  EXPECT_NEAR(simulation.truth().T_world_robot.x, 3.0, 0.1) << "on the way again from where it was put";
  EXPECT_GT(simulation.truth().T_world_robot.y, 1.4);
  const auto believed = [&] {
    return simulation.base().samplesSince(-1, std::chrono::milliseconds(0)).samples.back().T_odom_robot;
  };
  const double before = angleDifference(believed().theta, simulation.truth().T_world_robot.theta);
  simulation.advance(1'000'000);
  const double after = angleDifference(believed().theta, simulation.truth().T_world_robot.theta);
  EXPECT_NEAR(angleDifference(after, before), -0.1, 1e-6) << "0.033 m on one of two wheels 0.33 m apart";
  simulation.advance(3'000'000);
  EXPECT_EQ(simulation.truth().T_world_robot,
            (simulation.advance(1'000'000), simulation.truth().T_world_robot));
}

TEST(ScenarioPlayer, WhoDrivesByHandTakesOver) {
  Simulation simulation(onAFloor());
  ASSERT_TRUE(play(simulation, "at 0 drive speed_mps=0.3 points_m=0,0;8,0\n").ok());
  simulation.advance(2'000'000);
  for (int i = 0; i < 200; ++i) {
    simulation.base().setVelocity(0.0, 0.0);
    simulation.step();
  }
  const double x = simulation.truth().T_world_robot.x;
  simulation.base().setVelocity(0.0, 0.0);
  simulation.step();
  EXPECT_EQ(simulation.truth().T_world_robot.x, x);
  simulation.advance(3'000'000);
  EXPECT_GT(simulation.truth().T_world_robot.x, x + 0.3) << "the scenario goes on when he lets go";
}

TEST(ScenarioPlayer, SaysWhatCannotBe) {
  Simulation simulation(onAFloor());
  EXPECT_EQ(play(simulation, "at 1 remove wal\n").message,
            "s:2: no object \"wal\" here and no model of that name in the world (did you mean \"wall\"?)");
  ASSERT_TRUE(
      play(simulation, "object crate size_m=1,1,1\nat 0 place crate at_m=3,0\nat 1 kidnap at_m=3,0\n").ok());
  simulation.advance(2'000'000);
  EXPECT_THAT(simulation.takeScenarioProblems(), ElementsAre("s:4: that place is inside an obstacle"));
}

}  // namespace
}  // namespace vismem
