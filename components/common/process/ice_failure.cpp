#include "common/process/ice_failure.h"

#include <Ice/Ice.h>

#include <cstring>

namespace vismem {
namespace {

std::string errorText(int error, const std::string& otherwise) {
  return error == 0 ? otherwise : std::strerror(error);
}

/// Removes Ice's source file and the name of the exception at the beginning of a text.
std::string withoutPlace(std::string text) {
  const auto title = text.find("Exception:\n");
  if (title != std::string::npos) text.erase(0, title + std::strlen("Exception:\n"));
  for (auto& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

}  // namespace

std::string describeFailure(const std::exception& failure) {
  const auto* exception = &failure;
  if (dynamic_cast<const Ice::ConnectionRefusedException*>(exception) != nullptr) return "connection refused";
  if (dynamic_cast<const Ice::TimeoutException*>(exception) != nullptr ||
      dynamic_cast<const Ice::InvocationTimeoutException*>(exception) != nullptr) {
    return "no answer in time";
  }
  if (dynamic_cast<const Ice::ConnectionLostException*>(exception) != nullptr) return "connection lost";
  if (const auto* dns = dynamic_cast<const Ice::DNSException*>(exception)) return "unknown host " + dns->host;
  if (const auto* socket = dynamic_cast<const Ice::SocketException*>(exception)) {
    return errorText(socket->error, "socket failure");
  }
  if (const auto* absent = dynamic_cast<const Ice::ObjectNotExistException*>(exception)) {
    return "no object " + Ice::identityToString(absent->id) + " there";
  }
  if (const auto* no_facet = dynamic_cast<const Ice::RequestFailedException*>(exception)) {
    return "object " + Ice::identityToString(no_facet->id) + " has no " + no_facet->operation;
  }
  if (const auto* large = dynamic_cast<const Ice::MemoryLimitException*>(exception)) {
    return "message larger than Ice.MessageSizeMax" +
           (large->reason.empty() ? "" : " (" + large->reason + ")");
  }
  if (const auto* endpoint = dynamic_cast<const Ice::EndpointParseException*>(exception))
    return endpoint->str;
  if (const auto* proxy = dynamic_cast<const Ice::ProxyParseException*>(exception)) return proxy->str;
  if (const auto* unknown = dynamic_cast<const Ice::UnknownException*>(exception)) {
    return "failed in the peer: " + withoutPlace(unknown->unknown);
  }
  const auto text = withoutPlace(failure.what());
  const auto* ice = dynamic_cast<const Ice::Exception*>(exception);
  return text.empty() && ice != nullptr ? ice->ice_id() : text;
}

std::string withoutUsualOptions(std::string text) {
  for (const std::string usual : {" -t -e 1.1", " -t 10000", " -t 60000", " -r /"}) {
    for (auto place = text.find(usual); place != std::string::npos; place = text.find(usual)) {
      text.erase(place, usual.size());
    }
  }
  return text;
}

std::string proxyText(const Ice::ObjectPrx& proxy) {
  return withoutUsualOptions(proxy.ice_toString());
}

}  // namespace vismem
