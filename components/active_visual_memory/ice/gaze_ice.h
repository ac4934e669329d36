/// @file Gaze over Ice: the servant over any GazeClient, and the remote one, which is one again. SPEC A1-A6.
#pragma once

#include <avm/gaze.h>

#include <memory>
#include <optional>
#include <string>

#include "common/robot_ice/remote.h"
#include "common/visual_memory/gaze.h"

namespace vismem {

avm::GazeMode toIce(GazeMode mode);
/// A point with both a place and a direction travels as a place.
avm::AttentionPoint toIce(const AttentionPoint& point);
avm::GazeStatus toIce(const GazeStatus& status);
avm::GazeRequest toIce(const GazeRequest& request);

GazeMode fromIce(avm::GazeMode mode);
AttentionPoint fromIce(const avm::AttentionPoint& point);
GazeStatus fromIce(const avm::GazeStatus& status);
GazeRequest fromIce(const avm::GazeRequest& request);

/// *Thread-safe* over a client that is; it must outlive the adapter. Wishes without a client's name, with
/// numbers that are not finite or a priority outside (0, 100] are refused with avm::InvalidArgument.
class GazeServant : public avm::Gaze {
 public:
  explicit GazeServant(GazeClient& gaze) : gaze_(gaze) {}

  avm::CommandReply setMode(avm::GazeMode mode, const Ice::Current&) override;
  avm::CommandReply fixate(avm::Vector3 place, const Ice::Current&) override;
  avm::CommandReply request(avm::GazeRequest wish, const Ice::Current&) override;
  avm::CommandReply withdraw(std::string client, std::string key, const Ice::Current&) override;
  avm::GazeStatus status(const Ice::Current&) override;

 private:
  GazeClient& gaze_;
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
