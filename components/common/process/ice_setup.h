/// @file Ice settings of all processes: defaults, logging, messages.
#pragma once

#include <Ice/Ice.h>

#include <memory>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/log.h"

namespace vismem {

/// Default properties of Ice, which the configuration may override; the source gives their reasons.
const std::vector<Setting>& iceDefaults();

/// A communicator with the configuration's keys, iceDefaults(), and Ice's messages in the component's log.
/// @throw ConfigError for values that Ice refuses.
std::shared_ptr<Ice::Communicator> makeCommunicator(const Properties& properties, Logger& log);

/// Problems of keys that end in "Proxy": a malformed proxy, one without an endpoint (and without a locator),
/// or one without a port. Empty values are valid.
std::vector<Problem> checkProxies(const ConfigReader& config, const Properties& properties,
                                  Ice::Communicator& communicator);

/// Transports that a key with endpoints may name. Web pages reach WebSocket endpoints, so that only faces are
/// served there (faces.h).
enum class Transport { kNotWeb, kWebOnly };

/// Problems of a key with endpoints of a server: malformed endpoints, or a transport that it may not name.
std::vector<Problem> checkEndpoints(const std::string& key, const std::string& endpoints, Transport transport,
                                    const Properties& properties, Ice::Communicator& communicator);

/// Problems of endpoints that other machines reach: without TLS anybody there commands the component, and
/// with TLS anybody does unless callers need a certificate.
/// @param permission key that allows endpoints without TLS: "Simulator.PlainRemote"; named in the message.
std::vector<Problem> checkRemoteEndpoints(const std::string& key, const std::string& endpoints,
                                          Transport transport, const std::string& permission,
                                          const Properties& properties, Ice::Communicator& communicator);

/// @throw std::runtime_error with the key, the endpoints, the adapter and the reason ("Address already in
/// use") if they cannot be served.
std::shared_ptr<Ice::ObjectAdapter> makeAdapter(Ice::Communicator& communicator, const std::string& adapter,
                                                const std::string& key, const std::string& endpoints);

/// "tcp -h 127.0.0.1 -p 41233:ws -h 127.0.0.1 -p 40021": what clients write into their proxies.
std::string publishedEndpoints(Ice::ObjectAdapter& adapter);

/// Whether only this machine reaches an address: 127.*, ::1, localhost. Empty and "*" are all addresses.
bool isLoopback(const std::string& host);

/// The endpoints at which other machines reach an adapter without TLS, as publishedEndpoints; empty if none
/// do.
std::string openEndpoints(Ice::ObjectAdapter& adapter);

}  // namespace vismem
