/// @file The lease of an actuator over Ice: who may command it now.
#pragma once

#include <avm/lease.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "common/robot/command_lease.h"

namespace vismem {

/// Entry of a call's context that holds the id of a lease.
inline constexpr const char* kLeaseContext = "lease";

/// 128 bits of the system's randomness as 32 hexadecimal digits, which nobody can guess: a lease's id, the
/// token of a robot's page.
std::string makeSecret();

/// The caller's address, "127.0.0.1:41233"; of a gateway's client the one that the gateway reports (entries
/// _con.remoteAddress and _con.remotePort of the context). "this process" for a call without a connection.
std::string connectionOf(const Ice::Current& current);

/// A CommandLease with the clock, and its refusals as exceptions. *Thread-safe.*
class LeaseGuard {
 public:
  using Now = std::function<std::chrono::steady_clock::time_point()>;

  explicit LeaseGuard(Now now = std::chrono::steady_clock::now) : now_(std::move(now)), lease_(makeSecret) {}

  /// @throws avm::InvalidArgument naming the argument, avm::LeaseRefused.
  avm::Lease acquire(const std::string& client, int priority, double timeout_s, const Ice::Current& current);
  /// @throws avm::LeaseRefused.
  void renew(const std::string& id);
  /// @return whether the lease was held until now.
  bool release(const std::string& id);
  /// @return whether a lease of this client was held until now.
  bool endSession(const std::string& client);
  avm::LeaseState state() const;
  void stop();

  /// Before a command is followed. @throws avm::LeaseRefused if another client holds the lease.
  /// @param holds how long the command holds by itself: a client without a lease has the actuator for that
  /// time.
  void require(const Ice::Current& current, CommandLease::Duration holds = CommandLease::kImplicitTimeout);
  /// The same for JdeRobot's operations, which declare no exception.
  bool admits(const Ice::Current& current, CommandLease::Duration holds = CommandLease::kImplicitTimeout);

 private:
  std::string admit(const Ice::Current& current, CommandLease::Duration holds);
  [[noreturn]] void refuse(const std::string& reason) const;

  const Now now_;
  mutable std::mutex mutex_;
  CommandLease lease_;
};

/// The operations of avm::Leasable for a servant of an interface that extends it. *Thread-safe.*
template <typename Interface>
class LeasedServant : public Interface {
 public:
  explicit LeasedServant(LeaseGuard::Now now) : lease_(std::move(now)) {}

  avm::Lease acquire(std::string client, int priority, double timeout_s,
                     const Ice::Current& current) override {
    return lease_.acquire(client, priority, timeout_s, current);
  }
  void renew(std::string id, const Ice::Current&) override { lease_.renew(id); }
  avm::CommandReply release(std::string id, const Ice::Current&) override {
    if (!lease_.release(id)) return {true, "the lease had ended"};
    endMotion();
    return {};
  }
  avm::CommandReply endSession(std::string client, const Ice::Current&) override {
    if (!lease_.endSession(client)) return {true, "that client held no lease"};
    endMotion();
    return {};
  }
  avm::LeaseState holder(const Ice::Current&) override { return lease_.state(); }

 protected:
  /// A lease was given back: what was commanded by speed shall stop.
  virtual void endMotion() = 0;

  LeaseGuard lease_;
};

}  // namespace vismem
