/// @file The thread that computes health maps on request, beside the loop. See L10.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/segment_map/segment_map.h"
#include "localization/core/likelihood/health_map.h"
#include "localization/ice/localization_ice.h"

namespace vismem {

/// Answers one request after another, each with the newest observation at its start. The map is indexed at
/// the first request. *Thread-safe.*
class HealthMapWorker : public HealthMapSource {
 public:
  /// @param newest called from the worker's thread; returns an update without snapshot before the first.
  HealthMapWorker(const HealthMapParams& params, SegmentMap map_edges, std::function<MemoryUpdate()> newest);
  ~HealthMapWorker() override;

  std::string check(const HealthMapRequest& request) const override;
  PortReply draw(const HealthMapRequest& request, Done done) override;
  /// The map of all later answers.
  void setMap(SegmentMap map_edges);
  /// Answers all waiting and all later requests without a map.
  void stop();

 private:
  struct Job {
    HealthMapRequest request;
    Done done;
  };
  static constexpr std::size_t kMaximumJobs = 4;

  void run(const std::stop_token& stop);
  void answer(const std::stop_token& stop, const Job& job);

  const HealthMapParams params_;
  const std::function<MemoryUpdate()> newest_;
  std::optional<HealthMapper> mapper_;  ///< the thread's
  mutable std::mutex mutex_;
  SegmentMap map_edges_;
  bool map_changed_ = true;  ///< since the mapper was made
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;  ///< the first is in progress
  bool stopped_ = false;
  std::jthread thread_;  ///< last member: it uses all of the above
};

}  // namespace vismem
