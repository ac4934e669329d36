#include "common/memory_ice/visual_memory_ice.h"

#include <optional>
#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

avm::MemorySegment toIce(const MemorySegment& s) {
  avm::MemorySegment result;
  result.id = static_cast<Ice::Long>(s.id);
  result.a = vismem::toIce(s.odom.a);
  result.b = vismem::toIce(s.odom.b);
  result.covarianceA = vismem::toIce(s.P_a);
  result.covarianceB = vismem::toIce(s.P_b);
  result.label = s.label;
  result.life = s.life;
  result.uncertainty = s.uncertainty;
  result.salience = s.salience;
  result.confirmed = s.confirmed;
  result.offFloor = s.off_floor;
  result.firstSeenUs = s.first_seen_us;
  result.lastSeenUs = s.last_seen_us;
  return result;
}

MemorySegment fromIce(const avm::MemorySegment& s) {
  MemorySegment result;
  result.id = static_cast<std::uint64_t>(s.id);
  result.odom = {vismem::fromIce(s.a), vismem::fromIce(s.b)};
  result.P_a = vismem::fromIce(s.covarianceA);
  result.P_b = vismem::fromIce(s.covarianceB);
  result.label = s.label;
  result.life = s.life;
  result.uncertainty = s.uncertainty;
  result.salience = s.salience;
  result.confirmed = s.confirmed;
  result.off_floor = s.offFloor;
  result.first_seen_us = s.firstSeenUs;
  result.last_seen_us = s.lastSeenUs;
  return result;
}

avm::Primitive toIce(const Primitive& p) {
  avm::Primitive result;
  result.id = static_cast<Ice::Long>(p.id);
  result.kind = vismem::toIce(p.kind);
  for (const Eigen::Vector2d& v : p.vertices) result.vertices.push_back(vismem::toIce(v));
  result.centre = vismem::toIce(p.centre);
  result.heading = p.heading_rad;
  result.lengthM = p.length_m;
  result.widthM = p.width_m;
  result.radiusM = p.radius_m;
  result.hiddenVertex = p.hidden_vertex;
  result.quality = p.quality;
  result.life = p.life;
  result.salience = p.salience;
  result.segments.assign(p.segments.begin(), p.segments.end());
  result.firstSeenUs = p.first_seen_us;
  result.lastSeenUs = p.last_seen_us;
  return result;
}

Primitive fromIce(const avm::Primitive& p) {
  Primitive result;
  result.id = static_cast<std::uint64_t>(p.id);
  result.kind = vismem::fromIce(p.kind);
  for (const avm::Vector2& v : p.vertices) result.vertices.push_back(vismem::fromIce(v));
  result.centre = vismem::fromIce(p.centre);
  result.heading_rad = p.heading;
  result.length_m = p.lengthM;
  result.width_m = p.widthM;
  result.radius_m = p.radiusM;
  result.hidden_vertex = p.hiddenVertex;
  result.quality = p.quality;
  result.life = p.life;
  result.salience = p.salience;
  result.segments.assign(p.segments.begin(), p.segments.end());
  result.first_seen_us = p.firstSeenUs;
  result.last_seen_us = p.lastSeenUs;
  return result;
}

/// Why a primitive of a peer is unusable; empty if it is usable.
std::string checkPrimitive(const avm::Primitive& p) {
  const std::string name = "primitive " + std::to_string(p.id);
  constexpr std::size_t kMostCorners = decltype(Primitive::vertices)::capacity();
  if (p.vertices.size() > kMostCorners) {
    return name + " has " + std::to_string(p.vertices.size()) + " corners, at most " +
           std::to_string(kMostCorners) + " were expected";
  }
  for (const avm::Vector2& v : p.vertices) {
    if (!allFinite({v.x, v.y})) return name + " has a corner that is not finite";
  }
  if (!allFinite({p.centre.x, p.centre.y, p.heading, p.lengthM, p.widthM, p.radiusM, p.quality, p.life,
                  p.salience})) {
    return name + " is not finite";
  }
  if (p.hiddenVertex < -1 || p.hiddenVertex >= static_cast<int>(p.vertices.size())) {
    return name + ".hiddenVertex " + std::to_string(p.hiddenVertex) + " names no corner";
  }
  return {};
}

bool finite(const avm::MemorySegment& s) {
  const auto matrix = [](const avm::Symmetric3& m) {
    return allFinite({m.m00, m.m01, m.m02, m.m11, m.m12, m.m22});
  };
  return allFinite({s.a.x, s.a.y, s.a.z, s.b.x, s.b.y, s.b.z, s.life, s.uncertainty, s.salience}) &&
         matrix(s.covarianceA) && matrix(s.covarianceB);
}

bool finite(const avm::Pose2& p) {
  return allFinite({p.x, p.y, p.theta});
}
bool finite(const avm::Vector2& a, const avm::Vector2& b) {
  return allFinite({a.x, a.y, b.x, b.y});
}

}  // namespace

