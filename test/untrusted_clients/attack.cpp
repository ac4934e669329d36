#include "untrusted_clients/attack.h"

#include <algorithm>
#include <chrono>
#include <fstream>

#include "untrusted_clients/garbage.h"
#include "untrusted_clients/ice_wire.h"

namespace vismem::test {
namespace {

using namespace std::chrono_literals;

/// Calls in flight on one connection: fewer than a server's long-polls hold, so that none is answered early.
constexpr int kBatch = 128;
/// A long-poll ends after a second; a busy machine with sanitizers takes its time.
constexpr auto kAnswerWithin = 30s;

double statusMb(pid_t pid, const std::string& key) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string word; status >> word;) {
    double kb = 0.0;
    if (word == key && status >> kb) return kb / 1024.0;
  }
  return 0.0;
}

}  // namespace

AbsurdCaller::AbsurdCaller(const SliceModel& model, const Target& target, std::uint64_t seed)
    : target_(target), random_(seed), values_(model, random_) {
  for (const auto& [identity, interface] : target.objects) {
    for (const auto& operation : interface->operations) operations_.emplace_back(identity, &operation);
  }
}

bool AbsurdCaller::connect() {
  if (connection_ && connection_->open()) return true;
  if (connection_) ++closed_;
  connection_ = std::make_unique<RawConnection>(target_.tcp_port);
  return connection_->open() && connection_->receive(kAnswerWithin).has_value();
}

std::string AbsurdCaller::next(bool& is_twoway) {
  const auto& [identity, operation] = operations_[turn_++ % operations_.size()];
  Call call;
  const auto slash = identity.find('/');
  call.category = slash == std::string::npos ? "" : identity.substr(0, slash);
  call.name = slash == std::string::npos ? identity : identity.substr(slash + 1);
  call.operation = operation->name;
  call.idempotent = operation->idempotent;
  call.parameters = values_.parametersOf(*operation);
  call.id = 1 + static_cast<std::int32_t>(calls_ % 1'000'000);
  switch (random_() % 64) {
    case 0:
      call.operation = random_() % 2 == 0 ? std::string(random_() % 3000, 'o') : call.operation + "\n%n";
      break;
    case 1:
      call.name = random_() % 2 == 0 ? std::string(random_() % 100'000, 'i') : "";
      break;
    case 2:
      call.facet = std::string(1 + random_() % 200, 'f');
      break;
    case 3:
      call.idempotent = !call.idempotent;
      break;
    case 4:
      call.parameters.resize(call.parameters.size() / 2);
      break;
    case 5:
      call.parameters += std::string(random_() % 100, '\x7f');
      break;
    case 6:
      call.id = 0;
      break;
    default:
      ++per_operation_[identity + " " + operation->name];
      break;
  }
  is_twoway = call.id != 0;
  return request(call);
}

bool AbsurdCaller::call(long count) {
  for (long made = 0; made < count; made += kBatch) {
    if (!connect()) return false;
    int expected = 0;
    for (int i = 0; i < kBatch; ++i) {
      bool is_twoway = true;
      const std::string bytes = next(is_twoway);
      ++calls_;
      if (!connection_->send(bytes, kAnswerWithin)) break;
      expected += is_twoway;
    }
    for (; expected > 0; --expected) {
      if (!connection_->receive(kAnswerWithin)) break;
      ++replies_;
    }
    if (expected > 0 && connection_->open()) return false;  // neither answered nor closed
  }
  return true;
}

long sendGarbage(const Target& target, long count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (long i = 0; i < count; ++i) {
    const bool web = target.ws_port != 0 && i % 2 == 1;
    RawConnection connection(web ? target.ws_port : target.tcp_port);
    if (!connection.open()) return i;
    const int kind = static_cast<int>(i / 2 % kKindsOfGarbage);
    const auto identity = target.objects.begin()->first;
    connection.send(garbage(kind, random, identity), 2s);
    if (random() % 4 == 0) connection.endSending();
    connection.drain(std::chrono::milliseconds(random() % 4));
  }
  return count;
}

std::vector<RawConnection> leaveStanding(const Target& target, int count) {
  std::vector<RawConnection> connections;
  for (int i = 0; i < count; ++i) {
    const bool web = target.ws_port != 0 && i % 2 == 1;
    RawConnection connection(web ? target.ws_port : target.tcp_port);
    switch (i / 2 % 4) {
      case 0:
        break;
      case 1:
        connection.send("IceP\1");
        break;
      case 2:
        connection.send(message(MessageType::kRequest, "half of it", 10'000'000));
        break;
      default:
        connection.send("GET / HTTP/1.1\r\nUpgrade: webso");
        break;
    }
    connections.push_back(std::move(connection));
  }
  return connections;
}

PoliteClient::PoliteClient(std::string name, std::function<void()> ask)
    : name_(std::move(name)), thread_([this, ask = std::move(ask)](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          const auto begin = std::chrono::steady_clock::now();
          std::string failure;
          try {
            ask();
          } catch (const std::exception& error) {
            failure = error.what();
          }
          const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
          {
            const std::lock_guard lock(mutex_);
            latencies_ms_.push_back(taken.count());
            if (!failure.empty()) failures_.push_back(failure);
          }
          std::this_thread::sleep_for(5ms);  // the pace of a client, not a wait for something
        }
      }) {}

PoliteClient::~PoliteClient() {
  stop();
}

void PoliteClient::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

PoliteClient::Figures PoliteClient::figures() const {
  const std::lock_guard lock(mutex_);
  Figures figures{name_, latencies_ms_.size(), 0.0, 0.0, 0.0, failures_};
  if (latencies_ms_.empty()) return figures;
  auto sorted = latencies_ms_;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  figures.p50_ms = at(0.5);
  figures.p99_ms = at(0.99);
  figures.max_ms = sorted.back();
  return figures;
}

double residentMb(pid_t pid) {
  return statusMb(pid, "VmRSS:");
}

double peakMb(pid_t pid) {
  return statusMb(pid, "VmHWM:");
}

}  // namespace vismem::test
