#include "drivers/pioneer_p2os/p2os_link.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace vismem::p2os {
namespace {

using namespace std::chrono_literals;

/// A packet of the handshake takes at most 50 ms at 9600 bit/s; a USB adapter delays bytes by 16 ms.
constexpr auto kAnswer = 300ms;
/// A robot is silent within the duration of a packet after the command to close.
constexpr auto kQuiet = 40ms;
constexpr auto kQuietAtMost = 400ms;
/// Packets are short; a line that accepts none for this time is blocked.
constexpr auto kWrite = 500ms;
constexpr int kTries = 3;

}  // namespace

Link::Link(std::string path, std::vector<int> bauds_bps)
    : path_(std::move(path)), bauds_bps_(std::move(bauds_bps)) {}

std::string Link::send(const Bytes& packet) {
  return port_.write(packet, Clock::now() + kWrite);
}

std::string Link::sendHalt() {
  // Stop first: the first packet reactivates an old speed, so it must be the one that ends it, for both
  // wheels at once.
  for (const Bytes& packet :
       {command(Command::kStop), command(Command::kSpeed, 0), command(Command::kTurnRate, 0)}) {
    if (std::string why = send(packet); !why.empty()) return why;
  }
  return {};
}

Link::Received Link::receive(Clock::time_point deadline) {
  while (true) {
    if (auto data = reader_.next()) return {std::move(data), {}};
    const auto input = port_.read(deadline);
    switch (input.kind) {
      case SerialPort::Input::Kind::kBytes:
        reader_.add(input.bytes);
        break;
      case SerialPort::Input::Kind::kGone:
        return {std::nullopt, input.why};
      case SerialPort::Input::Kind::kNothing:
      case SerialPort::Input::Kind::kWoken:
        return {};
    }
  }
}

void Link::readUntilQuiet() {
  const auto end = Clock::now() + kQuietAtMost;
  while (Clock::now() < end) {
    const auto input = port_.read(std::min(Clock::now() + kQuiet, end));
    if (input.kind == SerialPort::Input::Kind::kNothing || input.kind == SerialPort::Input::Kind::kGone)
      break;
  }
  reader_.reset();
}

Link::Answer Link::handshake(const std::function<bool()>& given_up, std::string& why) {
  // The first packet may reactivate an old session.
  why = sendHalt();
  if (why.empty()) why = send(command(Command::kClose));
  if (!why.empty()) return Answer::kNothing;
  readUntilQuiet();
  if (given_up()) return Answer::kNothing;  // which may have been set meanwhile
  for (int step = 0; step < kSyncSteps; ++step) {
    why = send(sync(step));
    if (!why.empty()) return Answer::kNothing;
    const auto deadline = Clock::now() + kAnswer;
    bool echoed = false;
    while (!echoed) {
      const Received received = receive(deadline);
      if (!received.lost.empty()) {
        why = received.lost;
        return Answer::kNothing;
      }
      if (!received.data) {
        if (given_up()) return Answer::kNothing;
        if (Clock::now() < deadline) continue;  // woken
        return reader_.garbageBytes() + reader_.wrongChecksums() > 0 ? Answer::kGarbage : Answer::kNothing;
      }
      const std::uint8_t type = received.data->front();
      if (type == kStandingType || type == kMovingType) return Answer::kOldSession;
      if (type != step) continue;
      echoed = true;
      if (step != kSyncSteps - 1) continue;
      const auto identity = parseIdentity(*received.data);
      if (!identity) return Answer::kGarbage;
      identity_ = *identity;
    }
  }
  return Answer::kSession;
}

std::string Link::connect(const std::function<bool()>& given_up) {
  bool garbage = false;
  bool old_session = false;
  std::string tried;
  std::string why = port_.open(path_, bauds_bps_.front());
  if (!why.empty()) return why;
  const auto bauds = bauds_bps_;
  for (const int baud : bauds) {
    why = port_.setBaud(baud);
    if (!why.empty()) break;
    tried += (tried.empty() ? "" : ", ") + std::to_string(baud);
    for (int i = 0; i < kTries && !given_up(); ++i) {
      const Answer answer = handshake(given_up, why);
      if (!why.empty()) break;
      if (answer == Answer::kSession) {
        // Found: tried first the next time.
        std::stable_partition(bauds_bps_.begin(), bauds_bps_.end(), [&](int b) { return b == baud; });
        return {};
      }
      garbage = garbage || answer == Answer::kGarbage;
      old_session = answer == Answer::kOldSession;
      // No valid answer at this rate: retries would not change that.
      if (answer != Answer::kOldSession && i > 0) break;
    }
    if (!why.empty() || old_session || given_up()) break;
  }
  port_.close();
  if (!why.empty()) return why;
  if (old_session) return path_ + ": the robot goes on with an old session and does not close it";
  if (garbage) return path_ + ": what answers speaks no P2OS (tried " + tried + " bit/s)";
  return path_ + ": no robot answers (tried " + tried + " bit/s)";
}

void Link::disconnect() {
  if (!port_.isOpen()) return;
  // As far as the line still accepts bytes.
  if (sendHalt().empty()) static_cast<void>(send(command(Command::kClose)));
  port_.close();
}

}  // namespace vismem::p2os