avm::PrimitiveKind toIce(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kStripe:
      return avm::PrimitiveKind::Stripe;
    case PrimitiveKind::kParallelogram:
      return avm::PrimitiveKind::Parallelogram;
    case PrimitiveKind::kTriangle:
      return avm::PrimitiveKind::Triangle;
    case PrimitiveKind::kArrow:
      return avm::PrimitiveKind::Arrow;
    case PrimitiveKind::kCircle:
      return avm::PrimitiveKind::Circle;
  }
  return avm::PrimitiveKind::Parallelogram;
}

PrimitiveKind fromIce(avm::PrimitiveKind kind) {
  switch (kind) {
    case avm::PrimitiveKind::Stripe:
      return PrimitiveKind::kStripe;
    case avm::PrimitiveKind::Parallelogram:
      return PrimitiveKind::kParallelogram;
    case avm::PrimitiveKind::Triangle:
      return PrimitiveKind::kTriangle;
    case avm::PrimitiveKind::Arrow:
      return PrimitiveKind::kArrow;
    case avm::PrimitiveKind::Circle:
      return PrimitiveKind::kCircle;
  }
  return PrimitiveKind::kParallelogram;
}

avm::MemorySnapshot toIce(const MemorySnapshot& s) {
  avm::MemorySnapshot result;
  result.stampUs = s.stamp_us;
  result.revision = static_cast<Ice::Long>(s.revision);
  result.epoch = static_cast<int>(s.epoch);
  result.robotInOdom = toIce(s.T_odom_robot);
  result.segments.reserve(s.segments.size());
  for (const MemorySegment& segment : s.segments) result.segments.push_back(toIce(segment));
  for (const Primitive& primitive : s.primitives) result.primitives.push_back(toIce(primitive));
  for (const VertexHypothesis& corner : s.hypotheses) {
    result.hypotheses.push_back({static_cast<Ice::Long>(corner.primitive_id), toIce(corner.p_odom)});
  }
  return result;
}

MemorySnapshot fromIce(const avm::MemorySnapshot& s) {
  MemorySnapshot result;
  result.stamp_us = s.stampUs;
  result.revision = static_cast<std::uint64_t>(s.revision);
  result.epoch = static_cast<std::uint32_t>(s.epoch);
  result.T_odom_robot = fromIce(s.robotInOdom);
  result.segments.reserve(s.segments.size());
  for (const avm::MemorySegment& segment : s.segments) result.segments.push_back(fromIce(segment));
  for (const avm::Primitive& primitive : s.primitives) result.primitives.push_back(fromIce(primitive));
  for (const avm::VertexHypothesis& corner : s.hypotheses) {
    result.hypotheses.push_back({static_cast<std::uint64_t>(corner.primitive), fromIce(corner.place)});
  }
  return result;
}

avm::ImageAnalysis toIce(const ImageAnalysis& a) {
  avm::ImageAnalysis result;
  result.stampUs = a.stamp_us;
  result.frameSeq = static_cast<Ice::Long>(a.frame_seq);
  result.cameraModel = toIce(a.intrinsics);
  result.robotInOdom = toIce(a.T_odom_robot);
  result.cameraOnRobot = toIce(a.T_robot_camera);
  result.observed.reserve(a.observed.size());
  for (const ImageSegment& s : a.observed) {
    result.observed.push_back({toIce(s.px.a), toIce(s.px.b), s.label, s.strength});
  }
  result.predicted.reserve(a.predicted.size());
  for (const PredictedSegment& s : a.predicted) {
    result.predicted.push_back(
        {static_cast<Ice::Long>(s.id), toIce(s.px.a), toIce(s.px.b), s.label, s.off_floor});
  }
  result.matches.reserve(a.matches.size());
  for (const auto& match : a.matches) result.matches.push_back({match.observed, match.predicted});
  return result;
}

ImageAnalysis fromIce(const avm::ImageAnalysis& a) {
  ImageAnalysis result;
  result.stamp_us = a.stampUs;
  result.frame_seq = static_cast<std::uint64_t>(a.frameSeq);
  result.intrinsics = fromIce(a.cameraModel);
  result.T_odom_robot = fromIce(a.robotInOdom);
  result.T_robot_camera = fromIce(a.cameraOnRobot).value_or(Pose3::Identity());
  result.observed.reserve(a.observed.size());
  for (const avm::ImageSegment& s : a.observed) {
    result.observed.push_back({{fromIce(s.a), fromIce(s.b)}, s.label, s.strength});
  }
  result.predicted.reserve(a.predicted.size());
  for (const avm::PredictedSegment& s : a.predicted) {
    result.predicted.push_back(
        {static_cast<std::uint64_t>(s.id), {fromIce(s.a), fromIce(s.b)}, s.label, s.offFloor});
  }
  result.matches.reserve(a.matches.size());
  for (const avm::SegmentMatch& match : a.matches)
    result.matches.push_back({match.observed, match.predicted});
  return result;
}

