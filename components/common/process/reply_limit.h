/// @file An upper bound of unread replies per client connection.
#pragma once

#include <Ice/Ice.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace vismem {

/// Ice queues replies without bound for a client that sends requests and does not read. This observer counts,
/// per connection, the bytes of replies that are not yet written to the socket. It closes a connection above
/// the limit. Install it as InitializationData.observer. *Thread-safe.*
class ReplyLimit : public Ice::Instrumentation::CommunicatorObserver,
                   public std::enable_shared_from_this<ReplyLimit> {
 public:
  /// @param limit_bytes above the largest replies that a client may have in flight at once.
  /// @param closed called with the peer's address of each closed connection; on any thread.
  ReplyLimit(std::int64_t limit_bytes, std::function<void(const std::string& peer)> closed)
      : limit_bytes_(limit_bytes), closed_(std::move(closed)) {}

  std::shared_ptr<Ice::Instrumentation::ConnectionObserver> getConnectionObserver(
      const std::shared_ptr<Ice::ConnectionInfo>& info, const std::shared_ptr<Ice::Endpoint>&,
      Ice::Instrumentation::ConnectionState,
      const std::shared_ptr<Ice::Instrumentation::ConnectionObserver>& known) override;
  std::shared_ptr<Ice::Instrumentation::DispatchObserver> getDispatchObserver(const Ice::Current& current,
                                                                              int size) override;

  // Unused callbacks.
  std::shared_ptr<Ice::Instrumentation::Observer> getConnectionEstablishmentObserver(
      const std::shared_ptr<Ice::Endpoint>&, const std::string&) override {
    return nullptr;
  }
  std::shared_ptr<Ice::Instrumentation::Observer> getEndpointLookupObserver(
      const std::shared_ptr<Ice::Endpoint>&) override {
    return nullptr;
  }
  std::shared_ptr<Ice::Instrumentation::ThreadObserver> getThreadObserver(
      const std::string&, const std::string&, Ice::Instrumentation::ThreadState,
      const std::shared_ptr<Ice::Instrumentation::ThreadObserver>&) override {
    return nullptr;
  }
  std::shared_ptr<Ice::Instrumentation::InvocationObserver> getInvocationObserver(
      const std::shared_ptr<Ice::ObjectPrx>&, const std::string&, const Ice::Context&) override {
    return nullptr;
  }
  void setObserverUpdater(const std::shared_ptr<Ice::Instrumentation::ObserverUpdater>&) override {}

 private:
  class Traffic;
  class Dispatch;

  const std::int64_t limit_bytes_;
  const std::function<void(const std::string&)> closed_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<Traffic>> connections_;  ///< by both addresses
};

}  // namespace vismem
