#include "experiments/trials/monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <unordered_set>

#include "common/geometry/angles.h"
#include "experiments/trials/gaussian.h"
#include "localization/core/hypotheses/explorers.h"
#include "localization/core/likelihood/robust_likelihood.h"

namespace vismem {
namespace {

constexpr double kStartStd_m = 0.1;
constexpr double kStartStd_rad = 0.1;
/// Shorter motions have no direction.
constexpr double kLeastWay_m = 0.01;

/// A bin of the histogram, packed into a number that a hash table takes.
using BinKey = std::int64_t;
constexpr int kBits = 21;
constexpr std::int64_t kOffset = 1 << (kBits - 1);  // positions may be negative
constexpr std::int64_t kMask = (1 << kBits) - 1;

BinKey packed(std::int64_t x, std::int64_t y, std::int64_t heading) {
  return ((x + kOffset) << (2 * kBits)) | ((y + kOffset) << kBits) | heading;
}

/// Bins of headings are cyclic.
int headingBins(const MonteCarloParams& params) {
  return std::max(1, static_cast<int>(std::lround(2.0 * std::numbers::pi / params.bin_rad)));
}

BinKey binOf(const Pose2& pose, const MonteCarloParams& params) {
  const int bins = headingBins(params);
  const double turn = (pose.theta + std::numbers::pi) / (2.0 * std::numbers::pi);
  const int heading = static_cast<int>(std::floor(turn * bins)) % bins;
  return packed(static_cast<std::int64_t>(std::floor(pose.x / params.bin_m)),
                static_cast<std::int64_t>(std::floor(pose.y / params.bin_m)), (heading + bins) % bins);
}

}  // namespace

MonteCarloParams stockMonteCarlo() {
  return {};
}

MonteCarloParams tunedMonteCarlo() {
  MonteCarloParams params;
  params.least_particles = 2000;
  params.most_particles = 10000;
  params.alpha_slow = 0.01;
  params.alpha_fast = 0.3;
  params.restart_averages = false;
  params.gate_m = params.gate_rad = 0.0;
  params.points = 30;
  params.motion = {0.1, 0.1, 0.1, 0.05};
  params.log_likelihood_share = 0.3;
  return params;
}

double kldParticleCount(int bins, double error, double quantile) {
  if (bins < 2) return 1.0;
  const double k = bins - 1;
  const double a = 2.0 / (9.0 * k);
  const double b = 1.0 - a + std::sqrt(a) * quantile;
  return k / (2.0 * error) * b * b * b;
}

MonteCarlo::MonteCarlo(const MonteCarloParams& params, const SegmentMap& map_edges, std::uint64_t seed)
    : params_(params), map_(map_edges, robustIndex({}, {})), engine_(seed) {
  particles_.resize(static_cast<std::size_t>(params_.most_particles));
  for (Particle& particle : particles_) {
    particle = {uniformExplorer(map_, 0.0, engine_), 1.0 / static_cast<double>(particles_.size())};
  }
}

void MonteCarlo::setPose(const Pose2& T_world_robot) {
  particles_.resize(static_cast<std::size_t>(params_.least_particles));
  for (Particle& particle : particles_) {
    particle.T_world_robot.x = T_world_robot.x + kStartStd_m * standardNormal(engine_);
    particle.T_world_robot.y = T_world_robot.y + kStartStd_m * standardNormal(engine_);
    particle.T_world_robot.theta = wrapAngle(T_world_robot.theta + kStartStd_rad * standardNormal(engine_));
    particle.weight = 1.0 / static_cast<double>(particles_.size());
  }
  slow_ = fast_ = 0.0;
  estimate();
}

const PoseEstimate& MonteCarlo::update(const MemoryUpdate& update) {
  const MemorySnapshot& snapshot = *update.snapshot;
  if (has_last_ && snapshot.stamp_us <= last_stamp_us_) return estimate_;
  if (has_last_) move(inverse(last_T_odom_robot_) * snapshot.T_odom_robot);
  const bool first = !has_last_;
  has_last_ = true;
  last_stamp_us_ = snapshot.stamp_us;
  last_T_odom_robot_ = snapshot.T_odom_robot;
  const auto tick_us = toStampUs(params_.tick_s);
  const Pose2 since = inverse(weighed_T_odom_robot_) * snapshot.T_odom_robot;
  const bool moved = !weighed_once_ || since.position().norm() >= params_.gate_m ||
                     std::abs(since.theta) >= params_.gate_rad;
  if ((first || snapshot.stamp_us >= last_tick_us_ + tick_us) && moved) {
    last_tick_us_ = snapshot.stamp_us;
    if (weigh(update)) {
      weighed_once_ = true;
      weighed_T_odom_robot_ = snapshot.T_odom_robot;
      // The estimate is of the weighed particles: resampling only adds noise to it.
      estimate();
      resample();
    }
  } else if (estimate_.T_world_robot) {
    estimate_.T_world_robot =
        *estimate_.T_world_robot * inverse(estimate_.T_odom_robot) * snapshot.T_odom_robot;
  }
  estimate_.stamp_us = snapshot.stamp_us;
  estimate_.T_odom_robot = snapshot.T_odom_robot;
  ++estimate_.revision;
  return estimate_;
}

void MonteCarlo::move(const Pose2& T_before_now) {
  const double way = T_before_now.position().norm();
  const double turn1 = way < kLeastWay_m ? 0.0 : std::atan2(T_before_now.y, T_before_now.x);
  const double turn2 = angleDifference(T_before_now.theta, turn1);
  // Driving backwards has two half turns, which do not count as turns.
  const double as_turn1 = std::min(std::abs(turn1), std::numbers::pi - std::abs(turn1));
  const double as_turn2 = std::min(std::abs(turn2), std::numbers::pi - std::abs(turn2));
  const auto& [a1, a2, a3, a4] = params_.motion;
  const double std1 = std::sqrt(a1 * as_turn1 * as_turn1 + a2 * way * way);
  const double std_way = std::sqrt(a3 * way * way + a4 * (as_turn1 * as_turn1 + as_turn2 * as_turn2));
  const double std2 = std::sqrt(a1 * as_turn2 * as_turn2 + a2 * way * way);
  for (Particle& particle : particles_) {
    const double t1 = turn1 + std1 * standardNormal(engine_);
    const double w = way + std_way * standardNormal(engine_);
    const double t2 = turn2 + std2 * standardNormal(engine_);
    Pose2& pose = particle.T_world_robot;
    pose.x += w * std::cos(pose.theta + t1);
    pose.y += w * std::sin(pose.theta + t1);
    pose.theta = wrapAngle(pose.theta + t1 + t2);
  }
}

bool MonteCarlo::weigh(const MemoryUpdate& update) {
  const FloorObservation all = observe(update, map_, observation_params_);
  if (all.points.empty()) return false;
  double worth = 0.0;
  for (const FloorPoint& point : all.points) worth += point.weight;
  std::vector<Point> points;
  double sum_worth = 0.0;
  for (const FloorPoint& point : all.points) {
    sum_worth += point.weight;
    while (points.size() + 0.5 <= sum_worth / worth * params_.points) {
      points.push_back({point.p_robot, point.direction_robot, point.label});
    }
  }
  const double anything = 1.0 - params_.hit;
  const double scale = -0.5 / (params_.sigma_m * params_.sigma_m);
  const bool by_logs = params_.log_likelihood_share > 0.0;
  double sum = 0.0;
  double sum_of_weights = 0.0;
  for (Particle& particle : particles_) {
    const Pose2& pose = particle.T_world_robot;
    const double c = std::cos(pose.theta);
    const double s = std::sin(pose.theta);
    double cubes = 1.0;
    double product = 1.0;  // of at most 60 factors of a half or more
    for (const Point& point : points) {
      const Eigen::Vector2d p(pose.x + c * point.p_robot.x() - s * point.p_robot.y(),
                              pose.y + s * point.p_robot.x() + c * point.p_robot.y());
      const auto field = map_.nearest(point.label, p, point.direction_robot + pose.theta);
      const double fit = field ? std::exp(scale * field->distance_m * field->distance_m) : 0.0;
      const double likelihood = params_.hit * fit + anything;
      if (by_logs) {
        product *= likelihood;
      } else {
        cubes += likelihood * likelihood * likelihood;
      }
    }
    const double weight = by_logs ? std::pow(product, params_.log_likelihood_share) : cubes;
    particle.weight *= weight;
    sum += particle.weight;
    sum_of_weights += weight;
  }
  for (Particle& particle : particles_) {
    particle.weight = sum > 0.0 ? particle.weight / sum : 1.0 / static_cast<double>(particles_.size());
  }
  const double mean = sum_of_weights / static_cast<double>(particles_.size());
  slow_ = slow_ == 0.0 ? mean : slow_ + params_.alpha_slow * (mean - slow_);
  fast_ = fast_ == 0.0 ? mean : fast_ + params_.alpha_fast * (mean - fast_);
  return true;
}

void MonteCarlo::resample() {
  std::vector<double> sums;
  sums.reserve(particles_.size());
  double sum = 0.0;
  for (const Particle& particle : particles_) sums.push_back(sum += particle.weight);
  const double injected = std::max(0.0, 1.0 - fast_ / slow_);
  std::vector<Particle> next;
  std::unordered_set<BinKey> occupied;
  double wanted = params_.least_particles;
  while (static_cast<double>(next.size()) < wanted) {
    Pose2 pose;
    if (uniform(engine_, 0.0, 1.0) < injected) {
      pose = uniformExplorer(map_, 0.0, engine_);
    } else {
      const double at = uniform(engine_, 0.0, sum);
      const auto chosen =
          static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin());
      pose = particles_[std::min(chosen, particles_.size() - 1)].T_world_robot;
    }
    next.push_back({pose, 0.0});
    if (occupied.insert(binOf(pose, params_)).second) {
      wanted = std::clamp(
          kldParticleCount(static_cast<int>(occupied.size()), params_.kld_error, params_.kld_quantile),
          static_cast<double>(params_.least_particles), static_cast<double>(params_.most_particles));
    }
  }
  for (Particle& particle : next) particle.weight = 1.0 / static_cast<double>(next.size());
  particles_ = std::move(next);
  if (params_.restart_averages && injected > 0.0) slow_ = fast_ = 0.0;
}

