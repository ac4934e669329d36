/// @file Wishes of localization on their way to a remote avm::Gaze, which may come and go. SPEC B4, C3.
#pragma once

#include <avm/gaze.h>

#include <chrono>
#include <memory>
#include <string>

#include "common/process/peer.h"
#include "common/process/status.h"
#include "localization/core/gaze_planner.h"

namespace vismem {

/// Never waits: a gaze that is away or frozen costs wishes, not poses. The component's status tells how it
/// fares: the peer "Gaze", the rates "gaze wishes", "gaze wishes refused" and "gaze wishes lost".
/// *Single-threaded* (owner: the loop); answers come on other threads.
class GazeSender {
 public:
  /// @param proxy of the configuration. @param status and @param log live until close() has returned.
  GazeSender(const std::shared_ptr<Ice::ObjectPrx>& proxy, StatusBoard& status, Logger& log);
  ~GazeSender() { close(); }

  void send(const GazePlan& plan);
  /// To be called now and then: asks an idle peer whether it is there.
  void keepInTouch();
  /// Answers that come later count no more.
  void close();

 private:
  struct Shared;
  /// @return false: too many calls are unanswered.
  bool beginCall();

  std::shared_ptr<avm::GazePrx> proxy_;
  std::shared_ptr<Shared> shared_;
  std::chrono::steady_clock::time_point last_call_{};
};

}  // namespace vismem
