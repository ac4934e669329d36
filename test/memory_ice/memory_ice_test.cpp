// Tests C3, C4: the visual memory and the gaze over a real connection.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <limits>
#include <map>
#include <thread>

#include "common/memory_ice/gaze_ice.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

MemoryUpdate updateWith(std::uint64_t revision) {
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = 1000;
  snapshot->revision = revision;
  snapshot->epoch = 3;
  snapshot->T_odom_robot = {1, 2, 0.5};
  MemorySegment segment;
  segment.id = 9;
  segment.odom = {{1, 2, 3}, {4, 5, 6}};
  segment.P_a << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  segment.P_b = 2 * segment.P_a;
  segment.label = "skirting";
  segment.life = 40;
  segment.uncertainty = 0.025;
  segment.salience = 7;
  segment.confirmed = true;
  segment.off_floor = true;
  segment.first_seen_us = 100;
  segment.last_seen_us = 900;
  snapshot->segments = {segment};
  Primitive shape;
  shape.id = 3;
  shape.kind = PrimitiveKind::kParallelogram;
  shape.vertices = {{0.0, 0.0}, {0.6, 0.0}, {0.7, 0.4}, {0.1, 0.4}};
  shape.centre = {0.35, 0.2};
  shape.heading_rad = 0.1;
  shape.length_m = 0.6;
  shape.width_m = 0.41;
  shape.radius_m = 0.0;
  shape.hidden_vertex = 2;
  shape.quality = 0.8;
  shape.segments = {4, 7};
  shape.life = 33.0;
  shape.salience = 2.5;
  shape.first_seen_us = 100;
  shape.last_seen_us = 200;
  snapshot->primitives = {shape};
  snapshot->hypotheses = {{3, {0.7, 0.4}}};

  auto analysis = std::make_shared<ImageAnalysis>();
  analysis->stamp_us = 1000;
  analysis->frame_seq = 77;
  analysis->intrinsics = {320, 240, 300, 301, 160, 120, 0.1, 0.2, 0.3, 0.4, 0.5};
  analysis->T_odom_robot = {1, 2, 0.5};
  analysis->T_robot_camera = poseFromXyzRpy(0.1, 0, 0.45, -1.57, 0, -1.57);
  analysis->observed = {{{{1, 2}, {3, 4}}, "stripe_edge", 55}, {{{5, 6}, {7, 8}}, "unknown", 44}};
  analysis->predicted = {{9, {{1.5, 2.5}, {3.5, 4.5}}, "skirting", true}};
  analysis->matches = {{1, 0}};
  return {snapshot, analysis};
}

