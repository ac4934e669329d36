#include "common/process/peer.h"

namespace vismem {

PeerLink::PeerLink(std::string name, std::shared_ptr<Ice::ObjectPrx> proxy, StatusBoard& status, Logger& log)
    : name_(std::move(name)),
      proxy_(std::move(proxy)),
      proxy_text_(vismem::proxyText(*proxy_)),
      status_(status),
      log_(log) {
  publish(PeerState::Change::kNone);
}

bool PeerLink::connected() const {
  const std::scoped_lock lock(mutex_);
  return state_.connected();
}

bool PeerLink::beginTry() {
  const std::scoped_lock lock(mutex_);
  if (trying_ || !state_.mayTry(std::chrono::steady_clock::now())) return false;
  trying_ = true;
  return true;
}

void PeerLink::succeeded() {
  const std::scoped_lock lock(mutex_);
  trying_ = false;
  publish(state_.succeeded());
}

void PeerLink::failed(const std::string& reason) {
  const std::scoped_lock lock(mutex_);
  trying_ = false;
  publish(state_.failed(std::chrono::steady_clock::now(), reason));
}

void PeerLink::callFailed(const std::string& reason) {
  status_.error(name_ + ": " + reason);
}

void PeerLink::publish(PeerState::Change change) {
  status_.setPeer({name_, proxy_text_, state_.link(), state_.reason(), state_.reconnections()});
  const auto line = describeChange(change, name_, proxy_text_, state_.reason());
  if (line.empty()) return;
  const bool bad = change == PeerState::Change::kWaiting || change == PeerState::Change::kLost;
  log_.write(bad ? LogLevel::kWarning : LogLevel::kInfo, line);
}

std::function<void(const std::string& failure)> reportTo(const std::string& name,
                                                         const std::shared_ptr<Ice::ObjectPrx>& proxy,
                                                         StatusBoard& status, Logger& log) {
  return [link = std::make_shared<PeerLink>(name, proxy, status, log)](const std::string& failure) {
    if (failure.empty()) {
      link->succeeded();
    } else {
      link->failed(failure);
    }
  };
}

}  // namespace vismem
