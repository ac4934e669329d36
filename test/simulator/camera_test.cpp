// Cameras: errors of their images, latency, several of them, ground truth, determinism.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <thread>

#include "simulator/app/render_pool.h"
#include "simulator/core/image_errors.h"
#include "simulator/core/simulation.h"
#include "simulator/core/truth_frames.h"
#include "simulator/corridor.h"

namespace vismem {
namespace {

using namespace test;

using testing::HasSubstr;

struct Statistics {
  double mean = 0.0;
  double sigma = 0.0;
};
Statistics ofNoise(const ImageErrorParams& params, int level, double gain = 1.0) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(level));
  ImageErrors(params, 5).apply(image, 3, gain);
  cv::Scalar mean, sigma;
  cv::meanStdDev(image.reshape(1), mean, sigma);
  return {mean[0], sigma[0]};
}

TEST(ImageErrors, ReadNoiseIsTheSameEverywhereShotNoiseGrowsWithTheRootOfTheLight) {
  // 230 400 values: the mean is known to 0.01 and the deviation to 0.3 %; rounding to whole levels adds 1/12
  // to the variance.
  const auto expected = [](double variance) { return std::sqrt(variance + 1.0 / 12.0); };
  const ImageErrorParams read{4.0, 0.0, 0.0, 5.0};
  for (const int level : {60, 200}) {
    EXPECT_NEAR(ofNoise(read, level).mean, level, 0.05);
    EXPECT_NEAR(ofNoise(read, level).sigma, expected(16.0), 0.05);
  }
  const ImageErrorParams both{3.0, 8.0, 0.0, 5.0};
  for (const int level : {40, 160}) {
    EXPECT_NEAR(ofNoise(both, level).sigma, expected(9.0 + 64.0 * level / 255.0), 0.06) << level;
  }
  EXPECT_EQ(ofNoise({0.0, 0.0, 0.0, 5.0}, 90).sigma, 0.0);
  EXPECT_NEAR(ofNoise({0.0, 0.0, 0.0, 5.0}, 90, 1.5).mean, 135.0, 1e-9);
  EXPECT_EQ(ofNoise({0.0, 0.0, 0.0, 5.0}, 200, 1.5).mean, 255.0) << "and saturates";
}

TEST(ImageErrors, NoiseDiffersFromFrameToFrameAndFromRowToRow) {
  const ImageErrors errors({4.0, 0.0, 0.0, 5.0}, 5);
  cv::Mat a(240, 320, CV_8UC3, cv::Scalar::all(100)), b = a.clone(), again = a.clone();
  errors.apply(a, 1, 1.0);
  errors.apply(b, 2, 1.0);
  errors.apply(again, 1, 1.0);
  EXPECT_EQ(hashOf(a), hashOf(again));
  EXPECT_NE(hashOf(a), hashOf(b));
  cv::Mat values, other;
  a.convertTo(values, CV_32F, 1.0, -100.0);
  const auto correlation = [&](const cv::Mat& x, const cv::Mat& y) {
    return x.dot(y) / (cv::norm(x) * cv::norm(y));
  };
  b.convertTo(other, CV_32F, 1.0, -100.0);
  EXPECT_LT(std::abs(correlation(values, other)), 0.02);
  EXPECT_LT(std::abs(correlation(values.rowRange(0, 239).clone(), values.rowRange(1, 240).clone())), 0.02);
}