TEST(MemoryConversions, EveryFieldComesBack) {
  const MemoryUpdate update = updateWith(5);
  const MemorySnapshot s = fromIce(toIce(*update.snapshot));
  EXPECT_EQ(s.stamp_us, 1000);
  EXPECT_EQ(s.revision, 5U);
  EXPECT_EQ(s.epoch, 3U);
  EXPECT_EQ(s.T_odom_robot, (Pose2{1, 2, 0.5}));
  ASSERT_EQ(s.primitives.size(), 1U);
  const Primitive& shape = s.primitives[0];
  const Primitive& sent = update.snapshot->primitives[0];
  EXPECT_EQ(shape.id, sent.id);
  EXPECT_EQ(shape.kind, sent.kind);
  EXPECT_EQ(shape.vertices, sent.vertices);
  EXPECT_EQ(shape.centre, sent.centre);
  EXPECT_EQ(shape.heading_rad, sent.heading_rad);
  EXPECT_EQ(shape.length_m, sent.length_m);
  EXPECT_EQ(shape.width_m, sent.width_m);
  EXPECT_EQ(shape.radius_m, sent.radius_m);
  EXPECT_EQ(shape.hidden_vertex, sent.hidden_vertex);
  EXPECT_EQ(shape.quality, sent.quality);
  EXPECT_EQ(shape.segments, sent.segments);
  EXPECT_EQ(shape.life, sent.life);
  EXPECT_EQ(shape.salience, sent.salience);
  EXPECT_EQ(shape.first_seen_us, sent.first_seen_us);
  EXPECT_EQ(shape.last_seen_us, sent.last_seen_us);
  ASSERT_EQ(s.hypotheses.size(), 1U);
  EXPECT_EQ(s.hypotheses[0].primitive_id, 3U);
  EXPECT_EQ(s.hypotheses[0].p_odom, update.snapshot->hypotheses[0].p_odom);
  ASSERT_EQ(s.segments.size(), 1U);
  const MemorySegment& segment = s.segments[0];
  const MemorySegment& original = update.snapshot->segments[0];
  EXPECT_EQ(segment.id, 9U);
  EXPECT_EQ(segment.odom.a, original.odom.a);
  EXPECT_EQ(segment.odom.b, original.odom.b);
  EXPECT_EQ(segment.P_a, original.P_a);
  EXPECT_EQ(segment.P_b, original.P_b);
  EXPECT_EQ(segment.label, "skirting");
  EXPECT_EQ(segment.life, 40);
  EXPECT_EQ(segment.uncertainty, 0.025);
  EXPECT_EQ(segment.salience, 7);
  EXPECT_TRUE(segment.confirmed);
  EXPECT_TRUE(segment.off_floor);
  EXPECT_EQ(segment.first_seen_us, 100);
  EXPECT_EQ(segment.last_seen_us, 900);

  const ImageAnalysis a = fromIce(toIce(*update.analysis));
  EXPECT_EQ(a.stamp_us, 1000);
  EXPECT_EQ(a.frame_seq, 77U);
  EXPECT_EQ(a.intrinsics, update.analysis->intrinsics);
  EXPECT_EQ(a.T_odom_robot, (Pose2{1, 2, 0.5}));
  EXPECT_TRUE(a.T_robot_camera.isApprox(update.analysis->T_robot_camera, 1e-12));
  ASSERT_EQ(a.observed.size(), 2U);
  EXPECT_EQ(a.observed[0].px.a, Eigen::Vector2d(1, 2));
  EXPECT_EQ(a.observed[0].px.b, Eigen::Vector2d(3, 4));
  EXPECT_EQ(a.observed[0].label, "stripe_edge");
  EXPECT_EQ(a.observed[0].strength, 55);
  ASSERT_EQ(a.predicted.size(), 1U);
  EXPECT_EQ(a.predicted[0].id, 9U);
  EXPECT_EQ(a.predicted[0].px.b, Eigen::Vector2d(3.5, 4.5));
  EXPECT_EQ(a.predicted[0].label, "skirting");
  EXPECT_TRUE(a.predicted[0].off_floor);
  ASSERT_EQ(a.matches.size(), 1U);
  EXPECT_EQ(a.matches[0].observed, 1);
  EXPECT_EQ(a.matches[0].predicted, 0);
}

TEST(MemoryConversions, SaysWhatIsWrongWithAnUpdate) {
  const MemoryUpdate update = updateWith(5);
  const avm::MemoryUpdate good{toIce(*update.snapshot), toIce(*update.analysis)};
  EXPECT_EQ(checkUpdate(good), "");
  avm::MemoryUpdate bad = good;
  bad.snapshot.segments[0].b.y = kNaN;
  EXPECT_EQ(checkUpdate(bad), "segment 9 is not finite");
  bad = good;
  bad.snapshot.primitives[0].vertices[1].x = kNaN;
  EXPECT_EQ(checkUpdate(bad), "primitive 3 has a corner that is not finite");
  bad = good;
  bad.snapshot.primitives[0].vertices.push_back({});
  EXPECT_EQ(checkUpdate(bad), "primitive 3 has 5 corners, at most 4 were expected");
  bad = good;
  bad.snapshot.primitives[0].hiddenVertex = 4;
  EXPECT_EQ(checkUpdate(bad), "primitive 3.hiddenVertex 4 names no corner");
  bad = good;
  bad.analysis.matches[0].observed = -1;
  EXPECT_EQ(checkUpdate(bad), "match -1, 0 names no segment");
  bad = good;
  bad.analysis.matches[0].predicted = 1;
  EXPECT_EQ(checkUpdate(bad), "match 1, 1 names no segment");
  bad = good;
  bad.analysis.cameraOnRobot.qw = 9;
  EXPECT_THAT(checkUpdate(bad), HasSubstr("cameraOnRobot"));
}

