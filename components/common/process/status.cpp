#include "common/process/status.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <regex>
#include <utility>

#include "common/config/text_format.h"
#include "common/process/log.h"

namespace vismem {
namespace {

constexpr std::size_t kKeptErrors = 20;

void append(std::string& reason, const std::string& part) {
  if (!reason.empty()) reason += "; ";
  reason += part;
}

/// "no progress for 6.2 s".
std::string noProgress(SteadyTime::duration time) {
  return formatted("no progress for %.1f s", std::chrono::duration<double>(time).count());
}

/// "stamps are  ahead" of "stamps are 4.9 s ahead", so that a length that varies is no other reason.
std::string withoutDurations(const std::string& text) {
  static const std::regex duration("[0-9.]+ s\\b");
  return std::regex_replace(text, duration, "");
}

std::int64_t realTimeUs() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

const char* nameOf(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return "starting";
    case RunState::kWaiting:
      return "waiting";
    case RunState::kRunning:
      return "running";
    case RunState::kDegraded:
      return "degraded";
    case RunState::kStopping:
      return "stopping";
  }
  return "";
}

StatusBoard::StatusBoard(std::string name, std::string version, Logger& log, Clock clock)
    : name_(std::move(name)),
      version_(std::move(version)),
      log_(log),
      clock_(std::move(clock)),
      begin_(clock_()) {}

void StatusBoard::serving() {
  const std::scoped_lock lock(mutex_);
  serving_ = true;
}

void StatusBoard::stopping() {
  const std::scoped_lock lock(mutex_);
  stopping_ = true;
}

void StatusBoard::count(const std::string& what) {
  const auto now = clock_();
  const std::scoped_lock lock(mutex_);
  rates_[what].count(now);
}

void StatusBoard::latency(const std::string& what, double duration_s) {
  const auto now = clock_();
  const std::scoped_lock lock(mutex_);
  latencies_[what].add(now, duration_s);
}

void StatusBoard::gauge(StatusReport::Gauge now) {
  const std::scoped_lock lock(mutex_);
  const auto known =
      std::find_if(gauges_.begin(), gauges_.end(), [&](const auto& gauge) { return gauge.name == now.name; });
  if (known == gauges_.end()) {
    gauges_.push_back(std::move(now));
  } else {
    *known = std::move(now);
  }
}

void StatusBoard::fault(const std::string& what, const std::string& why) {
  {
    const std::scoped_lock lock(mutex_);
    auto& known = faults_[what];
    if (known == why) return;
    const bool is_other = withoutDurations(known) != withoutDurations(why);
    known = why;
    if (!is_other) return;
    keepError(what + ": " + why);
  }
  log_.warning(what + ": " + why);
}

void StatusBoard::healthy(const std::string& what) {
  {
    const std::scoped_lock lock(mutex_);
    if (faults_.erase(what) == 0) return;
  }
  log_.info(what + ": back to normal");
}

void StatusBoard::alive(const std::string& thread, std::chrono::milliseconds limit) {
  const auto now = clock_();
  const std::scoped_lock lock(mutex_);
  auto& watched = watched_[thread];
  watched.last = now;
  watched.limit = limit;
}

void StatusBoard::ended(const std::string& thread) {
  const std::scoped_lock lock(mutex_);
  watched_.erase(thread);
}

bool StatusBoard::checkProgress() {
  const auto now = clock_();
  std::vector<std::string> hanging;
  std::vector<std::string> back;
  bool progress = true;
  {
    const std::scoped_lock lock(mutex_);
    for (auto& [thread, watched] : watched_) {
      const bool hangs = now - watched.last > watched.limit;
      progress = progress && !hangs;
      if (hangs == watched.reported) continue;
      watched.reported = hangs;
      if (hangs) {
        hanging.push_back(thread + ": " + noProgress(now - watched.last));
        keepError(hanging.back());
      } else {
        back.push_back(thread);
      }
    }
  }
  for (const auto& text : hanging) log_.error(text);
  for (const auto& thread : back) log_.info(thread + " goes on");
  return progress;
}

void StatusBoard::error(const std::string& text) {
  {
    const std::scoped_lock lock(mutex_);
    if (!errors_.empty() && errors_.back().text == text) return;
    keepError(text);
  }
  log_.error(text);
}

void StatusBoard::note(const std::string& text) {
  log_.info(text);
}

void StatusBoard::keepError(const std::string& text) {
  errors_.push_back({realTimeUs(), text});
  if (errors_.size() > kKeptErrors) errors_.pop_front();
}

void StatusBoard::setPeer(const PeerReport& peer) {
  const std::scoped_lock lock(mutex_);
  const auto known = std::find_if(peers_.begin(), peers_.end(),
                                  [&](const PeerReport& other) { return other.name == peer.name; });
  if (known == peers_.end()) {
    peers_.push_back(peer);
  } else {
    *known = peer;
  }
}

void StatusBoard::setConfiguration(std::vector<Setting> settings) {
  const std::scoped_lock lock(mutex_);
  settings_ = std::move(settings);
}

void StatusBoard::decideState(StatusReport& report, SteadyTime now) const {
  std::string absent;
  std::string lost;
  for (const auto& peer : peers_) {
    if (peer.link == PeerState::Link::kAbsent)
      append(absent, "waiting for " + peer.name + " at " + peer.proxy);
    if (peer.link == PeerState::Link::kLost) append(lost, peer.name + " is lost (" + peer.reason + ")");
  }
  for (const auto& [what, why] : faults_) append(lost, what + ": " + why);
  for (const auto& [thread, watched] : watched_) {
    if (now - watched.last > watched.limit) append(lost, thread + ": " + noProgress(now - watched.last));
  }
  if (stopping_) {
    report.state = RunState::kStopping;
  } else if (!serving_) {
    report.state = RunState::kStarting;
  } else if (!absent.empty()) {
    report.state = RunState::kWaiting;
    report.reason = absent;
    if (!lost.empty()) append(report.reason, lost);
  } else if (!lost.empty()) {
    report.state = RunState::kDegraded;
    report.reason = lost;
  } else {
    report.state = RunState::kRunning;
  }
}

StatusReport StatusBoard::report() const {
  const auto now = clock_();
  const std::scoped_lock lock(mutex_);
  StatusReport report;
  report.name = name_;
  report.version = version_;
  report.uptime_s = std::chrono::duration<double>(now - begin_).count();
  report.peers = peers_;
  for (const auto& [name, rate] : rates_) report.rates.push_back({name, rate.hz(now), rate.total()});
  for (const auto& [name, latency] : latencies_) report.latencies.push_back({name, latency.figures(now)});
  report.gauges = gauges_;
  report.errors.assign(errors_.begin(), errors_.end());
  decideState(report, now);
  return report;
}

std::string StatusBoard::stateLine() const {
  const auto now = clock_();
  const std::scoped_lock lock(mutex_);
  StatusReport report;
  decideState(report, now);
  return nameOf(report.state) + (report.reason.empty() ? std::string() : ": " + report.reason);
}

std::vector<Setting> StatusBoard::configuration() const {
  const std::scoped_lock lock(mutex_);
  return settings_;
}

}  // namespace vismem
