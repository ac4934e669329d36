#include "common/process/reply_limit.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace vismem {
namespace {

/// Header of a reply [bytes], which DispatchObserver::reply does not include.
constexpr std::int64_t kReplyHeader = 18;

std::shared_ptr<Ice::IPConnectionInfo> addressOf(std::shared_ptr<Ice::ConnectionInfo> info) {
  while (info != nullptr) {
    if (auto address = std::dynamic_pointer_cast<Ice::IPConnectionInfo>(info)) return address;
    info = info->underlying;
  }
  return nullptr;
}

std::string peerOf(const Ice::IPConnectionInfo& address) {
  return address.remoteAddress + ":" + std::to_string(address.remotePort);
}

std::string nameOf(const Ice::IPConnectionInfo& address) {
  return peerOf(address) + " " + std::to_string(address.localPort);
}

}  // namespace

/// One connection: bytes answered and not yet sent.
class ReplyLimit::Traffic : public Ice::Instrumentation::ConnectionObserver {
 public:
  Traffic(std::shared_ptr<ReplyLimit> owner, std::string name)
      : owner_(std::move(owner)), name_(std::move(name)) {}

  void attach() override {}
  void detach() override {
    const std::lock_guard lock(owner_->mutex_);
    const auto known = owner_->connections_.find(name_);
    // A newer connection may have the same addresses.
    if (known != owner_->connections_.end() && known->second.lock().get() == this)
      owner_->connections_.erase(known);
  }
  void failed(const std::string&) override {}
  void sentBytes(int count) override {
    // Other messages (validation, heartbeats) are sent too.
    const std::lock_guard lock(mutex_);
    unsent_ = std::max<std::int64_t>(0, unsent_ - count);
  }
  void receivedBytes(int) override {}

  /// @return whether this answer is the first above the limit.
  bool answered(std::int64_t bytes, std::int64_t limit) {
    const std::lock_guard lock(mutex_);
    unsent_ += bytes;
    return unsent_ > limit && !std::exchange(beyond_, true);
  }

 private:
  const std::shared_ptr<ReplyLimit> owner_;
  const std::string name_;
  std::mutex mutex_;
  std::int64_t unsent_ = 0;
  bool beyond_ = false;
};

class ReplyLimit::Dispatch : public Ice::Instrumentation::DispatchObserver {
 public:
  Dispatch(std::shared_ptr<ReplyLimit> owner, std::shared_ptr<Traffic> traffic,
           std::shared_ptr<Ice::Connection> connection)
      : owner_(std::move(owner)), traffic_(std::move(traffic)), connection_(std::move(connection)) {}

  void attach() override {}
  void detach() override {}
  void failed(const std::string&) override {}
  void userException() override {}
  void reply(int size) override {
    if (!traffic_->answered(size + kReplyHeader, owner_->limit_bytes_)) return;
    std::string peer = "a client";
    try {
      if (const auto address = addressOf(connection_->getInfo())) peer = peerOf(*address);
    } catch (const Ice::LocalException&) {
      return;  // closed meanwhile
    }
    connection_->close(Ice::ConnectionClose::Forcefully);
    owner_->closed_(peer);
  }

 private:
  const std::shared_ptr<ReplyLimit> owner_;
  const std::shared_ptr<Traffic> traffic_;
  const std::shared_ptr<Ice::Connection> connection_;
};

std::shared_ptr<Ice::Instrumentation::ConnectionObserver> ReplyLimit::getConnectionObserver(
    const std::shared_ptr<Ice::ConnectionInfo>& info, const std::shared_ptr<Ice::Endpoint>&,
    Ice::Instrumentation::ConnectionState state,
    const std::shared_ptr<Ice::Instrumentation::ConnectionObserver>& known) {
  if (known) return known;
  const auto address = addressOf(info);
  if (!address || state == Ice::Instrumentation::ConnectionState::ConnectionStateClosed) return nullptr;
  auto traffic = std::make_shared<Traffic>(shared_from_this(), nameOf(*address));
  const std::lock_guard lock(mutex_);
  connections_[nameOf(*address)] = traffic;
  return traffic;
}

std::shared_ptr<Ice::Instrumentation::DispatchObserver> ReplyLimit::getDispatchObserver(
    const Ice::Current& current, int) {
  if (current.con == nullptr) return nullptr;  // a call inside the process
  std::shared_ptr<Traffic> traffic;
  try {
    const auto address = addressOf(current.con->getInfo());
    if (!address) return nullptr;
    const std::lock_guard lock(mutex_);
    const auto known = connections_.find(nameOf(*address));
    if (known != connections_.end()) traffic = known->second.lock();
  } catch (const Ice::LocalException&) {
    return nullptr;  // closed meanwhile
  }
  if (!traffic) return nullptr;
  return std::make_shared<Dispatch>(shared_from_this(), std::move(traffic), current.con);
}

}  // namespace vismem
