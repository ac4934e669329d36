/// @file A client of real processes in tests.
#pragma once

#include <Ice/Ice.h>

#include <memory>
#include <string>

#include "support/component_process.h"

namespace vismem {

/// Makes proxies to the objects of processes. Outlives what uses them.
class IceClient {
 public:
  template <typename Prx>
  std::shared_ptr<Prx> find(const ComponentProcess& server, const std::string& identity) {
    return Ice::uncheckedCast<Prx>(communicator_->stringToProxy(server.proxy(identity)));
  }

 private:
  static Ice::InitializationData settings() {
    Ice::InitializationData data;
    data.properties = Ice::createProperties();
    data.properties->setProperty("Ice.MessageSizeMax", "16384");
    data.properties->setProperty("Ice.Default.InvocationTimeout", "3000");
    return data;
  }
  Ice::CommunicatorHolder communicator_{settings()};
};

}  // namespace vismem
