#include "common/robot/command_lease.h"

#include "common/config/text_format.h"

namespace vismem {

std::string CommandLease::busy(Time now) const {
  const Holder* current = holder(now);
  if (current == nullptr) return "the lease has ended";
  const double remaining_s = std::chrono::duration<double>(current->end - now).count();
  if (current->priority > kMaximumPriority) {
    return formatted("stopped: no command for another %.1f s", remaining_s);
  }
  // Without the time that remains: a refused command is repeated, and a status logs each change of a reason.
  return current->client + " holds the lease (priority " + std::to_string(current->priority) + ")";
}

bool CommandLease::isHeldBy(const std::string& id, Time now) const {
  const Holder* current = holder(now);
  return current != nullptr && !current->implicit() && current->id == id;
}

CommandLease::Grant CommandLease::acquire(const std::string& client, int priority, Duration timeout,
                                          const std::string& connection, Time now) {
  const Holder* current = holder(now);
  if (current != nullptr && current->priority >= priority) return {{}, busy(now)};
  holder_ = Holder{make_id_(), client, connection, priority, timeout, now + timeout};
  return {holder_->id, {}};
}

std::string CommandLease::renew(const std::string& id, Time now) {
  if (!isHeldBy(id, now)) return busy(now);
  holder_->end = now + holder_->timeout;
  return {};
}

bool CommandLease::release(const std::string& id, Time now) {
  if (!isHeldBy(id, now)) return false;
  holder_.reset();
  return true;
}

bool CommandLease::releaseConnection(const std::string& connection, Time now) {
  const Holder* current = holder(now);
  if (current == nullptr || current->connection != connection || connection.empty()) return false;
  holder_.reset();
  return true;
}

std::string CommandLease::admit(const std::string& id, const std::string& connection, Time now,
                                Duration implicit_timeout) {
  if (!id.empty()) return renew(id, now);
  const Holder* current = holder(now);
  if (current != nullptr && !(current->implicit() && current->connection == connection)) return busy(now);
  holder_ = Holder{{}, connection, connection, 0, implicit_timeout, now + implicit_timeout};
  return {};
}

void CommandLease::stop(Time now) {
  holder_ = Holder{make_id_(), "stop", "", kMaximumPriority + 1, kStopTimeout, now + kStopTimeout};
}

CommandLease::State CommandLease::state(Time now) const {
  const Holder* current = holder(now);
  if (current == nullptr) return {};
  return {true, current->client, current->priority, current->implicit(),
          std::chrono::duration<double>(current->end - now).count()};
}

}  // namespace vismem
