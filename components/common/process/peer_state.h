/// @file What a component knows about a peer, and when it tries again (SPEC C3). Pure: the time is passed in.
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
  /// Why it is away; empty while connected.
  const std::string& reason() const { return reason_; }
  /// How often it came back.
  int reconnections() const { return reconnections_; }

  /// Whether the back-off allows a try. Always before the first failure.
  bool mayTry(SteadyTime now) const { return now >= next_try_; }
  Change succeeded();
  /// A try or a call has failed. The pause doubles with every failure in a row.
  Change failed(SteadyTime now, const std::string& reason);

 private:
  /// Short enough that the application is whole within 2 s of a peer's return, Ice's own retries included.
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
