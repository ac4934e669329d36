/// @file Servants and clients in one process over real connections, on a port of the system's choice.
#pragma once

#include <Ice/Ice.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "support/eventually.h"

namespace vismem {

inline Ice::InitializationData quietIce() {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  data.properties->setProperty("Ice.MessageSizeMax", "16384");
  data.properties->setProperty("Ice.Default.InvocationTimeout", "3000");
  data.properties->setProperty("Ice.RetryIntervals", "-1");
  data.properties->setProperty("Ice.Warn.Dispatch", "0");
  return data;
}

/// A server: destroy it and make another at the same port to restart it.
class LoopbackServer {
 public:
  explicit LoopbackServer(int port = 0) : communicator_(quietIce()) {
    adapter_ = communicator_->createObjectAdapterWithEndpoints("Loopback",
                                                               "tcp -h 127.0.0.1 -p " + std::to_string(port));
  }
  ~LoopbackServer() { communicator_->destroy(); }

  void add(const std::string& identity, const std::shared_ptr<Ice::Object>& servant) {
    adapter_->add(servant, Ice::stringToIdentity(identity));
  }
  void activate() { adapter_->activate(); }
  void deactivate() { adapter_->deactivate(); }
  int port() const {
    return std::dynamic_pointer_cast<Ice::IPEndpointInfo>(adapter_->getEndpoints().at(0)->getInfo())->port;
  }

 private:
  Ice::CommunicatorHolder communicator_;
  std::shared_ptr<Ice::ObjectAdapter> adapter_;
};

class LoopbackClient {
 public:
  LoopbackClient() : communicator_(quietIce()) {}

  template <typename Prx>
  std::shared_ptr<Prx> proxy(const std::string& identity, int port) {
    return Ice::uncheckedCast<Prx>(
        communicator_->stringToProxy(identity + ":tcp -h 127.0.0.1 -p " + std::to_string(port)));
  }

 private:
  Ice::CommunicatorHolder communicator_;
};

}  // namespace vismem