TEST(ImageErrors, ExposureWandersSlowlyAroundOne) {
  ImageErrorParams params{0.0, 0.0, 0.2, 5.0};
  ImageErrors errors(params, 9);
  double squares = 0.0, steps = 0.0, last = 0.0;
  constexpr int kFrames = 200'000;  // 20 000 s: 2000 times the correlation's length
  for (int i = 0; i < kFrames; ++i) {
    const double log_gain = std::log(errors.gainAt(i * 100'000LL));
    squares += log_gain * log_gain;
    if (i > 0) steps += (log_gain - last) * (log_gain - last);
    last = log_gain;
  }
  EXPECT_NEAR(std::sqrt(squares / kFrames), 0.2, 0.01);
  // Over 0.1 s it moves by sigma sqrt(2 (1 - exp(-0.1 / 5))).
  EXPECT_NEAR(std::sqrt(steps / kFrames), 0.2 * std::sqrt(2.0 * (1.0 - std::exp(-0.02))), 0.001);
}

TEST(SimulatedCamera, DeliversLateWithTheStampOfTheExposure) {
  auto config = inCorridor();
  config.cameras.front().errors.gaussian = 0.0;
  Simulation prompt(config);
  config.cameras.front().latency_s = 0.25;
  Simulation late(config);
  for (int i = 0; i < 6; ++i) {
    for (Simulation* simulation : {&prompt, &late}) ASSERT_TRUE(simulation->advanceToNextFrame());
    const auto a = prompt.takeFrame();
    const auto b = late.takeFrame();
    ASSERT_TRUE(a && b);
    EXPECT_EQ(b->stamp_us, i * 100'000);
    EXPECT_EQ(late.now(), i * 100'000 + 250'000);
    EXPECT_EQ(hashOf(a->image), hashOf(b->image)) << "the image of its own moment";
    EXPECT_FALSE(late.takeFrame()) << "taken once";
    // Both drive alike in their own time.
    for (int k = 0; k < 10; ++k) {
      if (prompt.now() > late.now()) break;
      prompt.panTilt().command({PanTiltCommand::Kind::kPosition, 0.0, 0.0, 0.0, 0.0});
    }
  }
  late.advance(1'000'000);
  const auto newest = late.takeFrame();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->stamp_us, 1'500'000) << "latest wins: 1.75 s less the latency, at 10 Hz";
}

TEST(SimulatedCamera, AStereoPairSeesTheSamePointShifted) {
  auto config = inCorridor();
  config.cameras.front().errors.gaussian = 0.0;
  config.cameras.push_back(config.cameras.front());
  config.cameras.back().name = "cameraB";
  config.cameras.back().T_carrier_camera_body = poseFromXyzRpy(0.0, -0.12, 0.0, 0.0, 0.0, 0.0);
  config.cameras.back().rate_hz = 5.0;
  config.cameras.back().intrinsics = intrinsicsFromFieldOfView(640, 480, degToRad(70.0));
  Simulation simulation(config);
  simulation.advance(1'000'000);
  const auto left = simulation.takeFrame(0);
  const auto right = simulation.takeFrame(1);
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->image.size(), cv::Size(320, 240));
  EXPECT_EQ(right->image.size(), cv::Size(640, 480));
  EXPECT_EQ(left->seq, 10U);
  EXPECT_EQ(right->seq, 5U);
  // A pixel's point by depth, seen by the other camera: both depths agree there.
  const auto depth = simulation.truthImages(0)->depth_m;
  const auto other = simulation.truthImages(1)->depth_m;
  int compared = 0;
  for (int v = 130; v < 230; v += 10) {
    for (int u = 60; u < 260; u += 10) {
      const Eigen::Vector3d p = depth.at<float>(v, u) * idealPixelRay(left->intrinsics, {u, v});
      const Eigen::Vector3d in_right = p - Eigen::Vector3d(0.12, 0.0, 0.0);
      const auto px = projectToIdeal(right->intrinsics, in_right);
      ASSERT_TRUE(px);
      const cv::Point at(static_cast<int>(std::lround(px->x())), static_cast<int>(std::lround(px->y())));
      if (at.x < 1 || at.y < 1 || at.x > 638 || at.y > 478) continue;
      // Half a pixel of rounding on the floor: 2 %; nothing of the walls' edges is in this region.
      EXPECT_NEAR(other.at<float>(at.y, at.x), in_right.z(), 0.05 * in_right.z()) << u << " " << v;
      ++compared;
    }
  }
  EXPECT_GT(compared, 150);
}

/// Everything that a run makes: image hashes of all cameras and the trajectory.
std::vector<std::uint64_t> runOf(SimulationConfig config, int threads) {
  RenderPool pool(threads);
  config.rendering.parallel_for = [&pool](int count, const std::function<void(int)>& task) {
    pool.run(count, task);
  };
  Simulation simulation(std::move(config));
  std::vector<std::uint64_t> result;
  for (int i = 0; i < 6; ++i) {
    simulation.base().setVelocity(0.4, 0.1);
    simulation.panTilt().command({PanTiltCommand::Kind::kPosition, 0.3, -0.3, 0.0, 0.0});
    simulation.advanceToNextFrame();
    for (std::size_t c = 0; c < simulation.config().cameras.size(); ++c) {
      if (const auto frame = simulation.takeFrame(c)) result.push_back(hashOf(frame->image));
    }
    const Pose2 truth = simulation.truth().T_world_robot;
    const Pose2 odometry =
        simulation.base().samplesSince(-1, std::chrono::milliseconds(0)).samples.back().T_odom_robot;
    for (const double value : {truth.x, truth.y, truth.theta, odometry.x, odometry.y, odometry.theta}) {
      result.push_back(std::bit_cast<std::uint64_t>(value));
    }
  }
  return result;
}

TEST(Simulation, TheSameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  for (const bool walks : {false, true}) {
    auto config = walks ? humanoidSimulation() : SimulationConfig();
    config.world = corridor();
    config.start = {-3.0, 2.25, 0.0};
    config.seed = 11;
    config.cameras.front().rate_hz = 10.0;
    config.cameras.front().errors = {2.0, 3.0, 0.1, 5.0};
    const auto one = runOf(config, 1);
    EXPECT_EQ(one, runOf(config, 1));
    EXPECT_EQ(one, runOf(config, 2));
    EXPECT_EQ(one, runOf(config, 3));
    config.seed = 12;
    const auto other = runOf(config, 2);
    ASSERT_EQ(one.size(), other.size());
    EXPECT_NE(one, other);
  }
}

TEST(Simulation, ASourceOfChanceChangesNoOther) {
  const auto images = [](std::vector<std::uint64_t> run, std::size_t stride) {
    std::vector<std::uint64_t> hashes;
    for (std::size_t i = 0; i < run.size(); i += stride) hashes.push_back(run[i]);
    return hashes;
  };
  auto config = inCorridor();
  const auto plain = runOf(config, 1);  // 1 image and 6 numbers a frame
  auto two = config;
  two.cameras.push_back(two.cameras.front());
  two.cameras.back().name = "cameraB";
  const auto with_second = runOf(two, 1);  // 2 images and 6 numbers
  EXPECT_EQ(images(plain, 7), images(with_second, 8));
  for (std::size_t frame = 0; frame < 6; ++frame) {
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(plain[7 * frame + 1 + k], with_second[8 * frame + 2 + k]);
    EXPECT_NE(with_second[8 * frame], with_second[8 * frame + 1]) << "the same view, noise of its own";
  }
  auto slips = config;
  slips.odometry.slips_per_m = 50.0;
  const auto slipping = runOf(slips, 1);
  EXPECT_EQ(images(plain, 7), images(slipping, 7));
  EXPECT_NE(plain, slipping);
}

TEST(Simulation, ResetIsANewRunWithAnotherSeed) {
  auto config = inCorridor();
  config.seed = 4;
  Simulation fresh(config);
  config.seed = 3;
  Simulation used(config);
  used.scene().add("crate", {}, poseFromXyzRpy(-1.5, 2.25, 0, 0, 0, 0));
  used.base().setVelocity(0.5, 0.0);
  used.advance(2'000'000);
  used.takeFrame();
  used.reset(4);
  EXPECT_EQ(used.now(), 0);
  EXPECT_FALSE(used.scene().find("crate"));
  for (Simulation* simulation : {&fresh, &used}) {
    simulation->base().setVelocity(0.3, 0.2);
    simulation->advance(200'000);
  }
  EXPECT_EQ(fresh.truth().T_world_robot, used.truth().T_world_robot);
  EXPECT_EQ(hashOf(fresh.takeFrame()->image), hashOf(used.takeFrame()->image));
}

TEST(TruthFrames, CarryMillimetresAndIndices) {
  Simulation simulation(inCorridor());
  const auto frame = simulation.takeFrame();
  const auto truth = simulation.truthImages();
  ASSERT_TRUE(frame && truth);
  const Frame depth = depthFrame(*truth, *frame);
  const Frame objects = objectFrame(*truth, *frame);
  EXPECT_EQ(depth.stamp_us, frame->stamp_us);
  EXPECT_EQ(objects.seq, frame->seq);
  // Straight down the middle at pixel (160, 200): 80.5 rows below the principal point. The focal length is
  // 160 / tan 30 = 277.1 px, the camera's height 0.45 m: depth = 0.45 * 277.1 / 80.5 = 1.549 m.
  const auto d = depth.image.at<cv::Vec3b>(200, 160);
  EXPECT_NEAR(256 * d[0] + d[1], 1549, 2);
  EXPECT_EQ(d[2], 0);
  const auto o = objects.image.at<cv::Vec3b>(200, 160);
  EXPECT_EQ(simulation.scene().status().at(256 * o[0] + o[1] - 1).name, "floor");
  EXPECT_EQ(o[2], 1);
}

TEST(Simulation, SaysWhichCameraCannotBe) {
  const auto messageOf = [](auto change) {
    auto config = inCorridor();
    change(config);
    try {
      Simulation simulation(std::move(config));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.front().intrinsics.width = 0; }), HasSubstr("\"cameraA\""));
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.front().intrinsics.height = -4; }), HasSubstr("\"cameraA\""));
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.front().intrinsics.width = 100'000; }),
              HasSubstr("100000x240"));
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.front().intrinsics.width = 10'000; }),
              HasSubstr("at most 8192"));
  EXPECT_THAT(messageOf([&](auto& c) { c.cameras.front().intrinsics.fx = nan; }), HasSubstr("\"cameraA\""));
  for (const double rate : {0.0, -1.0, 1e9, nan}) {
    EXPECT_THAT(messageOf([&](auto& c) { c.cameras.front().rate_hz = rate; }),
                HasSubstr("(must be above 0, at most 100)"));
  }
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.front().latency_s = -0.1; }), HasSubstr("(must be 0..5)"));
  EXPECT_THAT(messageOf([&](auto& c) { c.cameras.front().T_carrier_camera_body.translation().x() = nan; }),
              HasSubstr("mount must be finite"));
  EXPECT_THAT(messageOf([&](auto& c) { c.cameras.front().errors.shot = nan; }), HasSubstr("shot noise"));
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.push_back(c.cameras.front()); }), HasSubstr("two are named"));
  EXPECT_THAT(messageOf([](auto& c) { c.cameras.clear(); }), HasSubstr("no camera"));
  EXPECT_THAT(messageOf([&](auto& c) { c.start.theta = nan; }), HasSubstr("the start pose is not finite"));
  EXPECT_EQ(messageOf([](auto&) {}), "");
}

