/// @file The robot that `calibrate body` drives: its ports over Ice under leases of its own, and recordings.
#pragma once

#include <Ice/Ice.h>

#include <chrono>
#include <memory>
#include <string>

#include "active_visual_memory/app/config.h"
#include "calibration/core/body/body_record.h"
#include "common/process/log.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"

namespace vismem {

/// Camera, head and base of a running robot. Head and base are leased: other clients' commands are refused
/// meanwhile. Leases end with this object, or by themselves if the process dies. *Single-threaded.*
class LeasedRobot {
 public:
  static constexpr int kPriority = 60;
  /// As long as a busy machine may stand still; so long a process that is killed keeps others out.
  static constexpr double kLease_s = 15.0;

  /// @param motors proxy of an avm::Base. @throw ConfigError for a malformed proxy, std::runtime_error when a
  /// lease is refused or a server does not answer.
  LeasedRobot(const ActiveVisualMemoryConfig& setup, const std::string& motors, int port_offset);
  ~LeasedRobot();
  LeasedRobot(const LeasedRobot&) = delete;
  LeasedRobot& operator=(const LeasedRobot&) = delete;

  /// Renews both leases once a second. Call it at every round: not each step commands the head, and a
  /// simulated robot of a busy machine may stay in it for longer than a lease.
  void keepLeases();

  FrameSource& camera() { return *camera_; }
  PanTiltUnit& head() { return *head_; }
  MobileBase& base() { return *base_; }

 private:
  Logger log_;
  Ice::CommunicatorHolder ice_;
  std::shared_ptr<avm::BasePrx> motors_;
  std::shared_ptr<avm::PanTiltPrx> unit_;
  std::string base_lease_;
  std::string head_lease_;
  std::chrono::steady_clock::time_point renewed_ = std::chrono::steady_clock::now();
  std::unique_ptr<RemoteFrameSource> camera_;
  std::unique_ptr<RemotePanTiltUnit> head_;
  std::unique_ptr<RemoteMobileBase> base_;
};

/// The record of a robot that was driven around a board by hand or by a calibration before: views of every
/// fifth of a second. @throw std::runtime_error naming what the recording lacks.
BodyRecord recordOfBag(const std::string& path, const BoardSpec& board, BoardPlace place);

}  // namespace vismem
