// What a page reads of a running robot, and what it may change meanwhile: map, gaze, memory, log, parameters.
#include <avm/component.h>
#include <avm/gaze.h>
#include <avm/localization.h>
#include <avm/visual_memory.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "common/segment_map/segment_map.h"
#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/ice_client.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ReadingOperations : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = std::make_unique<Robot>(); }
  static void TearDownTestSuite() { robot_.reset(); }

  struct Robot {
    static ChildProcess::Options inSources() {
      ChildProcess::Options options;
      options.working_directory = VISMEM_SOURCE_DIR;
      return options;
    }
    ComponentProcess simulator{
        "simulator", {"cfg/sim/simulator.cfg", "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"}, inSources()};
    ComponentProcess memory{
        "active_visual_memory",
        {"cfg/sim/active_visual_memory.cfg", "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0",
         "--ActiveVisualMemory.Camera.Proxy=" + simulator.proxy("cameraA"),
         "--ActiveVisualMemory.PanTilt.Proxy=" + simulator.proxy("PanTilt"),
         "--ActiveVisualMemory.Odometry.Proxy=" + simulator.proxy("Encoders")},
        inSources()};
    ComponentProcess localization{
        "localization",
        {"cfg/sim/localization.cfg", "--Localization.Endpoints=tcp -h 127.0.0.1 -p 0",
         "--Localization.Gaze.Proxy=" + memory.proxy("Gaze"),
         "--Localization.VisualMemory.Proxy=" + memory.proxy("VisualMemory")},
        inSources()};
  };

  static inline std::unique_ptr<Robot> robot_;
  IceClient ice_;
  std::shared_ptr<avm::VisualMemoryPrx> memory_ =
      ice_.find<avm::VisualMemoryPrx>(robot_->memory, "VisualMemory");
  std::shared_ptr<avm::GazePrx> gaze_ = ice_.find<avm::GazePrx>(robot_->memory, "Gaze");
  std::shared_ptr<avm::ComponentPrx> memory_status_ =
      ice_.find<avm::ComponentPrx>(robot_->memory, "active_visual_memory/component");
};

TEST_F(ReadingOperations, TheMapIsTheOneOfTheConfiguration) {
  const auto localization = ice_.find<avm::LocalizationPrx>(robot_->localization, "Localization");
  const auto contents = localization->getMap();
  const SegmentMap map = loadSegmentMap(VISMEM_SOURCE_DIR "/cfg/maps/" + contents.name);
  ASSERT_EQ(contents.segments.size(), map.segments.size());
  ASSERT_GT(contents.segments.size(), 10u);
  for (std::size_t i = 0; i < map.segments.size(); ++i) {
    EXPECT_EQ(contents.segments[i].label, map.segments[i].label);
    EXPECT_EQ(contents.segments[i].a.x, map.segments[i].world.a.x());
    EXPECT_EQ(contents.segments[i].b.y, map.segments[i].world.b.y());
    EXPECT_EQ(contents.segments[i].widthM, map.segments[i].width_m);
  }
  EXPECT_EQ(contents.id.size(), 16u);
  EXPECT_EQ(localization->getMap().id, contents.id);
}

TEST_F(ReadingOperations, TheGazeIsFollowedWithoutPolling) {
  auto last = std::numeric_limits<std::int64_t>::min();
  int updates = 0;
  ASSERT_TRUE(eventually([&] {
    const auto result = gaze_->next(last);
    if (result.state != avm::SourceState::Running) return false;
    EXPECT_NE(result.status.stampUs, last) << "only what differs from what the caller has";
    last = result.status.stampUs;
    return ++updates >= 5;
  }));
  EXPECT_EQ(gaze_->status().mode, avm::GazeMode::Attend);
  // A caller from before a restart is answered at once.
  EXPECT_EQ(gaze_->next(std::numeric_limits<std::int64_t>::max()).state, avm::SourceState::Running);
}

TEST_F(ReadingOperations, AResetBeginsANewEpoch) {
  ASSERT_TRUE(eventually([&] { return memory_->next(0).state == avm::SourceState::Running; }));
  const int epoch = memory_->latest().snapshot.epoch;
  memory_->reset();
  EXPECT_TRUE(eventually([&] { return memory_->latest().snapshot.epoch > epoch; }));
}

TEST_F(ReadingOperations, EveryComponentReportsItsProcessorTime) {
  const std::pair<const ComponentProcess*, std::string> components[] = {
      {&robot_->simulator, "simulator"},
      {&robot_->memory, "active_visual_memory"},
      {&robot_->localization, "localization"}};
  for (const auto& [process, name] : components) {
    const auto component = ice_.find<avm::ComponentPrx>(*process, name + "/component");
    EXPECT_TRUE(eventually([&] {
      for (const auto& gauge : component->getStatus().gauges) {
        if (gauge.name == "cpu") return gauge.unit == "%" && gauge.value > 0.0 && gauge.value < 6400.0;
      }
      return false;
    })) << name;
  }
}

