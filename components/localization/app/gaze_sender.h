/// @file Sends the localization's gaze requests to a remote avm::Gaze, which may come and go. See B4, C3.
#pragma once

#include <avm/gaze.h>

#include <chrono>
#include <memory>
#include <string>

#include "common/process/peer.h"
#include "common/process/status.h"
#include "localization/core/gaze/gaze_planner.h"

namespace vismem {

/// Never waits: an absent or frozen gaze loses requests, not poses. Status: the peer "Gaze" and the rates
/// "gaze requests", "gaze requests refused" and "gaze requests lost". *Single-threaded* (owner: the loop);
/// answers come on other threads.
class GazeSender {
 public:
  /// @param proxy of the configuration.
  /// @param status and @param log must outlive close().
  GazeSender(const std::shared_ptr<Ice::ObjectPrx>& proxy, StatusBoard& status, Logger& log);
  ~GazeSender() { close(); }

  void send(const GazePlan& plan);
  /// Pings an idle peer. To be called at least once per second.
  void keepInTouch();
  /// Later answers are ignored.
  void close();

 private:
  struct Shared;
  /// @return false with too many unanswered calls.
  bool beginCall();

  std::shared_ptr<avm::GazePrx> proxy_;
  std::shared_ptr<Shared> shared_;
  std::chrono::steady_clock::time_point last_call_{};
};

}  // namespace vismem
