#include "common/process/ice_failure.h"

#include <Ice/Ice.h>
#include <IceUtil/ThreadException.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

namespace vismem {
namespace {

/// The limit of this process that an error of the system may come from: " (ulimit -n is 64)".
std::string limitText(int error) {
  struct Limit {
    int error;
    __rlimit_resource resource;
    const char* option;
    rlim_t unit;
  };
  static constexpr std::array<Limit, 4> kLimits{{{EMFILE, RLIMIT_NOFILE, "-n", 1},
                                                 {EAGAIN, RLIMIT_NPROC, "-u", 1},
                                                 {ENOMEM, RLIMIT_AS, "-v", 1024},
                                                 {EFBIG, RLIMIT_FSIZE, "-f", 1024}}};
  std::string text;
  for (const Limit& limit : kLimits) {
    // A thread needs memory of its own.
    const bool concerns = limit.error == error || (error == EAGAIN && limit.error == ENOMEM);
    rlimit now{};
    if (!concerns || getrlimit(limit.resource, &now) != 0) continue;
    const std::string value =
        now.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(now.rlim_cur / limit.unit);
    text += (text.empty() ? " (ulimit " : ", ") + std::string(limit.option) + " is " + value;
  }
  return text.empty() ? text : text + ")";
}

std::string errorText(int error, const std::string& otherwise) {
  return error == 0 ? otherwise : std::strerror(error) + limitText(error);
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
  if (const auto* thread = dynamic_cast<const IceUtil::ThreadSyscallException*>(exception)) {
    return "no further thread: " + errorText(thread->error(), "failure of the system");
  }
  if (const auto* system = dynamic_cast<const std::system_error*>(exception)) {
    return system->what() + limitText(system->code().value());
  }
  if (dynamic_cast<const std::bad_alloc*>(exception) != nullptr) {
    return "not enough memory" + limitText(ENOMEM);
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
