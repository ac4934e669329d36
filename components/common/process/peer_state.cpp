#include "common/process/peer_state.h"

#include <algorithm>

namespace vismem {

PeerState::Change PeerState::succeeded() {
  pause_ = kFirstPause;
  next_try_ = SteadyTime::min();
  reason_.clear();
  waiting_ = false;
  if (link_ == Link::kConnected) return Change::kNone;
  const bool back = link_ == Link::kLost;
  if (back) ++reconnections_;
  link_ = Link::kConnected;
  return back ? Change::kBack : Change::kConnected;
}

PeerState::Change PeerState::failed(SteadyTime now, const std::string& reason) {
  reason_ = reason;
  next_try_ = now + pause_;
  pause_ = std::min(2 * pause_, kLongestPause);
  if (link_ == Link::kConnected) {
    link_ = Link::kLost;
    waiting_ = true;
    return Change::kLost;
  }
  if (waiting_) return Change::kNone;
  waiting_ = true;
  return Change::kWaiting;
}

std::string describeChange(PeerState::Change change, const std::string& name, const std::string& proxy,
                           const std::string& reason) {
  switch (change) {
    case PeerState::Change::kWaiting:
      return "waiting for " + name + " at " + proxy + " (" + reason + ")";
    case PeerState::Change::kConnected:
      return name + " is connected (" + proxy + ")";
    case PeerState::Change::kLost:
      return name + " is lost, waiting for it at " + proxy + " (" + reason + ")";
    case PeerState::Change::kBack:
      return name + " is back";
    case PeerState::Change::kNone:
      break;
  }
  return "";
}

}  // namespace vismem