TEST(Simulation, ACameraInsideAWallSeesItsInnerSide) {
  auto config = inCorridor();
  // 0.8 m to the left of the robot: inside the wall at y = 3.0..3.1.
  config.cameras.front().T_carrier_camera_body = poseFromXyzRpy(0.0, 0.8, 0.0, 0.0, 0.0, 0.0);
  config.cameras.front().errors.gaussian = 0.0;
  Simulation simulation(config);
  const auto frame = simulation.takeFrame();
  ASSERT_TRUE(frame);
  const auto truth = simulation.truthImages();
  const int model = truth->model.at<int>(120, 160);
  ASSERT_GE(model, 0);
  EXPECT_EQ(simulation.scene().status()[model].name, "wall_north");
}

TEST(Simulation, TheSmallestImageIsAnImage) {
  auto config = inCorridor();
  config.cameras.front().intrinsics = {16, 16, 100.0, 100.0, 7.5, 7.5};
  Simulation simulation(config);
  ASSERT_TRUE(simulation.takeFrame());
  EXPECT_EQ(simulation.truthImages()->depth_m.total(), 256U);
}

TEST(Simulation, AModelThatCameWhileTimeStoodStillIsInTheWay) {
  Simulation simulation(inCorridor());
  ASSERT_TRUE(simulation.scene().add("crate", {}, poseFromXyzRpy(1.0, 2.25, 0, 0, 0, 0)).ok());
  EXPECT_EQ(simulation.kidnap({1.0, 2.25, 0.0}).message, "that place is inside an obstacle");
  ASSERT_TRUE(simulation.scene().remove("crate").ok());
  EXPECT_TRUE(simulation.kidnap({1.0, 2.25, 0.0}).ok());
}

