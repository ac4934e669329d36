/// @file The thread that draws health maps on request, beside the loop. SPEC L10.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/segment_map/segment_map.h"
#include "localization/core/health_map.h"
#include "localization/core/params.h"
#include "localization/ice/localization_ice.h"

namespace vismem {

/// One request after another, each by the observation that is the newest when its turn comes. The map is
/// indexed for the first. *Thread-safe.*
class HealthMapWorker : public HealthMapSource {
 public:
  /// @param newest asked from the worker's thread; an update without snapshot or analysis: none yet.
  HealthMapWorker(const LocalizerParams& params, SegmentMap map_edges, std::function<MemoryUpdate()> newest);
  ~HealthMapWorker() override;

  std::string check(const HealthMapRequest& request) const override;
  PortReply draw(const HealthMapRequest& request, Done done) override;
  /// Answers all who wait, and from now on everybody at once: there is nothing to give.
  void stop();

 private:
  struct Job {
    HealthMapRequest request;
    Done done;
  };
  static constexpr std::size_t kMaximumJobs = 4;

  void run(const std::stop_token& stop);
  void answer(const std::stop_token& stop, const Job& job);

  const LocalizerParams params_;
  const SegmentMap map_edges_;
  const std::function<MemoryUpdate()> newest_;
  std::optional<HealthMapper> mapper_;  ///< the thread's
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;  ///< the first is being drawn
  bool stopped_ = false;
  std::jthread thread_;  ///< last member: it uses all of the above
};

}  // namespace vismem
