/// @file Requests of gaze clients, waiting for the loop. Pure. See A5.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/visual_memory/gaze.h"

namespace vismem {

/// Largest distance on the floor from the robot to a place that is looked at [m].
constexpr double kFarthestPlace_m = 1000.0;

/// Requests of gaze clients until the loop takes them. *Single-threaded*: a component guards it if clients
/// live in other threads. Invalid requests are rejected here, so the loop need not check them.
class GazeRequestQueue final : public GazeClient {
 public:
  struct Item {
    enum class Kind { kMode, kFixate, kRequest, kWithdraw };
    Kind kind = Kind::kMode;
    GazeMode mode = GazeMode::kAttend;                 ///< kMode
    Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< kFixate
    GazeRequest request;                               ///< kRequest; of kWithdraw only client and key
  };

  /// kFixate returns to the last fixated place; rejected without one.
  PortReply setMode(GazeMode mode) override;
  PortReply fixate(const Eigen::Vector3d& p_odom) override;
  PortReply request(const GazeRequest& request) override;
  PortReply withdraw(const std::string& client, const std::string& key) override;
  std::optional<GazeStatus> status() override { return status_; }

  /// Adds an item that another queue has checked.
  void push(const Item& message) { items_.push_back(message); }
  /// For the owner: the items since the last call, oldest first.
  std::vector<Item> take();
  /// @param p_odom_robot places farther from it than kFarthestPlace_m are rejected from now on.
  void publish(GazeStatus status, const Eigen::Vector2d& p_odom_robot) {
    status_ = std::move(status);
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