TEST(MovingWorld, SaysWhatCannotBe) {
  MovingWorld scene(corridor());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose3 here = Pose3::Identity();
  Pose3 nowhere = here;
  nowhere.translation().z() = nan;
  EXPECT_EQ(scene.add("floor", {}, here).message, "there is a model \"floor\"");
  EXPECT_THAT(scene.add("a", {PropShape::Kind::kBox, {nan, 1, 1}, {0, 0, 0}}, here).message,
              HasSubstr("size nan"));
  EXPECT_THAT(scene.add("a", {PropShape::Kind::kBox, {1, 1, 1}, {2, 0, 0}}, here).message,
              HasSubstr("color 2"));
  EXPECT_EQ(scene.add("a", {}, nowhere).message, "a pose must be finite");
  EXPECT_EQ(scene.place("floor", nowhere).message, "a pose must be finite");
  EXPECT_EQ(scene.remove("flor").message, "no model \"flor\" in this world");
  EXPECT_THAT(scene.walk("floor", {{{0, 0}, {nan, 0}}, false, WayEnd::kBack, 1.0}).message,
              HasSubstr("way-point 2"));
  EXPECT_THAT(scene.walk("floor", {{{0, 0}}, false, WayEnd::kBack, 1.0}).message,
              HasSubstr("must be 2 or more"));
  EXPECT_THAT(scene.walk("floor", {{{0, 0}, {1, 0}}, false, WayEnd::kBack, nan}).message,
              HasSubstr("speed nan"));
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(scene.add(std::to_string(i), {}, here).ok());
  EXPECT_EQ(scene.add("a", {}, here).message, "there are 1000 added models (remove one)");
}

}  // namespace
}  // namespace vismem
