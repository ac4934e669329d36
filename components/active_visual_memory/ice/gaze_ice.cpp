#include "active_visual_memory/ice/gaze_ice.h"

#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

constexpr double kMaxPriority = 100.0;
constexpr std::size_t kMaxNameLength = 100;

avm::GazeTarget targetToIce(const std::optional<Eigen::Vector3d>& p_odom,
                            const std::optional<PanTilt>& direction) {
  return {p_odom.has_value(), toIce(p_odom.value_or(Eigen::Vector3d::Zero())),
          toIce(direction.value_or(PanTilt{}))};
}

void targetFromIce(const avm::GazeTarget& target, std::optional<Eigen::Vector3d>& p_odom,
                   std::optional<PanTilt>& direction) {
  if (target.isPlace) {
    p_odom = fromIce(target.place);
  } else {
    direction = fromIce(target.direction);
  }
}

// The enumerations have the same order on both sides; a test walks through all values.
avm::AttentionKind kindToIce(AttentionKind kind) {
  return static_cast<avm::AttentionKind>(static_cast<int>(kind));
}
AttentionKind kindFromIce(avm::AttentionKind kind) {
  return static_cast<AttentionKind>(static_cast<int>(kind));
}

void requireName(const char* name, const std::string& value, bool may_be_empty) {
  if (value.empty() && !may_be_empty) throw avm::InvalidArgument(std::string(name) + " is empty");
  if (value.size() > kMaxNameLength) {
    throw avm::InvalidArgument(std::string(name) + " has " + std::to_string(value.size()) +
                               " characters (must be at most " + std::to_string(kMaxNameLength) + ")");
  }
}

void requirePlace(const avm::Vector3& place) {
  requireFinite("place.x", place.x);
  requireFinite("place.y", place.y);
  requireFinite("place.z", place.z);
}

}  // namespace

avm::GazeMode toIce(GazeMode mode) {
  return static_cast<avm::GazeMode>(static_cast<int>(mode));
}
GazeMode fromIce(avm::GazeMode mode) {
  return static_cast<GazeMode>(static_cast<int>(mode));
}

avm::AttentionPoint toIce(const AttentionPoint& p) {
  return {static_cast<Ice::Long>(p.id), kindToIce(p.kind), targetToIce(p.p_odom, p.direction), p.salience};
}

AttentionPoint fromIce(const avm::AttentionPoint& p) {
  AttentionPoint result;
  result.id = static_cast<std::uint64_t>(p.id);
  result.kind = kindFromIce(p.kind);
  targetFromIce(p.target, result.p_odom, result.direction);
  result.salience = p.salience;
  return result;
}

avm::GazeStatus toIce(const GazeStatus& s) {
  avm::GazeStatus result;
  result.stampUs = s.stamp_us;
  result.mode = toIce(s.mode);
  result.state = static_cast<avm::GazeState>(static_cast<int>(s.state));
  result.hasTarget = s.target.has_value();
  result.target = toIce(s.target.value_or(AttentionPoint{}));
  result.points.reserve(s.points.size());
  for (const AttentionPoint& point : s.points) result.points.push_back(toIce(point));
  result.visits = static_cast<Ice::Long>(s.visits);
  result.givenUp = static_cast<Ice::Long>(s.given_up);
  return result;
}

GazeStatus fromIce(const avm::GazeStatus& s) {
  GazeStatus result;
  result.stamp_us = s.stampUs;
  result.mode = fromIce(s.mode);
  result.state = static_cast<GazeState>(static_cast<int>(s.state));
  if (s.hasTarget) result.target = fromIce(s.target);
  result.points.reserve(s.points.size());
  for (const avm::AttentionPoint& point : s.points) result.points.push_back(fromIce(point));
  result.visits = static_cast<std::uint64_t>(s.visits);
  result.given_up = static_cast<std::uint64_t>(s.givenUp);
  return result;
}

avm::GazeRequest toIce(const GazeRequest& r) {
  return {r.client, r.key, targetToIce(r.p_odom, r.direction), r.priority, r.deadline_us};
}

GazeRequest fromIce(const avm::GazeRequest& r) {
  GazeRequest result;
  result.client = r.client;
  result.key = r.key;
  targetFromIce(r.target, result.p_odom, result.direction);
  result.priority = r.priority;
  result.deadline_us = r.deadlineUs;
  return result;
}

avm::CommandReply GazeServant::setMode(avm::GazeMode mode, const Ice::Current&) {
  return toIce(gaze_.setMode(fromIce(mode)));
}

avm::CommandReply GazeServant::fixate(avm::Vector3 place, const Ice::Current&) {
  requirePlace(place);
  return toIce(gaze_.fixate(fromIce(place)));
}

avm::CommandReply GazeServant::request(avm::GazeRequest wish, const Ice::Current&) {
  requireName("client", wish.client, false);
  requireName("key", wish.key, true);
  if (wish.target.isPlace) {
    requirePlace(wish.target.place);
  } else {
    requireFinite("direction.panRad", wish.target.direction.panRad);
    requireFinite("direction.tiltRad", wish.target.direction.tiltRad);
  }
  if (!(wish.priority > 0.0 && wish.priority <= kMaxPriority)) {
    throw avm::InvalidArgument("priority = " + std::to_string(wish.priority) + " (must be > 0, at most 100)");
  }
  return toIce(gaze_.request(fromIce(wish)));
}

avm::CommandReply GazeServant::withdraw(std::string client, std::string key, const Ice::Current&) {
  requireName("client", client, false);
  requireName("key", key, true);
  return toIce(gaze_.withdraw(client, key));
}

avm::GazeStatus GazeServant::status(const Ice::Current&) {
  const auto status = gaze_.status();
  if (!status) throw avm::NotAvailable("the gaze has not begun: no image yet");
  return toIce(*status);
}

PortReply RemoteGaze::setMode(GazeMode mode) {
  return runRemote(proxy_, "gaze", [mode](avm::GazePrx& gaze) { return gaze.setMode(toIce(mode)); });
}

PortReply RemoteGaze::fixate(const Eigen::Vector3d& p_odom) {
  return runRemote(proxy_, "gaze", [&p_odom](avm::GazePrx& gaze) { return gaze.fixate(toIce(p_odom)); });
}

PortReply RemoteGaze::request(const GazeRequest& request) {
  if (!request.p_odom && !request.direction)
    return PortReply::rejected("neither a place nor a direction to look at");
  return runRemote(proxy_, "gaze", [&request](avm::GazePrx& gaze) { return gaze.request(toIce(request)); });
}

PortReply RemoteGaze::withdraw(const std::string& client, const std::string& key) {
  return runRemote(proxy_, "gaze", [&](avm::GazePrx& gaze) { return gaze.withdraw(client, key); });
}

std::optional<GazeStatus> RemoteGaze::status() {
  if (!proxy_) return std::nullopt;
  try {
    return fromIce(proxy_->status());
  } catch (const Ice::Exception&) {
    // Away or not begun: the header promises an empty answer for both.
    return std::nullopt;
  }
}

}  // namespace vismem
