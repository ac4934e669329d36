#include "calibration/core/odometry/wheel_path.h"

#include <stdexcept>

namespace vismem {
WheelPath::WheelPath(const std::vector<OdometrySample>& samples, double base_m) : base_m_(base_m) {
  if (!(base_m > 0.0)) throw std::invalid_argument("the base of the wheels must be positive");
  if (samples.size() < 2) throw std::invalid_argument("fewer than two samples of odometry");
  sums_.push_back({});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    stamps_s_.push_back(toSeconds(samples[i].stamp_us));
    if (i == 0) continue;
    const WheelTravel step = travelBetween(samples[i - 1].T_odom_robot, samples[i].T_odom_robot, base_m);
    steps_.push_back(step);
    sums_.push_back({sums_.back().left + std::abs(step.left), sums_.back().right + std::abs(step.right)});
  }
}

std::size_t WheelPath::stepAt(double time_s) const {
  const auto after = std::upper_bound(stamps_s_.begin(), stamps_s_.end(), time_s);
  const auto index = static_cast<std::size_t>(after - stamps_s_.begin());
  return std::min(index == 0 ? 0 : index - 1, steps_.size() - 1);
}

WheelTravel WheelPath::speedAt(double time_s) const {
  if (time_s < beginS() || time_s > endS()) return {};
  const std::size_t i = stepAt(time_s);
  const double dt = stamps_s_[i + 1] - stamps_s_[i];
  return {steps_[i].left / dt, steps_[i].right / dt};
}

WheelTravel WheelPath::travelled(double from_s, double to_s) const {
  const auto sumAt = [&](double time_s) {
    const double t = std::clamp(time_s, beginS(), endS());
    const std::size_t i = stepAt(t);
    const double share = (t - stamps_s_[i]) / (stamps_s_[i + 1] - stamps_s_[i]);
    return WheelTravel{sums_[i].left + share * std::abs(steps_[i].left),
                       sums_[i].right + share * std::abs(steps_[i].right)};
  };
  const WheelTravel from = sumAt(from_s);
  const WheelTravel to = sumAt(to_s);
  return {to.left - from.left, to.right - from.right};
}

Eigen::Matrix3d WheelPath::covariance(const WheelModel& model, double from_s, double to_s,
                                      double sigma_sqrtm) const {
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  double heading = 0.0;
  for (std::size_t i = stepAt(from_s); i <= stepAt(to_s); ++i) {
    const double left = model.left_scale * steps_[i].left;
    const double right = model.right_scale * steps_[i].right;
    if (left == 0.0 && right == 0.0) continue;
    const double travel = 0.5 * (left + right);
    const double turn = (right - left) / model.base_m;
    const double c = std::cos(heading + 0.5 * turn);
    const double s = std::sin(heading + 0.5 * turn);
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(0, 2) = -travel * s;
    F(1, 2) = travel * c;
    Eigen::Matrix<double, 3, 2> G;  // by left and right travel
    const double by_turn = 0.5 * travel / model.base_m;
    G << 0.5 * c + by_turn * s, 0.5 * c - by_turn * s, 0.5 * s - by_turn * c, 0.5 * s + by_turn * c,
        -1.0 / model.base_m, 1.0 / model.base_m;
    const double variance = sigma_sqrtm * sigma_sqrtm;
    const Eigen::Vector2d Q(variance * std::abs(left), variance * std::abs(right));
    P = F * P * F.transpose() + G * Q.asDiagonal() * G.transpose();
    heading += turn;
  }
  return P;
}

}  // namespace vismem