TEST_F(ReadingOperations, TheLogIsReadFromANumberOn) {
  const auto all = memory_status_->getLog(0, avm::LogLevel::Debug, 1000);
  ASSERT_FALSE(all.entries.empty());
  EXPECT_EQ(all.entries.front().seq, 1);
  EXPECT_THAT(all.entries.front().text, HasSubstr("configuration:"));
  EXPECT_EQ(all.lost, 0);
  const auto part = memory_status_->getLog(0, avm::LogLevel::Debug, 1);
  ASSERT_EQ(part.entries.size(), 1u);
  EXPECT_EQ(part.lastSequence, 1);
  for (const auto& entry : memory_status_->getLog(0, avm::LogLevel::Warning, 1000).entries)
    EXPECT_GE(entry.level, avm::LogLevel::Warning);
  EXPECT_THROW(memory_status_->getLog(0, avm::LogLevel::Debug, 0), avm::InvalidArgument);
  EXPECT_THROW(memory_status_->getLog(0, avm::LogLevel::Debug, 1001), avm::InvalidArgument);
}

TEST_F(ReadingOperations, ParametersChangeWhatTheOwnerDoes) {
  std::map<std::string, avm::Parameter> parameters;
  for (const auto& parameter : memory_status_->parameters()) parameters[parameter.name] = parameter;
  ASSERT_TRUE(parameters.contains("Log.Level"));
  ASSERT_TRUE(parameters.contains("Overlay.Rate_hz"));
  ASSERT_TRUE(parameters.contains("Attention.SegmentRate"));
  ASSERT_TRUE(parameters.contains("Vision.MinimumLength_px"));
  for (const auto& [name, parameter] : parameters) {
    EXPECT_FALSE(parameter.description.empty()) << name;
    EXPECT_GE(parameter.value, parameter.minimum) << name;
    EXPECT_LE(parameter.value, parameter.maximum) << name;
    EXPECT_EQ(parameter.value, parameter.configured) << name;
    EXPECT_THROW(memory_status_->setParameter(name, std::numeric_limits<double>::quiet_NaN()),
                 avm::InvalidArgument);
    EXPECT_THROW(memory_status_->setParameter(name, parameter.maximum + 1.0), avm::InvalidArgument);
    EXPECT_NO_THROW(memory_status_->setParameter(name, parameter.value)) << name;
  }
  EXPECT_THROW(memory_status_->setParameter("Vision.Nothing", 1.0), avm::InvalidArgument);

  // No segment of an image of 320 x 240 px is as long as this; pieces cut at gaps are what remains.
  const auto shortest = parameters.at("Vision.MinimumLength_px");
  std::size_t before = 0;
  ASSERT_TRUE(eventually([&] {
    before = memory_->latest().analysis.observed.size();
    return before >= 8;
  }));
  memory_status_->setParameter(shortest.name, shortest.maximum);
  EXPECT_TRUE(eventually([&] { return memory_->latest().analysis.observed.size() < before / 2; }));
  memory_status_->setParameter(shortest.name, shortest.configured);
  EXPECT_TRUE(eventually([&] { return memory_->latest().analysis.observed.size() >= 8; }));
}

TEST_F(ReadingOperations, LocalizationAsksForGazeByItsParameters) {
  const auto component = ice_.find<avm::ComponentPrx>(robot_->localization, "localization/component");
  const auto value = [&](const std::string& name) {
    for (const auto& parameter : component->parameters()) {
      if (parameter.name == name) return parameter.value;
    }
    return std::numeric_limits<double>::quiet_NaN();
  };
  ASSERT_GE(value("Gaze.UncertaintyAbove"), 0.0);
  component->setParameter("Gaze.UncertaintyAbove", 1.0);
  EXPECT_EQ(value("Gaze.UncertaintyAbove"), 1.0);
  component->setParameter("Gaze.Confirm_s", 0.0);
  const auto asks = [&] {
    for (const auto& point : gaze_->status().points) {
      if (point.kind == avm::AttentionKind::Client) return true;
    }
    return false;
  };
  // Only a pose that is wholly unknown is worth a request now.
  const auto localization = ice_.find<avm::LocalizationPrx>(robot_->localization, "Localization");
  EXPECT_TRUE(eventually([&] {
    try {
      return localization->latest().reliability > 0.0 && !asks();
    } catch (const avm::NotAvailable&) {
      return false;
    }
  }));
  component->setParameter("Gaze.UncertaintyAbove", 0.0);
  EXPECT_TRUE(eventually(asks)) << "the pose is never sure enough";
}

}  // namespace
}  // namespace vismem
