/// @file The publisher's side of a topic of IceStorm, which may be away.
#pragma once

#include <Ice/Ice.h>
#include <avm/fleet.h>

#include <memory>
#include <string>

#include "common/process/component.h"

namespace IceStorm {
class TopicManagerPrx;
}

namespace vismem {

/// Finds or makes the topic at its first report, and again after a loss. *Single-threaded*.
class RobotTopic {
 public:
  /// @param manager proxy of the topic manager.
  RobotTopic(ComponentHost& host, const std::string& manager, std::string name);
  ~RobotTopic();

  /// Publishes a report; while the topic is away it is dropped.
  /// @return whether it was handed over.
  bool publish(const avm::RobotReport& report);

 private:
  const std::shared_ptr<RemotePeer<IceStorm::TopicManagerPrx>> manager_;
  const std::string name_;
  std::shared_ptr<avm::FleetListenerPrx> publisher_;
};

}  // namespace vismem
