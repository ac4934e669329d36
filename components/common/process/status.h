/// @file What a component tells about itself (DESIGN 10): state, peers, rates, latencies, estimates, last errors. No
/// Ice.
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
  /// Why it is away; empty while connected.
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
  /// What the component has estimated of itself, with its standard deviation.
  struct Gauge {
    std::string name;
    double value = 0;
    double sigma = 0;
    /// Of both.
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
  /// Why it is not running; empty otherwise.
  std::string reason;
  double uptime_s = 0;
  std::vector<PeerReport> peers;
  std::vector<Rate> rates;
  std::vector<Latency> latencies;
  std::vector<Gauge> gauges;
  /// The last ones, oldest first.
  std::vector<Error> errors;
};

/// Collects the status of one component. The state follows from what is told: starting until serving(), then
/// waiting while a peer has not been there yet, degraded while a peer is lost, anything is faulty or a
/// watched thread makes no progress, else running; stopping for good after stopping(). Thread-safe.
class StatusBoard {
 public:
  using Clock = std::function<SteadyTime()>;
  /// Above every bounded wait of a loop (a command to a frozen peer takes a second), below anyone's patience.
  static constexpr std::chrono::milliseconds kProgressLimit{5000};

  StatusBoard(std::string name, std::string version, Logger& log,
              Clock clock = std::chrono::steady_clock::now);

  void serving();
  void stopping();

  /// One more of something: "frames", "iterations".
  void count(const std::string& what);
  /// One duration [s]: "detect", "frame age".
  void latency(const std::string& what, double duration_s);

  /// What is believed now of something: replaces what was of that name.
  void gauge(StatusReport::Gauge now);

  /// Something of the component's own does not work: "odometry", "no sample for 2.0 s". Logged when it begins
  /// and when its reason changes; it counts as an error then.
  void fault(const std::string& what, const std::string& why);
  /// It works (again). Logged if it had not; cheap otherwise, so call it freely.
  void healthy(const std::string& what);
  /// A thread goes round: "perception". From now on it is watched: while it does not say so again within the
  /// limit, the component is degraded, "perception: no progress for 6.2 s". So a thread that hangs does not
  /// hang silently.
  void alive(const std::string& thread, std::chrono::milliseconds limit = kProgressLimit);
  /// The thread has come to its proper end and is watched no more.
  void ended(const std::string& thread);
  /// Logs who has begun or ceased to hang, once per change. Called now and then by who hangs last: the main
  /// thread.
  void checkProgress();

  /// A failure that leaves no lasting fault. The same text again in a row is neither kept nor logged.
  void error(const std::string& text);

  /// Something worth a line in the log that is no failure: "a new epoch: the odometry jumped by 3.2 m".
  void note(const std::string& text);

  /// Adds a peer or replaces the one of that name. Logs nothing.
  void setPeer(const PeerReport& peer);
  void setConfiguration(std::vector<Setting> settings);

  StatusReport report() const;
  std::vector<Setting> configuration() const;

 private:
  struct Watched {
    SteadyTime last;
    std::chrono::milliseconds limit{};
    bool told = false;
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
