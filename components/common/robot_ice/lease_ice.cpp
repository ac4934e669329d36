#include "common/robot_ice/lease_ice.h"

#include <Ice/Ice.h>

#include <random>

#include "common/config/text_format.h"
#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

constexpr std::size_t kMaximumName = 100;
constexpr double kShortestTimeout_s = 0.1;
constexpr double kLongestTimeout_s = 60.0;

avm::LeaseState toIce(const CommandLease::State& state) {
  return {state.held, state.client, state.priority, state.implicit, state.remaining_s};
}

void requireClient(const std::string& client) {
  if (!client.empty() && client.size() <= kMaximumName) return;
  throw avm::InvalidArgument("client has " + std::to_string(client.size()) + " characters (must have 1.." +
                             std::to_string(kMaximumName) + ")");
}

}  // namespace

std::string makeSecret() {
  std::random_device random;
  std::string digits;
  for (int i = 0; i < 4; ++i) digits += formatted("%08x", random());
  return digits;
}

std::string connectionOf(const Ice::Current& current) {
  const auto address = current.ctx.find("_con.remoteAddress");
  const auto port = current.ctx.find("_con.remotePort");
  if (address != current.ctx.end() && port != current.ctx.end()) return address->second + ":" + port->second;
  if (current.con == nullptr) return "this process";
  try {
    for (auto info = current.con->getInfo(); info != nullptr; info = info->underlying) {
      const auto ip = std::dynamic_pointer_cast<Ice::IPConnectionInfo>(info);
      if (ip != nullptr) return ip->remoteAddress + ":" + std::to_string(ip->remotePort);
    }
    return current.con->type();
  } catch (const Ice::LocalException&) {
    return "a closed connection";
  }
}

avm::Lease LeaseGuard::acquire(const std::string& client, int priority, double timeout_s,
                               const Ice::Current& current) {
  requireClient(client);
  requireInRange("priority", priority, 0, CommandLease::kMaximumPriority);
  requireInRange("timeoutS", timeout_s, kShortestTimeout_s, kLongestTimeout_s);
  const auto timeout =
      std::chrono::duration_cast<CommandLease::Duration>(std::chrono::duration<double>(timeout_s));
  const std::string connection = connectionOf(current);
  CommandLease::Grant grant;
  {
    const std::lock_guard lock(mutex_);
    grant = lease_.acquire(client, priority, timeout, connection, now_());
  }
  if (grant.id.empty()) refuse(grant.reason);
  return {grant.id, timeout_s};
}

void LeaseGuard::renew(const std::string& id) {
  std::string reason;
  {
    const std::lock_guard lock(mutex_);
    reason = lease_.renew(id, now_());
  }
  if (!reason.empty()) refuse(reason);
}

bool LeaseGuard::release(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return lease_.release(id, now_());
}

bool LeaseGuard::endSession(const std::string& client) {
  const std::lock_guard lock(mutex_);
  return lease_.releaseConnection(client, now_());
}

avm::LeaseState LeaseGuard::state() const {
  const std::lock_guard lock(mutex_);
  return toIce(lease_.state(now_()));
}

void LeaseGuard::stop() {
  const std::lock_guard lock(mutex_);
  lease_.stop(now_());
}

std::string LeaseGuard::admit(const Ice::Current& current, CommandLease::Duration holds) {
  const auto entry = current.ctx.find(kLeaseContext);
  const std::string connection = connectionOf(current);
  const std::lock_guard lock(mutex_);
  return lease_.admit(entry == current.ctx.end() ? std::string() : entry->second, connection, now_(), holds);
}

void LeaseGuard::require(const Ice::Current& current, CommandLease::Duration holds) {
  const std::string reason = admit(current, holds);
  if (!reason.empty()) refuse(reason);
}

bool LeaseGuard::admits(const Ice::Current& current, CommandLease::Duration holds) {
  return admit(current, holds).empty();
}

void LeaseGuard::refuse(const std::string& reason) const {
  throw avm::LeaseRefused(reason, state());
}

}  // namespace vismem
