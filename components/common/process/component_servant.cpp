#include "common/process/component_servant.h"

namespace vismem {
namespace {

constexpr double kMsPerSecond = 1e3;

RunState fromSlice(avm::ComponentState state) {
  switch (state) {
    case avm::ComponentState::Starting:
      return RunState::kStarting;
    case avm::ComponentState::WaitingForPeers:
      return RunState::kWaiting;
    case avm::ComponentState::Running:
      return RunState::kRunning;
    case avm::ComponentState::Degraded:
      return RunState::kDegraded;
    case avm::ComponentState::Stopping:
      return RunState::kStopping;
  }
  return RunState::kStarting;
}

}  // namespace

avm::ComponentState toSlice(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return avm::ComponentState::Starting;
    case RunState::kWaiting:
      return avm::ComponentState::WaitingForPeers;
    case RunState::kRunning:
      return avm::ComponentState::Running;
    case RunState::kDegraded:
      return avm::ComponentState::Degraded;
    case RunState::kStopping:
      return avm::ComponentState::Stopping;
  }
  return avm::ComponentState::Starting;
}

avm::ComponentStatus toSlice(const StatusReport& report) {
  avm::ComponentStatus status;
  status.name = report.name;
  status.version = report.version;
  status.state = toSlice(report.state);
  status.reason = report.reason;
  status.uptimeS = report.uptime_s;
  for (const auto& peer : report.peers) {
    status.peers.push_back(
        {peer.name, peer.proxy, peer.link == PeerState::Link::kConnected, peer.reason, peer.reconnections});
  }
  for (const auto& rate : report.rates) {
    status.rates.push_back({rate.name, rate.hz, static_cast<long long>(rate.total)});
  }
  for (const auto& [name, figures] : report.latencies) {
    status.latencies.push_back({name, static_cast<long long>(figures.samples), kMsPerSecond * figures.p50_s,
                                kMsPerSecond * figures.p95_s, kMsPerSecond * figures.p99_s,
                                kMsPerSecond * figures.max_s});
  }
  for (const auto& gauge : report.gauges) {
    status.gauges.push_back({gauge.name, gauge.value, gauge.sigma, gauge.unit});
  }
  for (const auto& error : report.errors) {
    status.errors.push_back({static_cast<long long>(error.stamp_us), error.text});
  }
  return status;
}

StatusReport fromSlice(const avm::ComponentStatus& status) {
  StatusReport report;
  report.name = status.name;
  report.version = status.version;
  report.state = fromSlice(status.state);
  report.reason = status.reason;
  report.uptime_s = status.uptimeS;
  for (const auto& peer : status.peers) {
    const auto link = peer.connected ? PeerState::Link::kConnected : PeerState::Link::kLost;
    report.peers.push_back({peer.name, peer.proxy, link, peer.message, peer.reconnections});
  }
  for (const auto& rate : status.rates) report.rates.push_back({rate.name, rate.hz, rate.total});
  for (const auto& latency : status.latencies) {
    report.latencies.push_back({latency.name,
                                {latency.samples, latency.p50Ms / kMsPerSecond, latency.p95Ms / kMsPerSecond,
                                 latency.p99Ms / kMsPerSecond, latency.maxMs / kMsPerSecond}});
  }
  for (const auto& gauge : status.gauges) {
    report.gauges.push_back({gauge.name, gauge.value, gauge.sigma, gauge.unit});
  }
  for (const auto& error : status.errors) report.errors.push_back({error.stampUs, error.text});
  return report;
}

avm::ComponentStatus ComponentServant::getStatus(const Ice::Current&) {
  return toSlice(status_.report());
}

avm::SettingSeq ComponentServant::getConfiguration(const Ice::Current&) {
  avm::SettingSeq settings;
  for (const auto& setting : status_.configuration()) settings.push_back({setting.key, setting.value});
  return settings;
}

static_assert(static_cast<int>(LogLevel::kDebug) == static_cast<int>(avm::LogLevel::Debug));
static_assert(static_cast<int>(LogLevel::kInfo) == static_cast<int>(avm::LogLevel::Info));
static_assert(static_cast<int>(LogLevel::kWarning) == static_cast<int>(avm::LogLevel::Warning));
static_assert(static_cast<int>(LogLevel::kError) == static_cast<int>(avm::LogLevel::Error));

avm::LogBatch ComponentServant::getLog(Ice::Long after_sequence, avm::LogLevel lowest, int most,
                                       const Ice::Current&) {
  if (most < 1 || most > static_cast<int>(LogRing::kCapacity)) {
    throw avm::InvalidArgument("most = " + std::to_string(most) + " (must be 1.." +
                               std::to_string(LogRing::kCapacity) + ")");
  }
  const auto batch =
      log_.since(after_sequence, static_cast<LogLevel>(lowest), static_cast<std::size_t>(most));
  avm::LogBatch answer;
  answer.entries.reserve(batch.messages.size());
  for (const LogLine& message : batch.messages) {
    answer.entries.push_back(
        {message.seq, message.stamp_us, static_cast<avm::LogLevel>(message.level), message.text});
  }
  answer.lastSequence = batch.last_seq;
  answer.lost = batch.lost;
  return answer;
}

avm::ParameterSeq ComponentServant::parameters(const Ice::Current&) {
  avm::ParameterSeq answer;
  for (const auto& [parameter, value] : parameters_.list()) {
    answer.push_back({parameter.name, parameter.unit, parameter.minimum, parameter.maximum, parameter.whole,
                      value, parameter.configured, parameter.description});
  }
  return answer;
}

avm::CommandReply ComponentServant::setParameter(std::string name, double value, const Ice::Current&) {
  const auto outcome = parameters_.set(name, value);
  switch (outcome.kind) {
    case ParameterTable::Outcome::Kind::kInvalid:
      throw avm::InvalidArgument(outcome.reason);
    case ParameterTable::Outcome::Kind::kRefused:
      throw avm::Refused(outcome.reason);
    case ParameterTable::Outcome::Kind::kAccepted:
      break;
  }
  return {};
}

}  // namespace vismem
