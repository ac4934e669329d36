#include "calibration/core/odometry/wheel_sensor_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <sstream>

#include "support/data_folder.h"

namespace vismem {
namespace {

/// One JSON object after another.
std::vector<WheelSensorMotion> readTuples(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<WheelSensorMotion> motions;
  nlohmann::json json;
  while (in >> std::ws && in.good()) {
    in >> json;
    const auto sm = json.at("sm").get<std::vector<double>>();
    motions.push_back({json.at("T"), json.at("phi_l"), json.at("phi_r"), {sm[0], sm[1], sm[2]}});
  }
  return motions;
}

WheelSensorParameters published(const nlohmann::json& r) {
  return {0.5 * r.at("l_diam").get<double>(),
          0.5 * r.at("r_diam").get<double>(),
          r.at("axle"),
          r.at("l_x"),
          r.at("l_y"),
          r.at("l_theta")};
}

class Khepera : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = dataFolder() / "odometry_khepera";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << folder_ << " is not here";
    motions_ = readTuples(folder_ / (std::string(GetParam()) + ".tuple"));
    std::ifstream in(folder_ / (std::string(GetParam()) + "_results.json"));
    published_ = published(nlohmann::json::parse(in));
  }
  std::filesystem::path folder_;
  std::vector<WheelSensorMotion> motions_;
  WheelSensorParameters published_;
};

TEST_P(Khepera, FitsThePublishedResult) {
  const WheelSensorFit fit = fitWheelsAndSensor(motions_, 0.02, 0.09);
  const auto& p = fit.parameters;
  EXPECT_NEAR(p.base_m / published_.base_m, 1.0, 0.002);
  EXPECT_NEAR(p.left_radius_m / published_.left_radius_m, 1.0, 0.002);
  EXPECT_NEAR(p.right_radius_m / published_.right_radius_m, 1.0, 0.002);
  EXPECT_NEAR(p.x_m, published_.x_m, 0.0003);
  EXPECT_NEAR(p.y_m, published_.y_m, 0.0003);
  EXPECT_NEAR(p.yaw_rad, published_.yaw_rad, 0.002);
  RecordProperty("base_ratio", std::to_string(p.base_m / published_.base_m));
  std::cout << GetParam() << ": " << motions_.size()
            << " motions; base, left, right against the published: " << p.base_m / published_.base_m << " "
            << p.left_radius_m / published_.left_radius_m << " "
            << p.right_radius_m / published_.right_radius_m << "\n";
}

// Eight parts of the data: their estimates scatter as their standard deviations say.
TEST_P(Khepera, StatesHonestDeviations) {
  constexpr std::size_t kParts = 8;
  std::vector<WheelSensorFit> fits;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<WheelSensorMotion> some;
    for (std::size_t i = part; i < motions_.size(); i += kParts) some.push_back(motions_[i]);
    fits.push_back(fitWheelsAndSensor(some, 0.02, 0.09));
  }
  const WheelSensorFit whole = fitWheelsAndSensor(motions_, 0.02, 0.09);
  double squares = 0.0;
  for (const auto& fit : fits) {
    const Eigen::Matrix<double, 6, 1> error = fit.parameters.vector() - whole.parameters.vector();
    // The whole contains the part: the difference has (1 - 1/8) of the part's covariance.
    squares += error.dot(fit.covariance.inverse() * error) / (1.0 - 1.0 / kParts);
  }
  const double normalised = std::sqrt(squares / (6.0 * kParts));
  std::cout << GetParam() << ": normalised error of " << kParts << " parts " << normalised << "\n";
  EXPECT_GT(normalised, 0.7);
  EXPECT_LT(normalised, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Sets, Khepera, testing::Values("l90", "lstraight"));

std::vector<WheelSensorMotion> drawnMotions(const WheelSensorParameters& truth) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> speed(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<WheelSensorMotion> motions;
  for (int i = 0; i < 200; ++i) {
    WheelSensorMotion motion{0.8, speed(engine), speed(engine), {}};
    motion.sensor = predictedSensorMotion(truth, motion) +
                    Eigen::Vector3d(1e-4 * normal(engine), 1e-4 * normal(engine), 1e-3 * normal(engine));
    motions.push_back(motion);
  }
  return motions;
}

// Negative radii and base with the sensor turned by 180 degrees and its place mirrored predict the same
// motions.
TEST(WheelSensorFit, RefusesTheMirroredSolution) {
  const WheelSensorParameters truth{0.02, 0.021, 0.09, 0.01, -0.02, 0.7};
  const WheelSensorParameters mirrored{-0.02, -0.021, -0.09, -0.01, 0.02, 0.7 + std::numbers::pi};
  const auto motions = drawnMotions(truth);
  for (const auto& motion : motions) {
    EXPECT_LT((predictedSensorMotion(truth, motion) - predictedSensorMotion(mirrored, motion)).norm(), 1e-12);
  }
  const WheelSensorFit fit = fitWheelsAndSensor(motions, 0.03, 0.07);
  EXPECT_NEAR(fit.parameters.left_radius_m, 0.02, 2e-4);
  EXPECT_NEAR(fit.parameters.right_radius_m, 0.021, 2e-4);
  EXPECT_NEAR(fit.parameters.base_m, 0.09, 1e-3);
  EXPECT_NEAR(fit.parameters.yaw_rad, 0.7, 0.02);
}

TEST(WheelSensorFit, KeepsItsResultWithATenthOfWildMotions) {
  const WheelSensorParameters truth{0.02, 0.021, 0.09, 0.01, -0.02, 0.7};
  auto motions = drawnMotions(truth);
  for (std::size_t i = 0; i < motions.size(); i += 10) motions[i].sensor += Eigen::Vector3d(0.05, -0.03, 0.4);
  const WheelSensorFit fit = fitWheelsAndSensor(motions, 0.02, 0.09);
  EXPECT_NEAR(fit.parameters.base_m, 0.09, 1e-3);
  EXPECT_NEAR(fit.parameters.x_m, 0.01, 5e-4);
}

TEST(WheelSensorFit, NamesTooFewMotionsAndSwappedSigns) {
  const WheelSensorParameters truth{0.02, 0.021, 0.09, 0.01, -0.02, 0.7};
  auto motions = drawnMotions(truth);
  EXPECT_THAT([&] { fitWheelsAndSensor({motions[0]}, 0.02, 0.09); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("1 motions (at least 10")));
}

}  // namespace
}  // namespace vismem
