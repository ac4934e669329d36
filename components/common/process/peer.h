/// @file A remote object that may disappear and return. Implements C3.
#pragma once

#include <Ice/Ice.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "common/process/ice_failure.h"
#include "common/process/log.h"
#include "common/process/peer_state.h"
#include "common/process/status.h"

namespace vismem {

/// The part of RemotePeer that does not depend on the proxy's type. Thread-safe; holds no lock during calls
/// of Ice.
class PeerLink {
 public:
  /// @param name   for people: "Camera".
  /// @param proxy  as in the configuration.
  PeerLink(std::string name, std::shared_ptr<Ice::ObjectPrx> proxy, StatusBoard& status, Logger& log);

  bool connected() const;
  const std::string& name() const { return name_; }
  /// The proxy's text.
  const std::string& proxyText() const { return proxy_text_; }
  const std::shared_ptr<Ice::ObjectPrx>& proxy() const { return proxy_; }

  /// @return whether the caller shall try to connect now, and then must call succeeded or failed. Only one
  ///         caller at a time gets true.
  bool beginTry();
  void succeeded();
  void failed(const std::string& reason);
  /// Reports that a call failed inside a peer that is present.
  void callFailed(const std::string& reason);

 private:
  /// Called under the lock, so that status and log receive the changes in their order.
  void publish(PeerState::Change change);

  const std::string name_;
  const std::shared_ptr<Ice::ObjectPrx> proxy_;
  const std::string proxy_text_;
  StatusBoard& status_;
  Logger& log_;

  mutable std::mutex mutex_;
  PeerState state_;
  bool trying_ = false;
};

/// For the clients of remote ports (LinkReport): shows the outcome of their requests as the state of a peer.
std::function<void(const std::string& failure)> reportTo(const std::string& name,
                                                         const std::shared_ptr<Ice::ObjectPrx>& proxy,
                                                         StatusBoard& status, Logger& log);

/// A proxy that connects at its first use and again after every loss, with a pause between attempts. It logs
/// each change once: "waiting for Camera at ...", "Camera is back". Its state is part of the component's
/// status. Thread-safe. Made by ComponentHost::peer.
///
///   camera = host.peer<avm::CameraPrx>("Camera", config.camera_proxy);
///   if (auto size = camera->call([](avm::CameraPrx& proxy) { return proxy.getImageDescription(); })) ...
template <typename Prx>
class RemotePeer {
 public:
  RemotePeer(std::string name, std::shared_ptr<Ice::ObjectPrx> proxy, StatusBoard& status, Logger& log)
      : link_(std::move(name), std::move(proxy), status, log) {}

  bool connected() const { return link_.connected(); }
  const std::string& name() const { return link_.name(); }

  /// @return the proxy of a connected peer; nullptr while it is away. After the pause this call tries to
  /// connect, which takes up to the invocation timeout: never call it from a dispatch.
  std::shared_ptr<Prx> get() {
    if (link_.connected()) return typed();
    if (!link_.beginTry()) return nullptr;
    try {
      // A remote call, so it also shows that the object is there and has the right type.
      auto proxy = Ice::checkedCast<Prx>(link_.proxy());
      if (proxy) {
        {
          const std::scoped_lock lock(mutex_);
          typed_ = proxy;
        }
        link_.succeeded();
        return proxy;
      }
      link_.failed("the object there is no " + std::string(Prx::ice_staticId()));
    } catch (const Ice::LocalException& failure) {
      link_.failed(describeFailure(failure));
    }
    return nullptr;
  }

  /// For callers that use the proxy themselves: after a failed call the peer counts as lost until a new
  /// attempt succeeds. A failure inside a peer that answers is only logged.
  void lost(const Ice::LocalException& failure) {
    if (dynamic_cast<const Ice::UnknownException*>(&failure) != nullptr) {
      link_.callFailed(describeFailure(failure));
    } else {
      link_.failed(describeFailure(failure));
    }
  }

  /// Calls `work` with the proxy.
  /// @return its result (true if it has none); empty (false) if the peer is away or the call failed. Declared
  /// (user) exceptions of the operation pass through.
  template <typename Work>
  auto call(Work&& work) {
    using Result = std::invoke_result_t<Work, Prx&>;
    const auto proxy = get();
    if constexpr (std::is_void_v<Result>) {
      if (!proxy) return false;
      try {
        work(*proxy);
        return true;
      } catch (const Ice::LocalException& failure) {
        lost(failure);
        return false;
      }
    } else {
      std::optional<Result> result;
      if (!proxy) return result;
      try {
        result = work(*proxy);
      } catch (const Ice::LocalException& failure) {
        lost(failure);
      }
      return result;
    }
  }

 private:
  std::shared_ptr<Prx> typed() const {
    const std::scoped_lock lock(mutex_);
    return typed_;
  }

  PeerLink link_;
  mutable std::mutex mutex_;
  std::shared_ptr<Prx> typed_;
};

}  // namespace vismem
