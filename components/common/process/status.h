/// @file Status of a component: state, peers, rates, latencies, estimates, last errors. No Ice.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/metrics.h"
#include "common/process/peer_state.h"

namespace vismem {

class Logger;

enum class RunState { kStarting, kWaiting, kRunning, kDegraded, kStopping };
/// "starting", "waiting", "running", "degraded", "stopping".
const char* nameOf(RunState state);

struct PeerReport {
  /// As in the configuration: "Camera".
  std::string name;
  std::string proxy;
  PeerState::Link link = PeerState::Link::kAbsent;
  /// Reason why it is away; empty while connected.
  std::string reason;
  int reconnections = 0;
};

struct StatusReport {
  struct Rate {
    std::string name;
    double hz = 0;
    std::int64_t total = 0;
  };
  struct Latency {
    std::string name;
    LatencyHistogram::Figures figures;
  };
  /// A quantity that the component estimates of itself, with its standard deviation.
  struct Gauge {
    std::string name;
    double value = 0;
    double sigma = 0;
    /// Unit of value and sigma: "deg".
    std::string unit;
  };
  struct Error {
    /// Host's real time [us].
    std::int64_t stamp_us = 0;
    std::string text;
  };
  std::string name;
  std::string version;
  RunState state = RunState::kStarting;
  /// Reason why it is not running; empty otherwise.
  std::string reason;
  double uptime_s = 0;
  std::vector<PeerReport> peers;
  std::vector<Rate> rates;
  std::vector<Latency> latencies;
  std::vector<Gauge> gauges;
  /// The last errors, oldest first.
  std::vector<Error> errors;
};

/// Collects the status of one component. The state follows from the reports: starting until serving(), then
/// waiting until every peer has connected once. It is degraded while a peer is lost, a fault lasts or a
/// watched thread makes no progress; otherwise running. After stopping() it stays stopping. Thread-safe.
class StatusBoard {
 public:
  using Clock = std::function<SteadyTime()>;
  /// Default limit of a thread without progress: above every bounded wait of a loop (a command to a frozen
  /// peer takes 1 s).
  static constexpr std::chrono::milliseconds kProgressLimit{5000};

  StatusBoard(std::string name, std::string version, Logger& log,
              Clock clock = std::chrono::steady_clock::now);

  void serving();
  void stopping();

  /// Counts one event: "frames", "iterations".
  void count(const std::string& what);
  /// Adds one duration [s]: "detect", "frame age".
  void latency(const std::string& what, double duration_s);

  /// Sets an estimate: replaces the gauge of the same name.
  void gauge(StatusReport::Gauge now);

  /// Reports a fault of the component itself: "odometry", "no sample for 2.0 s". Its begin and each change of
  /// its reason are logged and kept as errors; a reason that differs in durations only replaces the last one.
  void fault(const std::string& what, const std::string& why);
  /// Ends a fault. Logs only the end of a fault; a call without a fault is cheap.
  void healthy(const std::string& what);
  /// Reports progress of a thread: "perception". The thread is watched from its first report on. Without a
  /// new report within the limit the component is degraded, "perception: no progress for 6.2 s".
  void alive(const std::string& thread, std::chrono::milliseconds limit = kProgressLimit);
  /// Ends the watch of a thread that has ended regularly.
  void ended(const std::string& thread);
  /// Logs the begin and end of missing progress, once per change. The main thread calls it periodically.
  /// @return whether all watched threads make progress.
  bool checkProgress();

  /// Reports a failure without a lasting fault. A repetition of the same text is neither kept nor logged.
  void error(const std::string& text);

  /// Logs an event that is no failure: "a new epoch: the odometry jumped by 3.2 m".
  void note(const std::string& text);

  /// Adds a peer or replaces the one of that name. Logs nothing.
  void setPeer(const PeerReport& peer);
  void setConfiguration(std::vector<Setting> settings);

  StatusReport report() const;
  /// State and reason in one line: "degraded: Camera is lost (connection refused)".
  std::string stateLine() const;
  std::vector<Setting> configuration() const;

 private:
  struct Watched {
    SteadyTime last;
    std::chrono::milliseconds limit{};
    bool reported = false;
  };

  void keepError(const std::string& text);
  void decideState(StatusReport& report, SteadyTime now) const;

  const std::string name_;
  const std::string version_;
  Logger& log_;
  const Clock clock_;
  const SteadyTime begin_;

  mutable std::mutex mutex_;
  bool serving_ = false;
  bool stopping_ = false;
  std::vector<PeerReport> peers_;
  std::map<std::string, RateCounter> rates_;
  std::map<std::string, LatencyHistogram> latencies_;
  std::vector<StatusReport::Gauge> gauges_;
  std::map<std::string, std::string> faults_;
  std::map<std::string, Watched> watched_;
  std::deque<StatusReport::Error> errors_;
  std::vector<Setting> settings_;
};

}  // namespace vismem
