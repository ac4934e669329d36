/// @file Gaze over Ice: conversions, the servant over a GazeClient, and the remote client. See A1-A6, C4.
#pragma once

#include <avm/gaze.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/remote.h"
#include "common/visual_memory/gaze.h"

namespace vismem {

avm::AttentionKind toIce(AttentionKind kind);
avm::GazeMode toIce(GazeMode mode);
avm::GazeState toIce(GazeState state);
/// A point with both a place and a direction travels as a place.
avm::AttentionPoint toIce(const AttentionPoint& point);
avm::GazeStatus toIce(const GazeStatus& status);
avm::GazeRequest toIce(const GazeRequest& request);

AttentionKind fromIce(avm::AttentionKind kind);
GazeMode fromIce(avm::GazeMode mode);
GazeState fromIce(avm::GazeState state);
AttentionPoint fromIce(const avm::AttentionPoint& point);
GazeStatus fromIce(const avm::GazeStatus& status);
GazeRequest fromIce(const avm::GazeRequest& request);

/// Provides the newest status to any number of remote readers. The component's loop publishes. *Thread-safe.*
class GazeBroadcaster {
 public:
  using Latest = LatestValue<GazeStatus>;

  void publish(GazeStatus status) {
    const StampUs stamp_us = status.stamp_us;
    newest_.publish(std::make_shared<const GazeStatus>(std::move(status)), stamp_us);
  }
  /// No status comes for now: `message` says what is waited for. kFinished: the log is at its end.
  void setState(SourceState state, std::string message) { newest_.setState(state, std::move(message)); }
  /// Answers all who wait, now and from now on.
  void stop() { newest_.stop(); }

  Latest& stream() { return newest_; }

 private:
  Latest newest_{"the gaze has not begun: no image yet"};
};

/// *Thread-safe* over a thread-safe client; it and the broadcaster must outlive the adapter. Invalid requests
/// (checkGazeRequest) are refused with avm::InvalidArgument.
class GazeServant : public avm::Gaze {
 public:
  GazeServant(GazeClient& gaze, GazeBroadcaster& statuses) : gaze_(gaze), statuses_(statuses) {}

  avm::CommandReply setMode(avm::GazeMode mode, const Ice::Current&) override;
  avm::CommandReply fixate(avm::Vector3 place, const Ice::Current&) override;
  avm::CommandReply request(avm::GazeRequest request, const Ice::Current&) override;
  avm::CommandReply withdraw(std::string client, std::string key, const Ice::Current&) override;
  avm::GazeStatus status(const Ice::Current&) override;
  void nextAsync(Ice::Long after_us, std::function<void(const avm::GazeResult&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;

 private:
  GazeClient& gaze_;
  GazeBroadcaster& statuses_;
};

/// Remote gaze as a port. Calls block for at most a second; a peer that is away is a rejection with the
/// reason. *Thread-safe.*
class RemoteGaze : public GazeClient {
 public:
  explicit RemoteGaze(const std::shared_ptr<avm::GazePrx>& proxy)
      : proxy_(boundedProxy(proxy, kCommandTimeout_ms)) {}

  PortReply setMode(GazeMode mode) override;
  PortReply fixate(const Eigen::Vector3d& p_odom) override;
  PortReply request(const GazeRequest& request) override;
  PortReply withdraw(const std::string& client, const std::string& key) override;
  /// Empty while there is none or the peer is away.
  std::optional<GazeStatus> status() override;

 private:
  std::shared_ptr<avm::GazePrx> proxy_;
};

}  // namespace vismem
