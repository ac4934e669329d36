// scripts/bench localization: CPU time of one iteration of localization (5 a second), mean and 99th
// percentile, on a synthetic memory and image of a ring corridor; in maps of up to 50 000 segments; and the
// time to index a map. Goals: default mode 1 ms mean and 5 ms p99 with kidnappings, chapter mode 1 ms, large
// maps within 1.3 times small ones, 2 s per 10 000 m2 of map.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/angles.h"
#include "localization/core/localizer.h"
#include "localization/corridor_world.h"
#include "localization/map_views.h"

namespace {

using namespace vismem;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Drive {
  std::vector<MemoryUpdate> updates;
  std::vector<Pose2> truth;
};

/// Two minutes along the ring, an update per iteration; kidnapped every 10 s if wanted.
Drive drive(bool kidnapped) {
  test::CorridorParams params;
  params.rate_hz = 5.0;
  test::CorridorWorld world(params, 1);
  const SegmentMap map = test::corridorMap();
  Drive result;
  for (int i = 0; i < 600; ++i) {
    if (kidnapped && i % 50 == 49) world.kidnap();
    const MemoryUpdate update = world.next();
    ImageAnalysis view = test::emptyView(1.2 * std::sin(0.15 * i), degToRad(-15));
    view.stamp_us = update.snapshot->stamp_us;
    view.T_odom_robot = update.snapshot->T_odom_robot;
    test::addMapSegments(view, map, world.truth(), 2.5);
    result.updates.push_back({update.snapshot, std::make_shared<ImageAnalysis>(view)});
    result.truth.push_back(world.truth());
  }
  return result;
}

/// The ring corridor, and beside it segments of other places up to a number, one on each 3 m2: so much to
/// compare with is nowhere in the small map, and from a thousand on everywhere.
SegmentMap mapWith(int segments) {
  SegmentMap map = test::corridorMap();
  RandomEngine engine(1);
  const double side_m = std::sqrt(3.0 * segments);
  while (static_cast<int>(map.segments.size()) < segments) {
    const double x = uniform(engine, 20.0, 20.0 + side_m);
    const double y = uniform(engine, -2.0, -2.0 + side_m);
    const double length = uniform(engine, 0.5, 3.0);
    const bool along = uniform(engine, 0.0, 1.0) < 0.5;
    const Label label = uniform(engine, 0.0, 1.0) < 0.7 ? "skirting" : "door_foot";
    map.segments.push_back(
        {{{x, y, 0}, {x + (along ? length : 0.0), y + (along ? 0.0 : length), 0}}, label, 0.0});
  }
  return map;
}

void report(benchmark::State& state, std::vector<double>& seconds) {
  if (seconds.empty()) return;
  std::sort(seconds.begin(), seconds.end());
  double sum = 0.0;
  for (const double one : seconds) sum += one;
  const auto count = static_cast<double>(seconds.size());
  state.counters["mean_ms"] = 1e3 * sum / count;
  state.counters["p99_ms"] = 1e3 * seconds[static_cast<std::size_t>(0.99 * count)];
  state.counters["most_ms"] = 1e3 * seconds.back();
}

void run(benchmark::State& state, const LocalizerParams& params, const SegmentMap& map, bool kidnapped) {
  const Drive drive = ::drive(kidnapped);
  std::vector<double> seconds;
  double races = 0.0;
  double lost = 0.0;
  for (auto _ : state) {
    Localizer localizer(params, map, 1);
    for (std::size_t i = 0; i < drive.updates.size(); ++i) {
      const double begin = cpuSeconds();
      const PoseEstimate estimate = localizer.update(drive.updates[i]);
      seconds.push_back(cpuSeconds() - begin);
      if (i == 0 && !kidnapped) localizer.setPose(drive.truth[0]);
      races += static_cast<double>(estimate.races.size());
      lost += estimate.reliability < params.explorers.reliable_above ? 1.0 : 0.0;
    }
  }
  state.counters["races"] = races / static_cast<double>(seconds.size());
  state.counters["lost_share"] = lost / static_cast<double>(seconds.size());
  report(state, seconds);
}

LocalizerParams chapter(ObservationSource source) {
  LocalizerParams params = localizerPreset(LocalizationMode::kChapter);
  params.health.source = source;
  return params;
}

void indexMap(benchmark::State& state) {
  const SegmentMap map = mapWith(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        Localizer(localizerPreset(LocalizationMode::kDefault), map, 1).latest().revision);
  }
  const Eigen::Vector2d extent = map.high() - map.low();
  state.counters["segments"] = static_cast<double>(map.segments.size());
  state.counters["area_m2"] = extent.x() * extent.y();
}

}  // namespace

int main(int argc, char** argv) {
  const LocalizerParams ours = localizerPreset(LocalizationMode::kDefault);
  const auto add = [](const char* name, const LocalizerParams& params, int segments, bool kidnapped) {
    benchmark::RegisterBenchmark(
        name, [=](benchmark::State& state) { run(state, params, mapWith(segments), kidnapped); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(2);
  };
  add("default/settled", ours, 1, false);
  add("default/kidnapped_every_10_s", ours, 1, true);
  add("default/settled/50_segments", ours, 50, false);
  add("default/settled/50000_segments", ours, 50'000, false);
  add("default/kidnapped/50_segments", ours, 50, true);
  add("default/settled/1000_segments", ours, 1'000, false);
  add("default/kidnapped/1000_segments", ours, 1'000, true);
  add("default/kidnapped/50000_segments", ours, 50'000, true);
  const LocalizerParams by_memory = chapter(ObservationSource::kMemory);
  add("chapter_memory/settled", by_memory, 1, false);
  add("chapter_memory/kidnapped", by_memory, 1, true);
  add("chapter_memory/settled/50_segments", by_memory, 50, false);
  add("chapter_memory/kidnapped/50_segments", by_memory, 50, true);
  add("chapter_memory/kidnapped/1000_segments", by_memory, 1'000, true);
  const LocalizerParams by_image = chapter(ObservationSource::kImage);
  add("chapter_image/settled", by_image, 1, false);
  add("chapter_image/kidnapped", by_image, 1, true);
  add("chapter_image/settled/50_segments", by_image, 50, false);
  add("chapter_image/settled/1000_segments", by_image, 1'000, false);
  add("chapter_image/kidnapped/50_segments", by_image, 50, true);
  add("chapter_image/kidnapped/1000_segments", by_image, 1'000, true);
  benchmark::RegisterBenchmark("index_map", indexMap)->Unit(benchmark::kMillisecond)->Arg(50)->Arg(50'000);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
