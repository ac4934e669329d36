#include "active_visual_memory/core/attentive_visual_memory.h"

#include <cmath>

namespace vismem {

namespace {

constexpr std::size_t kUsualShapes = 64;

SegmentMemory::Params memoryParams(const AttentiveVisualMemoryParams& params) {
  SegmentMemory::Params memory = params.memory;
  memory.gates.max_range_m = params.projector.max_range_m;
  return memory;
}

ShapeEdges::Params shapeParams(const AttentiveVisualMemoryParams& params) {
  ShapeEdges::Params shapes = params.shape_edges;
  shapes.dominant_direction = params.memory.estimation.dominant_direction;
  return shapes;
}

}  // namespace

void AttentiveVisualMemoryParams::visit(ParameterVisitor& v) {
  v.group("FrameGate", gate);
  v.group("Ground", projector);
  v.group("Memory", memory);
  v.group("Primitives", primitives);
  v.group("ShapeEdges", shape_edges);
  v.group("Attention", attention);
  v.group("Gaze", gaze);
}

AttentiveVisualMemoryParams AttentiveVisualMemoryParams::standard() {
  return {};
}

AttentiveVisualMemoryParams AttentiveVisualMemoryParams::chapter() {
  AttentiveVisualMemoryParams p;
  p.memory = SegmentMemory::Params::chapter();
  p.kidnap.enabled = false;
  p.shape_edges.enabled = false;
  p.attention = AttentionPool::Params::chapter();
  p.gaze = GazeController::Params::chapter(p.rig);
  return p;
}

AttentiveVisualMemory::AttentiveVisualMemory(const Params& params)
    : params_(params),
      gate_(params.gate),
      projector_(params.projector),
      memory_(memoryParams(params)),
      primitives_(params.primitives),
      shape_edges_(shapeParams(params)),
      kidnap_(params.kidnap),
      pool_(params.attention, params.rig),
      gaze_(params.gaze, params.rig) {}

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

double AttentiveVisualMemory::begin(const RobotObservation& observation, StageProbe* probe) {
  enterStage(probe, "memory");
  scratch_.release();
  if (source_epoch_ && *source_epoch_ != observation.epoch) reset();
  source_epoch_ = observation.epoch;
  readGazeRequests();
  return turnRate(observation);
}

void AttentiveVisualMemory::readGazeRequests() {
  for (const auto& apply : gaze_requests_.take()) apply(gaze_, pool_);
}

std::optional<PanTiltCommand> AttentiveVisualMemory::preempt() {
  readGazeRequests();
  return gaze_.preempt(pool_);
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

const AttentiveVisualMemory::StepResult& AttentiveVisualMemory::update(
    const RobotObservation& observation, const std::vector<ImageSegment>& observed, StageProbe* probe) {
  const double rate = begin(observation, probe);
  RobotObservation believed = observation;
  believed.T_robot_camera = tilted(observation.T_robot_camera, memory_.cameraTilt());
  const Pose3 T_odom_camera = toPose3(believed.T_odom_robot) * believed.T_robot_camera;
  const auto floor = projector_.project(believed.frame.intrinsics, T_odom_camera, observed, rate,
                                        believed.T_odom_robot.theta, scratch_.resource());
  memory_.suspectSince(kidnap_.suspectSince());
  const auto analysis = analyses_.next();
  const ImageAnalysis& seen = memory_.update(believed, observed, floor, rate);
  analysis->observed.reserve(seen.observed.capacity());
  analysis->predicted.reserve(seen.predicted.capacity());
  analysis->matches.reserve(seen.matches.capacity());
  *analysis = seen;
  // Published is the pose of the kinematics: localization estimates the tilt from its own map.
  analysis->T_robot_camera = observation.T_robot_camera;
  result_.update.analysis = analysis;
  // The old memory belongs to another place: this image begins the new one.
  result_.kidnapped = kidnap_.update(observation.frame.stamp_us, memory_.agreement());
  if (result_.kidnapped) {
    reset();
    memory_.update(believed, observed, floor, rate);
  }
  gate_.passed(observation);
  ++revision_;
  finish(observation, probe);
  return result_;
}

const AttentiveVisualMemory::StepResult& AttentiveVisualMemory::predict(const RobotObservation& observation,
                                                                        StageProbe* probe) {
  begin(observation, probe);
  memory_.advanceLife(observation.frame.stamp_us);
  result_.kidnapped = false;
  finish(observation, probe);
  return result_;
}

void AttentiveVisualMemory::finish(const RobotObservation& observation, StageProbe* probe) {
  segments_.clear();
  for (const MemoryElement& element : memory_.elements()) {
    if (!memory_.isTentative(element)) segments_.push_back(element.value);
  }

  enterStage(probe, "primitives");
  if (primitives_.update(observation.frame.stamp_us, segments_)) {
    memory_.complete(primitives_.completions(scratch_.resource()));
  }
  // They come back from a snapshot: one shape more is not to allocate in each of these.
  shapes_.reserve(kUsualShapes);
  hypotheses_.reserve(kUsualShapes);
  shapes_ = primitives_.published();
  hypotheses_ = primitives_.hypotheses();

  enterStage(probe, "gaze");
  pool_.update(observation.frame.stamp_us, {segments_, shapes_, hypotheses_}, observation.T_odom_robot,
               gaze_.attended());
  result_.command = gaze_.update(observation, segments_, pool_);
  gaze_.report(observation.frame.stamp_us, pool_, result_.gaze);
  gaze_requests_.publish(result_.gaze, observation.T_odom_robot.position());
  enterStage(probe, "memory");
  const auto& last = result_.update.snapshot;
  if (!last || last->revision != revision_) publish(observation);
}

void AttentiveVisualMemory::publish(const RobotObservation& observation) {
  pool_.publishSalience(segments_, shapes_);
  shape_edges_.complete(segments_, memory_.elements(), shapes_, [this] { return memory_.newId(); });
  const auto snapshot = snapshots_.next();
  snapshot->stamp_us = observation.frame.stamp_us;
  snapshot->revision = revision_;
  snapshot->epoch = epoch_;
  snapshot->T_odom_robot = observation.T_odom_robot;
  snapshot->segments.swap(segments_);
  snapshot->primitives.swap(shapes_);
  snapshot->hypotheses.swap(hypotheses_);
  result_.update.snapshot = snapshot;
}

}  // namespace vismem
