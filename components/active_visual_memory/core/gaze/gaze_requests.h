/// @file Requests of gaze clients, waiting for the loop. Pure. See A5.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/visual_memory/gaze.h"

namespace vismem {

class AttentionPool;
class GazeController;

/// Largest distance on the floor from the robot to a place that is looked at [m].
constexpr double kFarthestPlace_m = 1000.0;

/// Requests of gaze clients until the loop takes them. *Single-threaded*: a component guards it if clients
/// live in other threads. Invalid requests are rejected here, so the loop need not check them.
class GazeRequestQueue final : public GazeClient {
 public:
  /// What an accepted request does to the gaze.
  using Item = std::function<void(GazeController&, AttentionPool&)>;

  /// kFixate returns to the last fixated place; rejected without one.
  PortReply setMode(GazeMode mode) override;
  PortReply fixate(const Eigen::Vector3d& p_odom) override;
  PortReply request(const GazeRequest& request) override;
  PortReply withdraw(const std::string& client, const std::string& key) override;
  std::optional<GazeStatus> status() override { return status_; }

  /// Adds an item that another queue has checked.
  void push(Item item) { items_.push_back(std::move(item)); }
  /// For the owner: the items since the last call, oldest first.
  std::vector<Item> take();
  /// @param p_odom_robot places farther from it than kFarthestPlace_m are rejected from now on.
  void publish(const GazeStatus& status, const Eigen::Vector2d& p_odom_robot) {
    if (!status_) status_.emplace();
    // The copy would allocate for each point more than ever before.
    status_->points.reserve(status.points.capacity());
    *status_ = status;
    p_odom_robot_ = p_odom_robot;
  }

 private:
  /// @return empty for a place that can be looked at.
  std::string problemOf(const Eigen::Vector3d& p_odom) const;

  Eigen::Vector2d p_odom_robot_ = Eigen::Vector2d::Zero();
  bool has_fixation_ = false;
  std::vector<Item> items_;
  std::optional<GazeStatus> status_;
};

}  // namespace vismem
