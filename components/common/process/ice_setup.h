/// @file How the processes of the application use Ice: defaults, logging, messages.
#pragma once

#include <Ice/Ice.h>

#include <memory>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/log.h"

namespace vismem {

/// Properties of Ice that hold unless the configuration says otherwise, with their reasons in the source.
const std::vector<Setting>& iceDefaults();

/// A communicator with the configuration's keys, our defaults, and Ice's own messages in our log.
/// @throw ConfigError for values that Ice refuses.
std::shared_ptr<Ice::Communicator> makeCommunicator(const Properties& properties, Logger& log);

/// Problems of keys that end in "Proxy" and hold no well-formed proxy, or one that leads nowhere: without an
/// endpoint (and no locator that would find one) or without a port. Empty values are none.
std::vector<Problem> checkProxies(const ConfigReader& config, const Properties& properties,
                                  Ice::Communicator& communicator);

/// Problems of a key that holds endpoints to serve at: not well-formed.
std::vector<Problem> checkEndpoints(const std::string& key, const std::string& endpoints,
                                    const Properties& properties, Ice::Communicator& communicator);

/// @throw std::runtime_error that names the key, the endpoints, the adapter and the reason ("Address already
/// in
///        use") if they cannot be served.
std::shared_ptr<Ice::ObjectAdapter> makeAdapter(Ice::Communicator& communicator, const std::string& adapter,
                                                const std::string& key, const std::string& endpoints);

/// "tcp -h 127.0.0.1 -p 41233:ws -h 127.0.0.1 -p 40021": what clients write into their proxies.
std::string publishedEndpoints(Ice::ObjectAdapter& adapter);

}  // namespace vismem
