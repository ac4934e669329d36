#include "active_visual_memory/app/memory_parameters.h"

#include <algorithm>
#include <string>
#include <utility>

namespace vismem {
namespace {

/// Bounds of what is worth trying live. A configured value beyond a bound becomes the bound.
constexpr double kHighestRate = 100.0;
constexpr double kLongestSearch_s = 60.0;
constexpr double kLongestSegment_px = 100.0;

/// Adds a parameter whose value the loop's owner thread puts into the pipeline.
class Lister {
 public:
  Lister(ParameterTable& table, PerceptionLoop& loop) : table_(table), loop_(loop) {}

  void add(RuntimeParameter parameter, std::function<void(MemoryPipeline&, double)> apply) {
    parameter.minimum = std::min(parameter.minimum, parameter.configured);
    parameter.maximum = std::max(parameter.maximum, parameter.configured);
    table_.add(std::move(parameter), [&loop = loop_, apply = std::move(apply)](double value) {
      return loop.change([apply, value](MemoryPipeline& pipeline) { apply(pipeline, value); }).message;
    });
  }

  void addRate(AttentionPool::Params configured, AttentionKind kind, const std::string& name,
               const std::string& of_what) {
    add({"Attention." + name, "", 0.0, kHighestRate, false, configured.rateOf(kind),
         "Growth of salience per tick of 200 ms of " + of_what + ": how often the camera looks there"},
        [kind](MemoryPipeline& pipeline, double rate) { pipeline.memory().attention().setRate(kind, rate); });
  }

 private:
  ParameterTable& table_;
  PerceptionLoop& loop_;
};

}  // namespace

void listMemoryParameters(ParameterTable& table, const ActiveVisualMemoryConfig& config, PerceptionLoop& loop,
                          std::atomic<double>& overlay_rate_hz) {
  Lister lister(table, loop);
  if (config.overlay) {
    table.add({"Overlay.Rate_hz", "Hz", 0.1, 120.0, false, config.overlay_rate_hz,
               "Highest rate at which the image with the overlay is drawn"},
              [&overlay_rate_hz](double rate_hz) {
                overlay_rate_hz = rate_hz;
                return std::string();
              });
  }
  lister.add(
      {"Vision.MinimumLength_px", "px", 2.0, kLongestSegment_px, false,
       config.pipeline.vision.minimum_length_px, "Shorter segments of the image are dropped"},
      [](MemoryPipeline& pipeline, double length_px) { pipeline.extractor().setMinimumLength(length_px); });
  if (!config.hasPanTilt()) return;
  const AttentionPool::Params& attention = config.pipeline.memory.attention;
  lister.addRate(attention, AttentionKind::kSegment, "SegmentRate", "remembered segments");
  lister.addRate(attention, AttentionKind::kPrimitive, "PrimitiveRate", "primitives");
  lister.addRate(attention, AttentionKind::kHypothesis, "HypothesisRate", "inferred corners");
  lister.addRate(attention, AttentionKind::kClient, "ClientRate", "clients' requests, times their priority");
  lister.add({"Attention.ForcedSearch_s", "s", 0.1, kLongestSearch_s, false, attention.forced_search_s,
              "Time between forced searches, which grows with the number of objects"},
             [](MemoryPipeline& pipeline, double interval_s) {
               pipeline.memory().attention().setForcedSearch(interval_s);
             });
}

}  // namespace vismem
