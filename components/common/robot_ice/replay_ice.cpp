#include "common/robot_ice/replay_ice.h"

#include <limits>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

constexpr StampUs kMillisecondUs = 1000;

jderobot::ReplayerStatus toIce(ReplayState state) {
  switch (state) {
    case ReplayState::kPlaying:
      return jderobot::ReplayerStatus::PLAYING;
    case ReplayState::kPaused:
      return jderobot::ReplayerStatus::PAUSED;
    case ReplayState::kFinished:
      return jderobot::ReplayerStatus::FINISHED;
    case ReplayState::kWaiting:
      break;
  }
  return jderobot::ReplayerStatus::WAITING;
}

ReplayState fromIce(jderobot::ReplayerStatus state) {
  switch (state) {
    case jderobot::ReplayerStatus::PLAYING:
      return ReplayState::kPlaying;
    case jderobot::ReplayerStatus::PAUSED:
      return ReplayState::kPaused;
    case jderobot::ReplayerStatus::FINISHED:
      return ReplayState::kFinished;
    case jderobot::ReplayerStatus::WAITING:
      break;
  }
  return ReplayState::kWaiting;
}

}  // namespace

avm::ReplayInfo toIce(const ReplayStatus& s) {
  return {toIce(s.state), s.file, s.first_us, s.last_us, s.stamp_us, s.rate, s.loop};
}

ReplayStatus fromIce(const avm::ReplayInfo& i) {
  return {fromIce(i.state), i.file, i.firstUs, i.lastUs, i.stampUs, i.rate, i.loop};
}

avm::CommandReply ReplayServant::setPaused(bool paused, const Ice::Current&) {
  return toIce(paused ? replay_.pause() : replay_.play());
}

avm::CommandReply ReplayServant::seek(Ice::Long stamp_us, const Ice::Current&) {
  return toIce(replay_.seek(stamp_us));
}

avm::CommandReply ReplayServant::setRate(double rate, const Ice::Current&) {
  requireInRange("rate", rate, 0.01, 1000.0);
  return toIce(replay_.setRate(rate));
}

avm::CommandReply ReplayServant::setLoop(bool loop, const Ice::Current&) {
  return toIce(replay_.setLoop(loop));
}

Ice::Long ReplayServant::getTime(const Ice::Current&) {
  const ReplayStatus status = replay_.status();
  return (status.stamp_us - status.first_us) / kMillisecondUs;
}

bool ReplayServant::goTo(Ice::Long seek_ms, const Ice::Current&) {
  const ReplayStatus status = replay_.status();
  // A stranger's number: the sum below must not overflow.
  if (seek_ms < 0 || seek_ms > (status.last_us - status.first_us) / kMillisecondUs) return false;
  return replay_.seek(status.first_us + seek_ms * kMillisecondUs).ok();
}

jderobot::ReplayerStatus ReplayServant::getStatus(const Ice::Current&) {
  return toIce(replay_.status().state);
}

RemoteReplay::RemoteReplay(const std::shared_ptr<avm::ReplayPrx>& proxy)
    : proxy_(boundedProxy(proxy, kCommandTimeout_ms)) {}

ReplayStatus RemoteReplay::status() const {
  std::optional<ReplayStatus> now;
  try {
    if (proxy_) now = fromIce(proxy_->info());
  } catch (const Ice::Exception&) {
    // The last known status is the answer, as the header says.
    now.reset();
  }
  const std::lock_guard lock(mutex_);
  if (now) last_status_ = *now;
  ReplayStatus status = last_status_;
  if (!now) status.state = ReplayState::kWaiting;
  return status;
}

PortReply RemoteReplay::play() {
  return runRemote(proxy_, "replay", [](avm::ReplayPrx& r) { return r.setPaused(false); });
}

PortReply RemoteReplay::pause() {
  return runRemote(proxy_, "replay", [](avm::ReplayPrx& r) { return r.setPaused(true); });
}

PortReply RemoteReplay::seek(StampUs stamp_us) {
  return runRemote(proxy_, "replay", [stamp_us](avm::ReplayPrx& r) { return r.seek(stamp_us); });
}

PortReply RemoteReplay::setRate(double rate) {
  return runRemote(proxy_, "replay", [rate](avm::ReplayPrx& r) { return r.setRate(rate); });
}

PortReply RemoteReplay::setLoop(bool loop) {
  return runRemote(proxy_, "replay", [loop](avm::ReplayPrx& r) { return r.setLoop(loop); });
}

}  // namespace vismem
