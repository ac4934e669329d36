#include "recorder/published_topics.h"

#include <array>
#include <cmath>

namespace vismem {
namespace {

constexpr int kSegments = 50;
constexpr int kPrimitives = 6;
constexpr int kRaces = 12;
constexpr int kPoints = 30;
constexpr Ice::Long kFrame = PublishedTopics::kFrame_us;

avm::Frame makeFrame() {
  avm::Frame frame{};
  frame.format = "RGB8";
  frame.width = 640;
  frame.height = 480;
  frame.cameraModel = {640, 480, 525.0, 525.0, 319.5, 239.5, 0.0, 0.0, 0.0, 0.0, 0.0};
  frame.pixels.assign(640 * 480 * 3, 128);
  return frame;
}

avm::MemoryUpdate makeUpdate() {
  avm::MemoryUpdate update{};
  for (int i = 0; i < kSegments; ++i) {
    const double x = std::sqrt(i);  // numbers with all their digits
    avm::MemorySegment segment{};
    segment.id = i;
    segment.a = {x, std::sin(x), 0.0};
    segment.b = {x + 1.0 / 3.0, std::cos(x), 0.0};
    segment.covarianceA = segment.covarianceB = {1e-4 / 3.0, 1e-6 / 7.0, 0.0, 2e-4 / 3.0, 0.0, 0.0};
    segment.label = "skirting";
    segment.life = 10.0 / 3.0;
    segment.uncertainty = 0.3;
    segment.confirmed = i % 3 != 0;
    update.snapshot.segments.push_back(segment);
    update.analysis.observed.push_back({{100.0 + x, 50.0}, {200.0 / 3.0, 70.0 + x}, "skirting", 40.0 / 3.0});
    update.analysis.predicted.push_back({i, {100.0 + x, 51.0}, {200.0 / 3.0, 71.0 + x}, "skirting"});
    update.analysis.matches.push_back({i, i});
  }
  for (int i = 0; i < kPrimitives; ++i) {
    avm::Primitive primitive{};
    primitive.id = i;
    primitive.kind = avm::PrimitiveKind::Parallelogram;
    primitive.vertices.assign(4, {i / 3.0, i / 7.0});
    primitive.segments = {i, i + 1, i + 2, i + 3};
    update.snapshot.primitives.push_back(primitive);
  }
  update.analysis.cameraModel = makeFrame().cameraModel;
  update.analysis.cameraOnRobot = {{0.1, 0.0, 0.45}, 0.5, -0.5, 0.5, -0.5};
  return update;
}

avm::PoseEstimate makeEstimate() {
  avm::PoseEstimate estimate{};
  estimate.hasPose = true;
  estimate.reliability = 0.9;
  estimate.covariance = {1e-4 / 3.0, 0.0, 0.0, 1e-4 / 3.0, 0.0, 1e-5 / 3.0};
  for (int i = 0; i < kRaces; ++i)
    estimate.races.push_back({i, {i / 3.0, i / 7.0, 0.1 * i}, 0.8 / 3.0, 1.0 / kRaces, i, 10 * i, i == 0});
  return estimate;
}

avm::GazeStatus makeGaze() {
  avm::GazeStatus gaze{};
  gaze.hasTarget = true;
  for (int i = 0; i < kPoints; ++i) {
    avm::AttentionPoint point{};
    point.id = i;
    point.target.isPlace = true;
    point.target.place = {i / 3.0, i / 7.0, 0.0};
    point.salience = i / 3.0;
    gaze.points.push_back(point);
  }
  gaze.target = gaze.points.front();
  return gaze;
}

avm::ComponentStatus makeStatus() {
  avm::ComponentStatus status{};
  status.version = "1.2.3";
  status.state = avm::ComponentState::Running;
  for (const std::string name : {"camera", "odometry", "pan-tilt", "localization"}) {
    status.peers.push_back({name, name + ":tcp -h 127.0.0.1 -p 9999", true, "", 0});
    status.rates.push_back({name, 29.97, 1000});
    status.latencies.push_back({name, 1000, 1.5, 3.5, 5.5, 9.5});
    status.gauges.push_back({name, 1.0 / 3.0, 0.1, "m"});
  }
  return status;
}

}  // namespace

PublishedTopics::PublishedTopics()
    : frame_(makeFrame()),
      update_(makeUpdate()),
      estimate_(makeEstimate()),
      gaze_(makeGaze()),
      status_(makeStatus()) {}

void PublishedTopics::publish(int image, const Emit& emit) {
  const Ice::Long stamp_us = image * kFrame;
  const avm::Pose2 robot{0.01 * image, std::sin(0.01 * image), 0.001 * image};
  for (const Ice::Long half : {0, 1}) {
    const Ice::Long own_us = stamp_us + half * kFrame / 2;
    const Ice::Long seq = 2 * image + half;
    convertOdometry({own_us, seq, robot, 0.3, 0.1}, emit);
    convertPanTilt({own_us, seq, 0.1, -0.2}, emit);
    truth_.convert({own_us, seq, robot, false, 0}, emit);
  }
  // As a call over Ice gives it: a frame of its own.
  avm::Frame frame = frame_;
  frame.stampUs = stamp_us;
  frame.seq = image;
  frame.pixels[0] = static_cast<std::uint8_t>(image);
  camera_.convert(frame, emit);
  update_.snapshot.stampUs = update_.analysis.stampUs = stamp_us;
  update_.snapshot.revision = update_.analysis.frameSeq = image;
  update_.snapshot.robotInOdom = update_.analysis.robotInOdom = robot;
  convertMemory(update_, emit);
  estimate_.stampUs = stamp_us;
  estimate_.revision = image;
  estimate_.robotInWorld = estimate_.robotInOdom = robot;
  convertEstimate(estimate_, emit);
  if (image % 3 == 0) {
    gaze_.stampUs = stamp_us;
    convertGaze(gaze_, emit);
  }
  if (image % kFramesPerSecond != 0) return;
  for (const std::string name : {"simulator", "active_visual_memory", "localization", "gui_server"}) {
    status_.name = name;
    convertComponent(status_, stamp_us, emit);
  }
}

}  // namespace vismem
