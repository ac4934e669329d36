/// @file A replayed log over Ice: the servant over any ReplayControl, and the client, which is one again.
/// JdeRobot's operations count milliseconds since the log's beginning; they are converted here. SPEC C4.
#pragma once

#include <avm/replay.h>

#include <memory>
#include <mutex>

#include "common/robot/control_ports.h"
#include "common/robot_ice/remote.h"

namespace vismem {

avm::ReplayInfo toIce(const ReplayStatus& status);
ReplayStatus fromIce(const avm::ReplayInfo& info);

/// avm::Replay and with it jderobot::replayControl. *Thread-safe* over a control that is; it must outlive the
/// adapter.
class ReplayServant : public avm::Replay {
 public:
  explicit ReplayServant(ReplayControl& replay) : replay_(replay) {}

  avm::ReplayInfo info(const Ice::Current&) override { return toIce(replay_.status()); }
  avm::CommandReply setPaused(bool paused, const Ice::Current&) override;
  avm::CommandReply seek(Ice::Long stamp_us, const Ice::Current&) override;
  avm::CommandReply setRate(double rate, const Ice::Current&) override;
  avm::CommandReply setLoop(bool loop, const Ice::Current&) override;

  bool pause(const Ice::Current&) override { return replay_.pause().ok(); }
  bool resume(const Ice::Current&) override { return replay_.play().ok(); }
  void setReplay(bool replay, const Ice::Current&) override { replay_.setLoop(replay); }
  bool setStep(int, const Ice::Current&) override { return false; }
  Ice::Long getTime(const Ice::Current&) override;
  bool goTo(Ice::Long seek_ms, const Ice::Current&) override;
  jderobot::ReplayerStatus getStatus(const Ice::Current&) override;

 private:
  ReplayControl& replay_;
};

/// A remote replay as a port. All calls block for at most a second. *Thread-safe.*
class RemoteReplay : public ReplayControl {
 public:
  explicit RemoteReplay(const std::shared_ptr<avm::ReplayPrx>& proxy);

  /// As the server said last, in state kWaiting, while it cannot be reached.
  ReplayStatus status() const override;
  PortReply play() override;
  PortReply pause() override;
  PortReply seek(StampUs stamp_us) override;
  PortReply setRate(double rate) override;
  PortReply setLoop(bool loop) override;

 private:
  std::shared_ptr<avm::ReplayPrx> proxy_;
  mutable std::mutex mutex_;
  mutable ReplayStatus last_status_;
};

}  // namespace vismem