std::string checkUpdate(const avm::MemoryUpdate& update) {
  if (!finite(update.snapshot.robotInOdom)) return "snapshot.robotInOdom is not finite";
  for (const avm::MemorySegment& s : update.snapshot.segments) {
    if (!finite(s)) return "segment " + std::to_string(s.id) + " is not finite";
  }
  for (const avm::Primitive& p : update.snapshot.primitives) {
    if (std::string problem = checkPrimitive(p); !problem.empty()) return problem;
  }
  for (const avm::VertexHypothesis& corner : update.snapshot.hypotheses) {
    if (!allFinite({corner.place.x, corner.place.y})) return "a hypothesis is not finite";
  }
  const avm::ImageAnalysis& a = update.analysis;
  if (!finite(a.robotInOdom)) return "analysis.robotInOdom is not finite";
  if (!fromIce(a.cameraOnRobot)) return "analysis.cameraOnRobot is not a rigid pose";
  const avm::Intrinsics& c = a.cameraModel;
  if (!allFinite({c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3}))
    return "analysis.cameraModel is not finite";
  for (const avm::ImageSegment& s : a.observed) {
    if (!finite(s.a, s.b) || !allFinite({s.strength})) return "an observed segment is not finite";
  }
  for (const avm::PredictedSegment& s : a.predicted) {
    if (!finite(s.a, s.b)) return "a predicted segment is not finite";
  }
  for (const avm::SegmentMatch& match : a.matches) {
    // A negative index becomes a huge one.
    if (static_cast<std::size_t>(match.observed) >= a.observed.size() ||
        static_cast<std::size_t>(match.predicted) >= a.predicted.size()) {
      return "match " + std::to_string(match.observed) + ", " + std::to_string(match.predicted) +
             " names no segment";
    }
  }
  return {};
}

const avm::MemoryResult& PublishedMemory::result() const {
  std::call_once(made_, [this] {
    result_ = {avm::SourceState::Running, "", {toIce(*update_.snapshot), toIce(*update_.analysis)}};
  });
  return result_;
}

void MemoryBroadcaster::publish(MemoryUpdate update) {
  const auto revision = static_cast<std::int64_t>(update.snapshot->revision);
  latest_.publish(std::make_shared<const PublishedMemory>(std::move(update)), revision);
}

MemoryResult MemoryBroadcaster::next(std::uint64_t after_revision, std::chrono::milliseconds timeout) {
  std::optional<std::int64_t> have;
  if (after_revision > 0) have = static_cast<std::int64_t>(after_revision);
  const auto reading = latest_.waitOther(have, timeout);
  if (!reading.value) return {reading.state, {}, reading.message};
  return {SourceState::kRunning, reading.value->update(), {}};
}

void VisualMemoryServant::nextAsync(Ice::Long after_revision,
                                    std::function<void(const avm::MemoryResult&)> response,
                                    std::function<void(std::exception_ptr)> exception, const Ice::Current&) {
  std::optional<std::int64_t> have;
  if (after_revision > 0) have = after_revision;
  memory_.latest().whenOther(
      have, kLongPollWait,
      [response = std::move(response), exception = std::move(exception)](const auto& reading) {
        try {
          if (reading.value) {
            response(reading.value->result());
          } else {
            response({toIce(reading.state), reading.message, {}});
          }
        } catch (...) {
          exception(std::current_exception());
        }
      });
}

avm::MemoryUpdate VisualMemoryServant::latest(const Ice::Current&) {
  const auto newest = memory_.latest().latest();
  if (!newest) throw avm::NotAvailable(memory_.latest().message());
  return newest->result().update;
}

VisualMemoryClient::VisualMemoryClient(const std::shared_ptr<avm::VisualMemoryPrx>& proxy, LinkReport report)
    : proxy_(boundedProxy(proxy, kInvocationTimeout_ms)), updates_(proxy_, std::move(report)) {}

MemoryResult VisualMemoryClient::next(std::uint64_t after_revision, std::chrono::milliseconds timeout) {
  const auto outcome = updates_.wait(
      [this, after_revision](auto done, auto failed) {
        proxy_->nextAsync(static_cast<Ice::Long>(after_revision), std::move(done), std::move(failed));
      },
      timeout);
  if (!outcome.result) {
    return {SourceState::kWaiting, {}, outcome.failure.empty() ? nothing_yet_ : outcome.failure};
  }
  const avm::MemoryResult& result = *outcome.result;
  nothing_yet_ = result.message.empty() ? "no update yet" : result.message;
  if (result.state != avm::SourceState::Running) return {fromIce(result.state), {}, result.message};
  const std::string problem = checkUpdate(result.update);
  if (!problem.empty()) return {SourceState::kWaiting, {}, "unusable update: " + problem};
  MemoryUpdate update{std::make_shared<const MemorySnapshot>(fromIce(result.update.snapshot)),
                      std::make_shared<const ImageAnalysis>(fromIce(result.update.analysis))};
  return {SourceState::kRunning, std::move(update), {}};
}

}  // namespace vismem
