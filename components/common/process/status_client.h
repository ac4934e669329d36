/// @file Reads the status of several components at once; an absent or frozen one does not delay the others.
#pragma once

#include <Ice/Ice.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/status.h"

namespace vismem {

struct StatusAnswer {
  std::optional<StatusReport> report;
  /// Reason why there is none: "connection refused", "no answer in time".
  std::string failure;
  /// True if no server listens there, as opposed to a server without an answer.
  bool no_server = false;
};

/// @param proxies  of avm::Component objects, as texts.
/// @return one answer for each, in their order, after `timeout` at the latest. Never throws for a peer.
std::vector<StatusAnswer> askStatus(Ice::Communicator& communicator, const std::vector<std::string>& proxies,
                                    std::chrono::milliseconds timeout);

/// The effective configuration of one component.
/// @throw std::runtime_error with the reason why it did not answer.
std::vector<Setting> askConfiguration(Ice::Communicator& communicator, const std::string& proxy,
                                      std::chrono::milliseconds timeout);

}  // namespace vismem
