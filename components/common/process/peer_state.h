/// @file Connection state of a peer, and the back-off of its connection attempts (see C3). Pure: the time is
/// passed in.
#pragma once

#include <chrono>
#include <string>

#include "common/process/metrics.h"

namespace vismem {

/// Single-threaded (RemotePeer guards it).
class PeerState {
 public:
  enum class Link { kAbsent, kConnected, kLost };
  /// A change worth a line in the log.
  enum class Change { kNone, kWaiting, kConnected, kLost, kBack };

  Link link() const { return link_; }
  bool connected() const { return link_ == Link::kConnected; }
  /// Reason why it is away; empty while connected.
  const std::string& reason() const { return reason_; }
  /// Number of reconnections.
  int reconnections() const { return reconnections_; }

  /// Whether the back-off allows an attempt. Always true before the first failure.
  bool mayTry(SteadyTime now) const { return now >= next_try_; }
  Change succeeded();
  /// To be called after a failed attempt or call. The pause doubles with every failure in a row.
  Change failed(SteadyTime now, const std::string& reason);

 private:
  /// First pause: short enough that all peers are connected within 2 s of a peer's return, retries of Ice
  /// included.
  static constexpr std::chrono::milliseconds kFirstPause{50};
  static constexpr std::chrono::milliseconds kLongestPause{500};

  Link link_ = Link::kAbsent;
  bool waiting_ = false;
  std::string reason_;
  int reconnections_ = 0;
  std::chrono::milliseconds pause_ = kFirstPause;
  SteadyTime next_try_ = SteadyTime::min();
};

/// The line for the log: "waiting for Camera at cameraA:tcp -h 127.0.0.1 -p 9999 (connection refused)".
std::string describeChange(PeerState::Change change, const std::string& name, const std::string& proxy,
                           const std::string& reason);

}  // namespace vismem
