#include "recorder/ice/estimate_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "common/recording/ros_messages.h"
#include "recorder/core/recorder_core.h"

namespace vismem {
namespace {

using nlohmann::json;
using Rgba = std::array<float, 4>;
using Topic = std::shared_ptr<const LogTopic>;

constexpr double kRaceArrow_m = 0.4;
constexpr float kFullLife = 100.0F;
constexpr int kCircleCorners = 32;

/// Labels may be any bytes, and numbers may not be finite: JSON then has replacement characters and null.
RecordedMessage jsonMessage(const Topic& topic, StampUs stamp_us, const json& value) {
  return textMessage(topic, stamp_us, value.dump(-1, ' ', false, json::error_handler_t::replace));
}

Topic jsonTopic(const std::string& name) {
  return makeTopic(name, kStringType);
}

json toJson(const avm::Vector2& v) {
  return {v.x, v.y};
}
json toJson(const avm::Vector3& v) {
  return {v.x, v.y, v.z};
}
json toJson(const avm::Pose2& p) {
  return {{"x_m", p.x}, {"y_m", p.y}, {"theta_rad", p.theta}};
}
json toJson(const avm::Pose3& p) {
  return {{"position_m", toJson(p.position)}, {"qwxyz", {p.qw, p.qx, p.qy, p.qz}}};
}
json toJson(const avm::Symmetric3& m) {
  return {m.m00, m.m01, m.m02, m.m11, m.m12, m.m22};
}

json toJson(const avm::MemorySegment& s) {
  return {{"id", s.id},
          {"a_m", toJson(s.a)},
          {"b_m", toJson(s.b)},
          {"covariance_a_m2", toJson(s.covarianceA)},
          {"covariance_b_m2", toJson(s.covarianceB)},
          {"label", s.label},
          {"life", s.life},
          {"salience", s.salience},
          {"confirmed", s.confirmed},
          {"off_floor", s.offFloor},
          {"first_seen_us", s.firstSeenUs},
          {"last_seen_us", s.lastSeenUs}};
}

const char* nameOf(avm::PrimitiveKind kind) {
  switch (kind) {
    case avm::PrimitiveKind::Stripe:
      return "stripe";
    case avm::PrimitiveKind::Parallelogram:
      return "parallelogram";
    case avm::PrimitiveKind::Triangle:
      return "triangle";
    case avm::PrimitiveKind::Arrow:
      return "arrow";
    case avm::PrimitiveKind::Circle:
      break;
  }
  return "circle";
}

json toJson(const avm::Primitive& p) {
  json vertices = json::array();
  for (const auto& v : p.vertices) vertices.push_back(toJson(v));
  return {{"id", p.id},
          {"kind", nameOf(p.kind)},
          {"vertices_m", vertices},
          {"centre_m", toJson(p.centre)},
          {"heading_rad", p.heading},
          {"length_m", p.lengthM},
          {"width_m", p.widthM},
          {"radius_m", p.radiusM},
          {"hidden_vertex", p.hiddenVertex},
          {"quality", p.quality},
          {"life", p.life},
          {"segments", p.segments}};
}

json toJson(const avm::MemorySnapshot& m) {
  json value{{"stamp_us", m.stampUs},      {"revision", m.revision},
             {"epoch", m.epoch},           {"robot_in_odom", toJson(m.robotInOdom)},
             {"segments", json::array()},  {"primitives", json::array()},
             {"hypotheses", json::array()}};
  for (const auto& s : m.segments) value["segments"].push_back(toJson(s));
  for (const auto& p : m.primitives) value["primitives"].push_back(toJson(p));
  for (const auto& h : m.hypotheses) {
    value["hypotheses"].push_back({{"primitive", h.primitive}, {"place_m", toJson(h.place)}});
  }
  return value;
}

json toJson(const avm::ImageAnalysis& a) {
  json value{{"stamp_us", a.stampUs},
             {"frame_seq", a.frameSeq},
             {"robot_in_odom", toJson(a.robotInOdom)},
             {"camera_on_robot", toJson(a.cameraOnRobot)},
             {"observed", json::array()},
             {"predicted", json::array()},
             {"matches", json::array()}};
  for (const auto& s : a.observed) {
    value["observed"].push_back(
        {{"a_px", toJson(s.a)}, {"b_px", toJson(s.b)}, {"label", s.label}, {"strength", s.strength}});
  }
  for (const auto& s : a.predicted) {
    value["predicted"].push_back(
        {{"id", s.id}, {"a_px", toJson(s.a)}, {"b_px", toJson(s.b)}, {"label", s.label}});
  }
  for (const auto& m : a.matches) value["matches"].push_back({m.observed, m.predicted});
  return value;
}

RosMarker markerIn(const char* frame, StampUs stamp_us, const char* ns, RosMarker::Type type) {
  RosMarker marker;
  marker.header = {stamp_us, frame};
  marker.ns = ns;
  marker.type = type;
  return marker;
}

/// A viewer takes down what an array does not hold any more only when told to.
RosMarker deleteAll(const char* frame, StampUs stamp_us, const char* ns) {
  RosMarker marker = markerIn(frame, stamp_us, ns, RosMarker::Type::kLineList);
  marker.action = RosMarker::Action::kDeleteAll;
  return marker;
}

void emitMarkers(const Topic& topic, StampUs stamp_us, std::vector<RosMarker> markers, const Emit& emit) {
  // Lines without points are an error to RViz.
  std::erase_if(markers, [](const RosMarker& m) {
    return m.action == RosMarker::Action::kAdd && m.type == RosMarker::Type::kLineList && m.points.empty();
  });
  emit(recordedMessage(topic, stamp_us, serialize(markers)));
}

void addLine(RosMarker& marker, const RosPoint& a, const RosPoint& b, const Rgba& color) {
  marker.points.insert(marker.points.end(), {a, b});
  marker.colors.insert(marker.colors.end(), {color, color});
}

/// The outline of a primitive on the floor.
std::vector<RosPoint> outlineOf(const avm::Primitive& p) {
  std::vector<RosPoint> outline;
  if (p.kind == avm::PrimitiveKind::Circle) {
    for (int i = 0; i < kCircleCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCircleCorners;
      outline.push_back(
          {p.centre.x + p.radiusM * std::cos(angle), p.centre.y + p.radiusM * std::sin(angle), 0.0});
    }
    return outline;
  }
  for (const auto& v : p.vertices) outline.push_back({v.x, v.y, 0.0});
  return outline;
}

void addPrimitive(RosMarker& marker, const avm::Primitive& p) {
  static constexpr Rgba kColor{0.2F, 0.5F, 1.0F, 1.0F};
  const auto outline = outlineOf(p);
  if (p.kind == avm::PrimitiveKind::Arrow && outline.size() == 4) {
    // Tip, tail, ends of the head.
    for (const std::size_t i : {1u, 2u, 3u}) addLine(marker, outline[0], outline[i], kColor);
    return;
  }
  const bool closed = p.kind != avm::PrimitiveKind::Stripe;
  for (std::size_t i = 1; i < outline.size(); ++i) addLine(marker, outline[i - 1], outline[i], kColor);
  if (closed && outline.size() > 2) addLine(marker, outline.back(), outline.front(), kColor);
}

/// map -> odom: where odom lies so that the robot is where it is in both.
avm::Pose2 odomInWorld(const avm::PoseEstimate& e) {
  const double theta = std::remainder(e.robotInWorld.theta - e.robotInOdom.theta, 2.0 * std::numbers::pi);
  const double c = std::cos(theta);
  const double s = std::sin(theta);
  return {e.robotInWorld.x - c * e.robotInOdom.x + s * e.robotInOdom.y,
          e.robotInWorld.y - s * e.robotInOdom.x - c * e.robotInOdom.y, theta};
}

RosPose poseOf(const avm::Pose2& pose) {
  return planarTransform(0, "", "", pose).pose;
}

RosCovariance planarCovariance(const avm::Symmetric3& m) {
  // Of (x, y, theta) in ROS's order (x, y, z, rotations about x, y, z).
  RosCovariance c{};
  c[0] = m.m00;
  c[1] = c[6] = m.m01;
  c[7] = m.m11;
  c[5] = c[30] = m.m02;
  c[11] = c[31] = m.m12;
  c[35] = m.m22;
  return c;
}

const char* nameOf(avm::ComponentState state) {
  switch (state) {
    case avm::ComponentState::Starting:
      return "starting";
    case avm::ComponentState::WaitingForPeers:
      return "waiting";
    case avm::ComponentState::Running:
      return "running";
    case avm::ComponentState::Degraded:
      return "degraded";
    case avm::ComponentState::Stopping:
      break;
  }
  return "stopping";
}

json toJson(const avm::AttentionPoint& p) {
  json value{{"id", p.id}, {"kind", static_cast<int>(p.kind)}, {"salience", p.salience}};
  if (p.target.isPlace) {
    value["place_m"] = toJson(p.target.place);
  } else {
    value["pan_rad"] = p.target.direction.panRad;
    value["tilt_rad"] = p.target.direction.tiltRad;
  }
  return value;
}

}  // namespace

void convertMemory(const avm::MemoryUpdate& update, const Emit& emit) {
  static const Topic segments = makeTopic("/memory/segments", kMarkersType);
  static const Topic primitives = makeTopic("/memory/primitives", kMarkersType);
  static const Topic snapshot = jsonTopic("/memory/snapshot");
  static const Topic analysis = jsonTopic("/memory/analysis");
  static const Topic tf = makeTopic("/tf", kTransformType);
  const StampUs stamp_us = update.snapshot.stampUs;
  RosMarker lines = markerIn(kOdomFrame, stamp_us, "segments", RosMarker::Type::kLineList);
  for (const auto& s : update.snapshot.segments) {
    const float alpha = std::clamp(static_cast<float>(s.life) / kFullLife, 0.2F, 1.0F);
    const Rgba color = s.confirmed ? Rgba{0.1F, 0.8F, 0.2F, alpha} : Rgba{1.0F, 0.6F, 0.1F, alpha};
    addLine(lines, {s.a.x, s.a.y, s.a.z}, {s.b.x, s.b.y, s.b.z}, color);
  }
  emitMarkers(segments, stamp_us, {deleteAll(kOdomFrame, stamp_us, "segments"), lines}, emit);
  RosMarker shapes = markerIn(kOdomFrame, stamp_us, "primitives", RosMarker::Type::kLineList);
  shapes.scale.x = 0.03;
  for (const auto& p : update.snapshot.primitives) addPrimitive(shapes, p);
  emitMarkers(primitives, stamp_us, {deleteAll(kOdomFrame, stamp_us, "primitives"), shapes}, emit);
  emit(jsonMessage(snapshot, stamp_us, toJson(update.snapshot)));
  emit(jsonMessage(analysis, update.analysis.stampUs, toJson(update.analysis)));
  const auto& camera = update.analysis.cameraOnRobot;
  const std::vector<RosTransform> transforms{{{update.analysis.stampUs, kRobotFrame},
                                              "memory_camera",
                                              {{camera.position.x, camera.position.y, camera.position.z},
                                               {camera.qx, camera.qy, camera.qz, camera.qw}}}};
  emit(recordedMessage(tf, update.analysis.stampUs, serialize(transforms)));
}

void convertEstimate(const avm::PoseEstimate& estimate, const Emit& emit) {
  static const Topic pose = makeTopic("/localization/pose", kPoseType);
  static const Topic races = makeTopic("/localization/races", kMarkersType);
  static const Topic all = jsonTopic("/localization/estimate");
  static const Topic tf = makeTopic("/tf", kTransformType);
  const StampUs stamp_us = estimate.stampUs;
  json value{{"stamp_us", stamp_us},
             {"revision", estimate.revision},
             {"has_pose", estimate.hasPose},
             {"robot_in_world", toJson(estimate.robotInWorld)},
             {"robot_in_odom", toJson(estimate.robotInOdom)},
             {"covariance", toJson(estimate.covariance)},
             {"reliability", estimate.reliability},
             {"races", json::array()}};
  std::vector<RosMarker> arrows{deleteAll(kWorldFrame, stamp_us, "races")};
  for (const auto& race : estimate.races) {
    value["races"].push_back({{"id", race.id},
                              {"robot_in_world", toJson(race.robotInWorld)},
                              {"health", race.health},
                              {"weight", race.weight},
                              {"victories", race.victories},
                              {"age", race.age},
                              {"winner", race.winner}});
    RosMarker arrow = markerIn(kWorldFrame, stamp_us, "races", RosMarker::Type::kArrow);
    arrow.id = static_cast<std::int32_t>(race.id & 0x7FFFFFFF);
    arrow.pose = poseOf(race.robotInWorld);
    arrow.scale = {kRaceArrow_m, 0.06, 0.06};
    const float alpha = std::clamp(static_cast<float>(race.weight), 0.2F, 1.0F);
    arrow.rgba = race.winner ? Rgba{0.9F, 0.1F, 0.1F, 1.0F} : Rgba{0.6F, 0.2F, 0.8F, alpha};
    arrows.push_back(std::move(arrow));
  }
  emit(jsonMessage(all, stamp_us, value));
  emitMarkers(races, stamp_us, std::move(arrows), emit);
  if (!estimate.hasPose) return;
  emit(recordedMessage(
      pose, stamp_us,
      serialize(RosPoseWithCovariance{
          {stamp_us, kWorldFrame}, poseOf(estimate.robotInWorld), planarCovariance(estimate.covariance)})));
  emit(recordedMessage(tf, stamp_us,
                       serialize(std::vector<RosTransform>{
                           planarTransform(stamp_us, kWorldFrame, kOdomFrame, odomInWorld(estimate))})));
}

void convertGaze(const avm::GazeStatus& status, const Emit& emit) {
  static const Topic target = makeTopic("/gaze/target", kMarkersType);
  static const Topic all = jsonTopic("/gaze/status");
  static constexpr std::array kModes{"attend", "fixate", "hold", "off"};
  static constexpr std::array kStates{"select", "saccade", "analyse", "track"};
  json value{{"stamp_us", status.stampUs},
             {"mode", kModes.at(static_cast<std::size_t>(status.mode))},
             {"state", kStates.at(static_cast<std::size_t>(status.state))},
             {"visits", status.visits},
             {"given_up", status.givenUp},
             {"points", json::array()}};
  if (status.hasTarget) value["target"] = toJson(status.target);
  for (const auto& point : status.points) value["points"].push_back(toJson(point));
  emit(jsonMessage(all, status.stampUs, value));
  std::vector<RosMarker> markers{deleteAll(kOdomFrame, status.stampUs, "gaze")};
  if (status.hasTarget && status.target.target.isPlace) {
    RosMarker ball = markerIn(kOdomFrame, status.stampUs, "gaze", RosMarker::Type::kSphere);
    const auto& place = status.target.target.place;
    ball.pose.position = {place.x, place.y, place.z};
    ball.scale = {0.08, 0.08, 0.08};
    ball.rgba = {1.0F, 0.9F, 0.1F, 1.0F};
    markers.push_back(std::move(ball));
  }
  emitMarkers(target, status.stampUs, std::move(markers), emit);
}

void TruthMessages::convert(const avm::TruthSample& sample, const Emit& emit) {
  static const Topic pose = makeTopic("/ground_truth/pose", kPoseType);
  static const Topic state = jsonTopic("/ground_truth/state");
  emit(recordedMessage(
      pose, sample.stampUs,
      serialize(RosPoseWithCovariance{{sample.stampUs, kWorldFrame}, poseOf(sample.robotInWorld), {}})));
  const std::pair now(sample.inCollision, sample.kidnaps);
  if (std::exchange(state_, now) == now) return;
  emit(jsonMessage(state, sample.stampUs,
                   {{"stamp_us", sample.stampUs}, {"in_collision", now.first}, {"kidnaps", now.second}}));
}

void convertComponent(const avm::ComponentStatus& status, StampUs stamp_us, const Emit& emit) {
  json value{{"stamp_us", stamp_us},          {"name", status.name},     {"version", status.version},
             {"state", nameOf(status.state)}, {"reason", status.reason}, {"uptime_s", status.uptimeS},
             {"peers", json::array()},        {"rates", json::array()},  {"latencies", json::array()},
             {"gauges", json::array()},       {"errors", json::array()}};
  for (const auto& p : status.peers) {
    value["peers"].push_back({{"name", p.name}, {"connected", p.connected}, {"message", p.message}});
  }
  for (const auto& r : status.rates)
    value["rates"].push_back({{"name", r.name}, {"hz", r.hz}, {"total", r.total}});
  for (const auto& l : status.latencies) {
    value["latencies"].push_back(
        {{"name", l.name}, {"p50_ms", l.p50Ms}, {"p95_ms", l.p95Ms}, {"max_ms", l.maxMs}});
  }
  for (const auto& g : status.gauges) {
    value["gauges"].push_back({{"name", g.name}, {"value", g.value}, {"sigma", g.sigma}, {"unit", g.unit}});
  }
  for (const auto& e : status.errors) value["errors"].push_back({{"stamp_us", e.stampUs}, {"text", e.text}});
  emit(jsonMessage(jsonTopic("/components/" + status.name), stamp_us, value));
}

}  // namespace vismem
