#include "active_visual_memory/core/attentive_visual_memory.h"

#include <cmath>
#include <utility>

namespace vismem {

namespace {

SegmentMemory::Params memoryParams(const AttentiveVisualMemoryParams& params) {
  SegmentMemory::Params memory = params.memory;
  memory.max_range_m = params.projector.max_range_m;
  memory.corners.least_height_m = memory.parallax.least_height_m;
  return memory;
}

ShapeEdges::Params shapeParams(const AttentiveVisualMemoryParams& params) {
  ShapeEdges::Params shapes = params.shape_edges;
  shapes.course = params.memory.course;
  return shapes;
}

}  // namespace

AttentiveVisualMemory::AttentiveVisualMemory(const Params& params)
    : params_(params),
      gate_(params.gate),
      projector_(params.projector),
      memory_(memoryParams(params)),
      primitives_(params.primitives),
      shape_edges_(shapeParams(params)),
      kidnap_(params.kidnap),
      pool_(params.attention),
      gaze_(params.gaze) {}

void AttentiveVisualMemory::reset() {
  memory_.clear();
  primitives_.clear();
  shape_edges_.clear();
  kidnap_.reset();
  pool_.clearPlaces();
  gaze_.abandonTarget();
  last_camera_.reset();
  ++epoch_;
}

void AttentiveVisualMemory::followEpoch(const RobotObservation& observation) {
  if (source_epoch_ && *source_epoch_ != observation.epoch) reset();
  source_epoch_ = observation.epoch;
}

void AttentiveVisualMemory::readMail() {
  using Kind = GazeMailbox::Message::Kind;
  for (const auto& message : mailbox_.take()) {
    switch (message.kind) {
      case Kind::kMode:
        gaze_.setMode(message.mode);
        break;
      case Kind::kFixate:
        gaze_.fixate(message.p_odom);
        break;
      case Kind::kRequest:
        pool_.request(message.request);
        break;
      case Kind::kWithdraw:
        pool_.withdraw(message.request.client, message.request.key);
        break;
    }
  }
}

std::optional<PanTiltCommand> AttentiveVisualMemory::redirect() {
  readMail();
  return gaze_.redirect(pool_);
}

double AttentiveVisualMemory::turnRate(const RobotObservation& observation) {
  const Pose3 T_odom_camera = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  double rate = 0.0;
  const double dt = toSeconds(observation.frame.stamp_us - last_stamp_us_);
  if (last_camera_ && dt > 0.0) {
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(last_camera_->linear().transpose() * T_odom_camera.linear()));
    rate = std::abs(turn.angle()) / dt;
  }
  last_camera_ = T_odom_camera;
  last_stamp_us_ = observation.frame.stamp_us;
  return rate;
}

AttentiveVisualMemory::StepResult AttentiveVisualMemory::step(const RobotObservation& observation,
                                                              const std::vector<ImageSegment>& observed,
                                                              StageProbe* probe) {
  enterStage(probe, "memory");
  followEpoch(observation);
  readMail();
  const double rate = turnRate(observation);
  RobotObservation believed = observation;
  believed.T_robot_camera = leaned(observation.T_robot_camera, memory_.lean());
  const Pose3 T_odom_camera = toPose3(believed.T_odom_robot) * believed.T_robot_camera;
  const auto floor =
      projector_.project(believed.frame.intrinsics, T_odom_camera,
                         correctThinLines(observed, params_.thin_lines), rate, believed.T_odom_robot.theta);
  memory_.doubtSince(kidnap_.doubtSince());
  ImageAnalysis analysis = memory_.update(believed, observed, floor, rate);
  // Consumers are told what the kinematics say; localization estimates the lean from its map, not from ours.
  analysis.T_robot_camera = observation.T_robot_camera;
  last_update_.analysis = std::make_shared<const ImageAnalysis>(std::move(analysis));
  // What was remembered belongs to another place: only what this image shows is true here.
  const bool kidnapped = kidnap_.update(observation.frame.stamp_us, memory_.agreement());
  if (kidnapped) {
    reset();
    memory_.update(believed, observed, floor, rate);
  }
  gate_.passed(observation);
  ++revision_;
  StepResult result = finish(observation, probe);
  result.kidnapped = kidnapped;
  return result;
}

AttentiveVisualMemory::StepResult AttentiveVisualMemory::glance(const RobotObservation& observation,
                                                                StageProbe* probe) {
  enterStage(probe, "memory");
  followEpoch(observation);
  readMail();
  turnRate(observation);
  memory_.age(observation.frame.stamp_us);
  return finish(observation, probe);
}

AttentiveVisualMemory::StepResult AttentiveVisualMemory::finish(const RobotObservation& observation,
                                                                StageProbe* probe) {
  const bool analysed = !last_update_.snapshot || last_update_.snapshot->revision != revision_;
  std::vector<MemorySegment> segments;
  segments.reserve(memory_.elements().size());
  for (const MemoryElement& element : memory_.elements()) {
    if (!memory_.onTrial(element)) segments.push_back(element.value);
  }

  enterStage(probe, "primitives");
  if (primitives_.update(observation.frame.stamp_us, segments)) {
    memory_.complete(primitives_.completions(segments));
  }
  std::vector<Primitive> primitives = primitives_.published();
  std::vector<VertexHypothesis> hypotheses = primitives_.hypotheses();

  StepResult result;
  enterStage(probe, "gaze");
  pool_.update(observation.frame.stamp_us, {segments, primitives, hypotheses}, observation.T_odom_robot,
               params_.gaze.mount, gaze_.attended());
  result.command = gaze_.step(observation, segments, pool_);
  result.gaze = gaze_.status(observation.frame.stamp_us, pool_);
  mailbox_.publish(result.gaze);
  enterStage(probe, "memory");
  if (analysed) {
    for (MemorySegment& segment : segments) {
      segment.salience = pool_.salienceOf(AttentionKind::kSegment, segment.id);
    }
    for (Primitive& primitive : primitives) {
      primitive.salience = pool_.salienceOf(AttentionKind::kPrimitive, primitive.id);
    }
    shape_edges_.complete(segments, memory_.elements(), primitives, [this] { return memory_.newId(); });
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = observation.frame.stamp_us;
    snapshot->revision = revision_;
    snapshot->epoch = epoch_;
    snapshot->T_odom_robot = observation.T_odom_robot;
    snapshot->segments = std::move(segments);
    snapshot->primitives = std::move(primitives);
    snapshot->hypotheses = std::move(hypotheses);
    last_update_.snapshot = std::move(snapshot);
  }
  result.update = last_update_;
  return result;
}

}  // namespace vismem