class MemoryLoopback : public ::testing::Test {
 protected:
  MemoryLoopback() { serve(0); }
  ~MemoryLoopback() override { memory->stop(); }
  void serve(int at_port) {
    memory = std::make_unique<MemoryBroadcaster>();
    server = std::make_unique<LoopbackServer>(at_port);
    server->add("VisualMemory",
                std::make_shared<VisualMemoryServant>(*memory, [] { return PortReply::accepted(); }));
    server->activate();
    port = server->port();
  }
  std::shared_ptr<avm::VisualMemoryPrx> proxy() {
    return client.proxy<avm::VisualMemoryPrx>("VisualMemory", port);
  }

  std::unique_ptr<MemoryBroadcaster> memory;
  std::unique_ptr<LoopbackServer> server;
  int port = 0;
  LoopbackClient client;
};

TEST_F(MemoryLoopback, GivesTheNewestUpdateOnce) {
  VisualMemoryClient remote(proxy());
  EXPECT_EQ(remote.next(0, 10ms).state, SourceState::kWaiting);
  EXPECT_THROW(proxy()->latest(), avm::NotAvailable);
  memory->publish(updateWith(1));
  MemoryResult result = remote.next(0, 2s);
  ASSERT_EQ(result.state, SourceState::kRunning) << result.message;
  EXPECT_EQ(result.update.snapshot->revision, 1U);
  EXPECT_EQ(result.update.analysis->frame_seq, 77U);
  EXPECT_EQ(remote.next(1, 10ms).state, SourceState::kWaiting);
  memory->publish(updateWith(2));
  memory->publish(updateWith(3));
  EXPECT_GE(remote.next(1, 2s).update.snapshot->revision, 2U);
  EXPECT_EQ(proxy()->latest().snapshot.revision, 3);
  EXPECT_EQ(memory->next(2, 0ms).update.snapshot->revision, 3U);
  EXPECT_EQ(memory->next(3, 0ms).state, SourceState::kWaiting);
}

TEST_F(MemoryLoopback, ARestartedServerIsNoticed) {
  VisualMemoryClient remote(proxy());
  memory->publish(updateWith(500));
  ASSERT_EQ(remote.next(0, 2s).update.snapshot->revision, 500U);
  server->deactivate();
  memory->stop();
  server.reset();
  EXPECT_EQ(remote.next(500, 300ms).state, SourceState::kWaiting);
  serve(port);
  memory->publish(updateWith(2));
  MemoryResult result;
  ASSERT_TRUE(eventually([&] {
    result = remote.next(500, 500ms);
    return result.state == SourceState::kRunning;
  }));
  EXPECT_EQ(result.update.snapshot->revision, 2U);
}

TEST_F(MemoryLoopback, StopAnswersWaitingRequests) {
  std::promise<avm::SourceState> state;
  proxy()->nextAsync(0, [&](avm::MemoryResult result) { state.set_value(result.state); });
  ASSERT_TRUE(eventually([&] { return memory->latest().waiting() == 1; }));
  memory->stop();
  EXPECT_EQ(state.get_future().get(), avm::SourceState::Waiting);
}

class RecordingGaze : public GazeClient {
 public:
  PortReply setMode(GazeMode value) override {
    mode = value;
    return PortReply::accepted();
  }
  PortReply fixate(const Eigen::Vector3d& p_odom) override {
    if (p_odom.z() > 5) return PortReply::rejected("out of reach");
    place = p_odom;
    return PortReply::accepted();
  }
  PortReply request(const GazeRequest& value) override {
    asked = value;
    return PortReply::adjusted("lower priority");
  }
  PortReply withdraw(const std::string& client, const std::string& key) override {
    withdrawn = client + "/" + key;
    return PortReply::accepted();
  }
  std::optional<GazeStatus> status() override { return now; }

  GazeMode mode = GazeMode::kAttend;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  GazeRequest asked;
  std::string withdrawn;
  std::optional<GazeStatus> now;
};

class GazeLoopback : public ::testing::Test {
 protected:
  GazeLoopback() {
    server.add("Gaze", std::make_shared<GazeServant>(gaze, statuses));
    server.activate();
  }
  ~GazeLoopback() override { statuses.stop(); }

