/// @file A replayed log over Ice: the servant of a ReplayControl, and a client that implements ReplayControl.
/// JdeRobot's operations count milliseconds since the log's beginning; they are converted here. See C4.
#pragma once

#include <avm/replay.h>

#include <memory>
#include <mutex>

#include "common/robot/control_ports.h"
#include "common/robot_ice/remote.h"

namespace vismem {

avm::ReplayContents toIce(const ReplayContents& contents);
ReplayContents fromIce(const avm::ReplayContents& contents);
avm::ReplayInfo toIce(const ReplayStatus& status);
ReplayStatus fromIce(const avm::ReplayInfo& info);

/// Serves avm::Replay and with it jderobot::replayControl. *Thread-safe* for a thread-safe control, which
/// must outlive the adapter.
class ReplayServant : public avm::Replay {
 public:
  explicit ReplayServant(ReplayControl& replay) : replay_(replay) {}

  avm::ReplayInfo info(const Ice::Current&) override { return toIce(replay_.status()); }
  avm::CommandReply setPaused(bool paused, const Ice::Current&) override;
  avm::CommandReply seek(Ice::Long stamp_us, const Ice::Current&) override;
  avm::CommandReply setRate(double rate, const Ice::Current&) override;
  avm::CommandReply setLoop(bool loop, const Ice::Current&) override;
  avm::ReplayContents contents(const Ice::Current&) override { return toIce(replay_.contents()); }
  avm::CommandReply step(int images, const Ice::Current&) override;
  avm::CommandReply setRange(Ice::Long begin_us, Ice::Long end_us, const Ice::Current&) override;

  bool pause(const Ice::Current&) override { return replay_.pause().ok(); }
  bool resume(const Ice::Current&) override { return replay_.play().ok(); }
  void setReplay(bool replay, const Ice::Current&) override { replay_.setLoop(replay); }
  bool setStep(int step_ms, const Ice::Current&) override;
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

  /// The last status from the server; in state kWaiting while it cannot be reached.
  ReplayStatus status() const override;
  PortReply play() override;
  PortReply pause() override;
  PortReply seek(StampUs stamp_us) override;
  PortReply setRate(double rate) override;
  PortReply setLoop(bool loop) override;
  PortReply step(int images) override;
  PortReply setPlayLength(StampUs length_us) override;
  PortReply setRange(StampUs begin_us, StampUs end_us) override;
  /// Nothing while it cannot be reached.
  ReplayContents contents() const override;

 private:
  std::shared_ptr<avm::ReplayPrx> proxy_;
  mutable std::mutex mutex_;
  mutable ReplayStatus last_status_;
};

}  // namespace vismem