void MonteCarlo::estimate() {
  // The heaviest cluster of neighbouring bins, never a mean over several.
  struct Cell {
    double weight = 0.0;
    int cluster = -1;
  };
  std::unordered_map<BinKey, Cell> cells;
  std::vector<BinKey> of_particle;
  of_particle.reserve(particles_.size());
  for (const Particle& particle : particles_) {
    of_particle.push_back(binOf(particle.T_world_robot, params_));
    cells[of_particle.back()].weight += particle.weight;
  }
  const int bins = headingBins(params_);
  std::vector<double> weights;
  for (const BinKey start : of_particle) {
    if (cells[start].cluster >= 0) continue;
    const int cluster = static_cast<int>(weights.size());
    weights.push_back(0.0);
    cells[start].cluster = cluster;
    std::vector<BinKey> open{start};
    while (!open.empty()) {
      const BinKey at = open.back();
      open.pop_back();
      weights.back() += cells[at].weight;
      const std::int64_t x = (at >> (2 * kBits)) - kOffset;
      const std::int64_t y = ((at >> kBits) & kMask) - kOffset;
      const std::int64_t heading = at & kMask;
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dh = -1; dh <= 1; ++dh) {
            const auto found = cells.find(packed(x + dx, y + dy, (heading + dh + bins) % bins));
            if (found == cells.end() || found->second.cluster >= 0) continue;
            found->second.cluster = cluster;
            open.push_back(found->first);
          }
        }
      }
    }
  }
  const auto best = static_cast<int>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  double sum = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Particle& particle = particles_[i];
    const Pose2& pose = particle.T_world_robot;
    if (cells[of_particle[i]].cluster != best) continue;
    sum += particle.weight;
    position += particle.weight * pose.position();
    heading += particle.weight * Eigen::Vector2d(std::cos(pose.theta), std::sin(pose.theta));
  }
  if (!(sum > 0.0)) return;
  estimate_.T_world_robot =
      Pose2{position.x() / sum, position.y() / sum, std::atan2(heading.y(), heading.x())};
  estimate_.P.setZero();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (cells[of_particle[i]].cluster != best) continue;
    const Pose2& pose = particles_[i].T_world_robot;
    const Eigen::Vector3d off(pose.x - estimate_.T_world_robot->x, pose.y - estimate_.T_world_robot->y,
                              angleDifference(pose.theta, estimate_.T_world_robot->theta));
    estimate_.P += particles_[i].weight / sum * off * off.transpose();
  }
  estimate_.reliability = weights[static_cast<std::size_t>(best)];
}

}  // namespace vismem
