#include "common/robot_ice/replay_ice.h"

#include <limits>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

constexpr StampUs kMillisecondUs = 1000;

jderobot::ReplayerStatus stateToIce(ReplayState state) {
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

ReplayState stateFromIce(jderobot::ReplayerStatus state) {
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
  return {stateToIce(s.state), s.file, s.first_us, s.last_us, s.stamp_us, s.rate, s.loop};
}

ReplayStatus fromIce(const avm::ReplayInfo& i) {
  return {stateFromIce(i.state), i.file, i.firstUs, i.lastUs, i.stampUs, i.rate, i.loop};
}

avm::ReplayContents toIce(const ReplayContents& c) {
  avm::ReplayContents result{{}, c.notes, static_cast<Ice::Long>(c.images), c.begin_us, c.end_us};
  for (const LogTopicInfo& topic : c.topics) {
    result.topics.push_back({topic.name, topic.type, static_cast<Ice::Long>(topic.messages)});
  }
  return result;
}

ReplayContents fromIce(const avm::ReplayContents& c) {
  ReplayContents result{{}, c.notes, static_cast<std::uint64_t>(c.images), c.beginUs, c.endUs};
  for (const avm::LogTopic& topic : c.topics) {
    result.topics.push_back({topic.name, topic.type, static_cast<std::uint64_t>(topic.messages)});
  }
  return result;
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

avm::CommandReply ReplayServant::step(int images, const Ice::Current&) {
  requireInRange("images", images, -100'000, 100'000);
  if (images == 0) throw avm::InvalidArgument("images = 0 (must not be 0)");
  return toIce(replay_.step(images));
}

avm::CommandReply ReplayServant::setRange(Ice::Long begin_us, Ice::Long end_us, const Ice::Current&) {
  if (begin_us >= end_us) {
    throw avm::InvalidArgument("beginUs = " + std::to_string(begin_us) +
                               " (must be less than endUs = " + std::to_string(end_us) + ")");
  }
  return toIce(replay_.setRange(begin_us, end_us));
}

bool ReplayServant::setStep(int step_ms, const Ice::Current&) {
  return step_ms >= 0 && replay_.setPlayLength(step_ms * kMillisecondUs).ok();
}

Ice::Long ReplayServant::getTime(const Ice::Current&) {
  const ReplayStatus status = replay_.status();
  return (status.stamp_us - status.first_us) / kMillisecondUs;
}

bool ReplayServant::goTo(Ice::Long seek_ms, const Ice::Current&) {
  const ReplayStatus status = replay_.status();
  // A number from an untrusted client: the sum below must not overflow.
  if (seek_ms < 0 || seek_ms > (status.last_us - status.first_us) / kMillisecondUs) return false;
  return replay_.seek(status.first_us + seek_ms * kMillisecondUs).ok();
}

jderobot::ReplayerStatus ReplayServant::getStatus(const Ice::Current&) {
  return stateToIce(replay_.status().state);
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

PortReply RemoteReplay::step(int images) {
  return runRemote(proxy_, "replay", [images](avm::ReplayPrx& r) { return r.step(images); });
}

PortReply RemoteReplay::setRange(StampUs begin_us, StampUs end_us) {
  return runRemote(proxy_, "replay", [=](avm::ReplayPrx& r) { return r.setRange(begin_us, end_us); });
}

PortReply RemoteReplay::setPlayLength(StampUs length_us) {
  if (length_us < 0 || length_us / kMillisecondUs > std::numeric_limits<int>::max()) {
    return PortReply::rejected("a length of " + std::to_string(length_us) + " us (must be 0..2147483 s)");
  }
  return runRemote(proxy_, "replay", [length_us](avm::ReplayPrx& r) {
    if (!r.setStep(static_cast<int>(length_us / kMillisecondUs)))
      throw avm::Refused("it does not play in pieces");
    return avm::CommandReply{false, ""};
  });
}

ReplayContents RemoteReplay::contents() const {
  try {
    if (proxy_) return fromIce(proxy_->contents());
  } catch (const Ice::Exception&) {
    // A peer that is away has no contents, as the header says.
    return {};
  }
  return {};
}

PortReply RemoteReplay::setLoop(bool loop) {
  return runRemote(proxy_, "replay", [loop](avm::ReplayPrx& r) { return r.setLoop(loop); });
}

}  // namespace vismem
