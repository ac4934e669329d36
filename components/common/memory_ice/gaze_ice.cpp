#include "common/memory_ice/gaze_ice.h"

#include <limits>
#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

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

/// @throws avm::InvalidArgument with the problem, if there is one.
void require(const std::string& problem) {
  if (!problem.empty()) throw avm::InvalidArgument(problem);
}

}  // namespace

avm::AttentionKind toIce(AttentionKind kind) {
  switch (kind) {
    case AttentionKind::kSegment:
      return avm::AttentionKind::Segment;
    case AttentionKind::kPrimitive:
      return avm::AttentionKind::Primitive;
    case AttentionKind::kScanning:
      return avm::AttentionKind::Scanning;
    case AttentionKind::kHypothesis:
      return avm::AttentionKind::Hypothesis;
    case AttentionKind::kClient:
      return avm::AttentionKind::Client;
  }
  return avm::AttentionKind::Segment;
}

AttentionKind fromIce(avm::AttentionKind kind) {
  switch (kind) {
    case avm::AttentionKind::Segment:
      return AttentionKind::kSegment;
    case avm::AttentionKind::Primitive:
      return AttentionKind::kPrimitive;
    case avm::AttentionKind::Scanning:
      return AttentionKind::kScanning;
    case avm::AttentionKind::Hypothesis:
      return AttentionKind::kHypothesis;
    case avm::AttentionKind::Client:
      return AttentionKind::kClient;
  }
  return AttentionKind::kSegment;
}

avm::GazeMode toIce(GazeMode mode) {
  switch (mode) {
    case GazeMode::kAttend:
      return avm::GazeMode::Attend;
    case GazeMode::kFixate:
      return avm::GazeMode::Fixate;
    case GazeMode::kHold:
      return avm::GazeMode::Hold;
    case GazeMode::kOff:
      return avm::GazeMode::Off;
  }
  return avm::GazeMode::Off;
}

GazeMode fromIce(avm::GazeMode mode) {
  switch (mode) {
    case avm::GazeMode::Attend:
      return GazeMode::kAttend;
    case avm::GazeMode::Fixate:
      return GazeMode::kFixate;
    case avm::GazeMode::Hold:
      return GazeMode::kHold;
    case avm::GazeMode::Off:
      return GazeMode::kOff;
  }
  return GazeMode::kOff;
}

avm::GazeState toIce(GazeState state) {
  switch (state) {
    case GazeState::kSelect:
      return avm::GazeState::Select;
    case GazeState::kSaccade:
      return avm::GazeState::Saccade;
    case GazeState::kAnalyse:
      return avm::GazeState::Analyse;
    case GazeState::kTrack:
      return avm::GazeState::Track;
  }
  return avm::GazeState::Select;
}

GazeState fromIce(avm::GazeState state) {
  switch (state) {
    case avm::GazeState::Select:
      return GazeState::kSelect;
    case avm::GazeState::Saccade:
      return GazeState::kSaccade;
    case avm::GazeState::Analyse:
      return GazeState::kAnalyse;
    case avm::GazeState::Track:
      return GazeState::kTrack;
  }
  return GazeState::kSelect;
}

avm::AttentionPoint toIce(const AttentionPoint& p) {
  return {static_cast<Ice::Long>(p.id), toIce(p.kind), targetToIce(p.p_odom, p.direction), p.salience};
}

AttentionPoint fromIce(const avm::AttentionPoint& p) {
  AttentionPoint result;
  result.id = static_cast<std::uint64_t>(p.id);
  result.kind = fromIce(p.kind);
  targetFromIce(p.target, result.p_odom, result.direction);
  result.salience = p.salience;
  return result;
}

avm::GazeStatus toIce(const GazeStatus& s) {
  avm::GazeStatus result;
  result.stampUs = s.stamp_us;
  result.mode = toIce(s.mode);
  result.state = toIce(s.state);
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
  result.state = fromIce(s.state);
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
  require(checkGazePlace(fromIce(place)));
  return toIce(gaze_.fixate(fromIce(place)));
}

avm::CommandReply GazeServant::request(avm::GazeRequest request, const Ice::Current&) {
  const GazeRequest asked = fromIce(request);
  require(checkGazeRequest(asked));
  return toIce(gaze_.request(asked));
}

avm::CommandReply GazeServant::withdraw(std::string client, std::string key, const Ice::Current&) {
  require(checkGazeClient(client, key));
  return toIce(gaze_.withdraw(client, key));
}

avm::GazeStatus GazeServant::status(const Ice::Current&) {
  const auto status = gaze_.status();
  if (!status) throw avm::NotAvailable("the gaze has not begun: no image yet");
  return toIce(*status);
}

void GazeServant::nextAsync(Ice::Long after_us, std::function<void(const avm::GazeResult&)> response,
                            std::function<void(std::exception_ptr)> exception, const Ice::Current&) {
  std::optional<std::int64_t> have;
  if (after_us != std::numeric_limits<std::int64_t>::min()) have = after_us;
  statuses_.stream().whenOther(
      have, kLongPollWait,
      [response = std::move(response), exception = std::move(exception)](const auto& reading) {
        try {
          response({toIce(reading.state), reading.message,
                    reading.value ? toIce(*reading.value) : avm::GazeStatus{}});
        } catch (...) {
          exception(std::current_exception());
        }
      });
}

PortReply RemoteGaze::setMode(GazeMode mode) {
  return runRemote(proxy_, "gaze", [mode](avm::GazePrx& gaze) { return gaze.setMode(toIce(mode)); });
}

PortReply RemoteGaze::fixate(const Eigen::Vector3d& p_odom) {
  return runRemote(proxy_, "gaze", [&p_odom](avm::GazePrx& gaze) { return gaze.fixate(toIce(p_odom)); });
}

PortReply RemoteGaze::request(const GazeRequest& request) {
  if (std::string problem = checkGazeRequest(request); !problem.empty()) return PortReply::rejected(problem);
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