  RecordingGaze gaze;
  GazeBroadcaster statuses;
  LoopbackServer server;
  LoopbackClient client;
  RemoteGaze remote{client.proxy<avm::GazePrx>("Gaze", server.port())};
};

TEST_F(GazeLoopback, CommandsArriveAsGiven) {
  for (const auto mode : {GazeMode::kAttend, GazeMode::kFixate, GazeMode::kHold, GazeMode::kOff}) {
    EXPECT_TRUE(remote.setMode(mode).ok());
    EXPECT_EQ(gaze.mode, mode);
  }
  EXPECT_TRUE(remote.fixate({1, 2, 3}).ok());
  EXPECT_EQ(gaze.place, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(remote.fixate({1, 2, 9}).message, "out of reach");
  GazeRequest request{"localization", "corner", Eigen::Vector3d(4, 5, 6), std::nullopt, 2.5, 99};
  EXPECT_EQ(remote.request(request).message, "lower priority");
  EXPECT_EQ(gaze.asked.client, "localization");
  EXPECT_EQ(gaze.asked.key, "corner");
  EXPECT_EQ(gaze.asked.p_odom, request.p_odom);
  EXPECT_FALSE(gaze.asked.direction);
  EXPECT_EQ(gaze.asked.priority, 2.5);
  EXPECT_EQ(gaze.asked.deadline_us, 99);
  request.p_odom.reset();
  request.direction = PanTilt{0.5, -0.25};
  EXPECT_TRUE(remote.request(request).ok());
  EXPECT_FALSE(gaze.asked.p_odom);
  EXPECT_EQ(gaze.asked.direction, request.direction);
  EXPECT_TRUE(remote.withdraw("localization", "corner").ok());
  EXPECT_EQ(gaze.withdrawn, "localization/corner");
}

TEST_F(GazeLoopback, TheNextStatusIsTheNewestThatDiffers) {
  const auto proxy = client.proxy<avm::GazePrx>("Gaze", server.port());
  const auto before = proxy->next(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(before.state, avm::SourceState::Waiting);
  EXPECT_THAT(before.message, HasSubstr("no image yet"));
  GazeStatus status;
  status.stamp_us = 1000;
  status.visits = 3;
  statuses.publish(status);
  auto result = proxy->next(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(result.state, avm::SourceState::Running);
  EXPECT_EQ(result.status.visits, 3);
  EXPECT_EQ(proxy->next(1000).state, avm::SourceState::Waiting) << "nothing new within a second";
  EXPECT_EQ(proxy->next(9000).status.stampUs, 1000) << "the source began anew";
  std::jthread later([&] {
    status.stamp_us = 2000;
    statuses.publish(status);
  });
  EXPECT_EQ(proxy->next(1000).status.stampUs, 2000);
}

TEST_F(GazeLoopback, InvalidRequestsAreRefusedWithTheReason) {
  EXPECT_THAT(remote.fixate({kNaN, 0, 0}).message, HasSubstr("place.x = nan (must be finite)"));
  GazeRequest request{"gui", "", Eigen::Vector3d(1, 1, 0), std::nullopt, kNaN, 0};
  EXPECT_THAT(remote.request(request).message, HasSubstr("priority"));
  request.priority = 101;
  EXPECT_THAT(remote.request(request).message, HasSubstr("at most 100"));
  request.priority = 1;
  request.client.clear();
  EXPECT_EQ(remote.request(request).message, "client is empty");
  request.client = "gui";
  request.key = std::string(1000, 'x');
  EXPECT_THAT(remote.request(request).message, HasSubstr("key has 1000 characters"));
  request.key.clear();
  request.p_odom.reset();
  EXPECT_THAT(remote.request(request).message, HasSubstr("neither a place nor a direction"));
}

TEST_F(GazeLoopback, StatusComesBackWithEveryField) {
  EXPECT_FALSE(remote.status());
  for (const auto kind : {AttentionKind::kSegment, AttentionKind::kPrimitive, AttentionKind::kScanning,
                          AttentionKind::kHypothesis, AttentionKind::kClient}) {
    for (const auto state :
         {GazeState::kSelect, GazeState::kSaccade, GazeState::kAnalyse, GazeState::kTrack}) {
      GazeStatus status;
      status.stamp_us = 5;
      status.mode = GazeMode::kFixate;
      status.state = state;
      status.target = AttentionPoint{3, kind, Eigen::Vector3d(1, 2, 3), std::nullopt, 8.5};
      status.points = {*status.target, {4, AttentionKind::kScanning, std::nullopt, PanTilt{0.1, 0.2}, 1.5}};
      status.visits = 6;
      status.given_up = 7;
      gaze.now = status;
      const auto back = remote.status();
      ASSERT_TRUE(back);
      EXPECT_EQ(back->stamp_us, 5);
      EXPECT_EQ(back->mode, GazeMode::kFixate);
      EXPECT_EQ(back->state, state);
      ASSERT_TRUE(back->target);
      EXPECT_EQ(back->target->id, 3U);
      EXPECT_EQ(back->target->kind, kind);
      EXPECT_EQ(back->target->p_odom, status.target->p_odom);
      EXPECT_EQ(back->target->salience, 8.5);
      ASSERT_EQ(back->points.size(), 2U);
      EXPECT_EQ(back->points[1].direction, status.points[1].direction);
      EXPECT_FALSE(back->points[1].p_odom);
      EXPECT_EQ(back->visits, 6U);
      EXPECT_EQ(back->given_up, 7U);
    }
  }
  gaze.now->target.reset();
  EXPECT_FALSE(remote.status()->target);
}

TEST(MemoryConversions, KindsOfPrimitivesAgreeByNameAndComeBack) {
  const std::map<PrimitiveKind, avm::PrimitiveKind> kinds = {
      {PrimitiveKind::kStripe, avm::PrimitiveKind::Stripe},
      {PrimitiveKind::kParallelogram, avm::PrimitiveKind::Parallelogram},
      {PrimitiveKind::kTriangle, avm::PrimitiveKind::Triangle},
      {PrimitiveKind::kArrow, avm::PrimitiveKind::Arrow},
      {PrimitiveKind::kCircle, avm::PrimitiveKind::Circle}};
  for (const auto& [ours, wire] : kinds) {
    EXPECT_EQ(toIce(ours), wire);
    EXPECT_EQ(fromIce(wire), ours);
  }
}

/// The numbers on the wire are those of the names: a reordered enumeration must fail here.
TEST(GazeConversions, EnumerationsAgreeByName) {
  const std::map<GazeMode, avm::GazeMode> modes = {{GazeMode::kAttend, avm::GazeMode::Attend},
                                                   {GazeMode::kFixate, avm::GazeMode::Fixate},
                                                   {GazeMode::kHold, avm::GazeMode::Hold},
                                                   {GazeMode::kOff, avm::GazeMode::Off}};
  for (const auto& [ours, wire] : modes) {
    EXPECT_EQ(toIce(ours), wire);
    EXPECT_EQ(fromIce(wire), ours);
  }
  const std::map<AttentionKind, avm::AttentionKind> kinds = {
      {AttentionKind::kSegment, avm::AttentionKind::Segment},
      {AttentionKind::kPrimitive, avm::AttentionKind::Primitive},
      {AttentionKind::kScanning, avm::AttentionKind::Scanning},
      {AttentionKind::kHypothesis, avm::AttentionKind::Hypothesis},
      {AttentionKind::kClient, avm::AttentionKind::Client}};
  for (const auto& [ours, wire] : kinds) {
    AttentionPoint point;
    point.kind = ours;
    EXPECT_EQ(toIce(point).kind, wire);
    EXPECT_EQ(fromIce(wire), ours);
  }
  const std::map<GazeState, avm::GazeState> states = {{GazeState::kSelect, avm::GazeState::Select},
                                                      {GazeState::kSaccade, avm::GazeState::Saccade},
                                                      {GazeState::kAnalyse, avm::GazeState::Analyse},
                                                      {GazeState::kTrack, avm::GazeState::Track}};
  for (const auto& [ours, wire] : states) {
    GazeStatus status;
    status.state = ours;
    EXPECT_EQ(toIce(status).state, wire);
    EXPECT_EQ(fromIce(wire), ours);
  }
}

}  // namespace
}  // namespace vismem
