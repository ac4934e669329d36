/// @file The benchmark's server (server.h) as a process of its own, with proxies for its clients.
#pragma once

#include <Ice/Ice.h>

#include <memory>
#include <string>

#include "common/process/child_process.h"
#include "common/process/log.h"

namespace vismem {

class ServerProcess {
 public:
  /// Waits until it serves.
  /// @throw std::runtime_error if it does not.
  ServerProcess();

  template <typename Prx>
  std::shared_ptr<Prx> proxy(const std::string& identity) const {
    return Ice::uncheckedCast<Prx>(communicator_->stringToProxy(identity + ":" + endpoint_));
  }
  pid_t pid() const { return process_.pid(); }
  int port() const { return port_; }

 private:
  Logger log_;
  ChildProcess process_;
  Ice::CommunicatorHolder communicator_;
  std::string endpoint_;
  int port_ = 0;
};

}  // namespace vismem
