/// @file Tools of clients of remote servers: proxies with timeouts, messages for failures, pending requests.
#pragma once

#include <Ice/Ice.h>
#include <avm/common.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/robot/ports.h"
#include "common/robot_ice/conversions.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

/// Timeout of long-polls [ms]: above the server's wait. Only for proxies without a timeout of their own.
constexpr int kInvocationTimeout_ms = 3000;
/// Timeout of commands [ms]: the longest pause of a control loop by a frozen peer.
constexpr int kCommandTimeout_ms = 1000;

/// The proxy with an invocation timeout of at most `max_ms`. Null stays null.
template <typename Prx>
std::shared_ptr<Prx> boundedProxy(const std::shared_ptr<Prx>& proxy, int max_ms) {
  if (!proxy) return nullptr;
  const int timeout_ms = proxy->ice_getInvocationTimeout();
  if (timeout_ms > 0 && timeout_ms <= max_ms) return proxy;
  return proxy->ice_invocationTimeout(max_ms);
}

/// Called after each request of a client's stream with the reason of its failure (reasonOf), or empty after
/// an answer. Called on the thread that uses the client; connects the client to a component's status.
using LinkReport = std::function<void(const std::string& failure)>;

/// Reason of a failed call in one line, for people.
std::string reasonOf(const Ice::ObjectPrx& proxy, const std::exception_ptr& error);
/// As reasonOf, preceded by the name of the peer; a message of the peer itself stands alone.
std::string describeFailure(const Ice::ObjectPrx& proxy, const std::exception_ptr& error);

/// Closes the connection of a call without an answer in time. It may be half-open (the host disappeared), and
/// later calls on it would be lost too. The next call opens a new connection.
void leaveIfSilent(Ice::Connection& connection, const std::exception_ptr& error);

/// Runs a command of a remote server. Never throws: failures are rejections with the reason.
template <typename Prx, typename Call>
PortReply runRemote(const std::shared_ptr<Prx>& proxy, const char* what, Call&& call) {
  if (!proxy) return PortReply::rejected(std::string("no ") + what + " is configured");
  try {
    const avm::CommandReply reply = call(*proxy);
    return reply.adjusted ? PortReply::adjusted(reply.message) : PortReply::accepted();
  } catch (...) {
    return PortReply::rejected(describeFailure(*proxy, std::current_exception()));
  }
}

/// One request in flight to a server. A wait that ends before the answer leaves the request pending for the
/// next wait. Short timeouts therefore neither lose answers nor accumulate requests. After a failure the next
/// request follows kRetry later at the earliest. A failed wait lasts its whole timeout, so that callers do
/// not spin while the peer is away. *Thread-safe*: waits exclude each other, and interrupt() may be called
/// meanwhile.
template <typename Result>
class PendingCall {
 public:
  using Success = std::function<void(Result)>;
  using Failed = std::function<void(std::exception_ptr)>;
  /// Sends the request; one of the two is called later, on any thread.
  using Send = std::function<void(Success, Failed)>;

  struct Outcome {
    std::optional<Result> result;
    std::string failure;  ///< reason why there is none; empty while the answer is pending
  };

  explicit PendingCall(std::shared_ptr<Ice::ObjectPrx> proxy, LinkReport report = {})
      : proxy_(std::move(proxy)), report_(std::move(report)) {}

  /// Waits at most `timeout` for the answer to the pending request, or to a new one if none is pending.
  Outcome wait(const Send& send, std::chrono::milliseconds timeout) {
    const std::lock_guard one_at_a_time(waits_);
    const auto deadline = Clock::now() + timeout;
    if (!proxy_) {
      pauseUntil(deadline);
      return {std::nullopt, "no server is configured"};
    }
    if (!slot_) {
      pauseUntil(std::min(deadline, not_before_));
      if (Clock::now() < not_before_ || interrupted()) return {std::nullopt, failure_};
      begin(send);
    }
    std::optional<Result> result;
    std::exception_ptr error;
    {
      std::unique_lock lock(gate_->mutex);
      const auto answered = [this] { return slot_->result || slot_->error; };
      gate_->changed.wait_until(lock, deadline, [&] { return answered() || gate_->interrupted; });
      if (!answered()) return {std::nullopt, failure_};
      result = std::move(slot_->result);
      error = slot_->error;
    }
    slot_.reset();
    if (result) {
      // Ice reports no connection for a failed call.
      connection_ = proxy_->ice_getCachedConnection();
      failure_.clear();
      if (report_) report_(failure_);
      return {std::move(result), {}};
    }
    failure_ = describeFailure(*proxy_, error);
    if (const auto connection = std::exchange(connection_, nullptr)) leaveIfSilent(*connection, error);
    not_before_ = Clock::now() + kRetry;
    if (report_) report_(reasonOf(*proxy_, error));
    pauseUntil(deadline);
    return {std::nullopt, failure_};
  }

  /// Ends present and later waits at once, until allow() is called. A request in flight stays pending.
  void interrupt() { setInterrupted(true); }
  void allow() { setInterrupted(false); }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRetry{200};

  /// State of the waits. Shared with the answer, which may arrive after the destruction of this object.
  struct Gate {
    std::mutex mutex;
    std::condition_variable changed;
    bool interrupted = false;
  };
  /// One request's answer; guarded by the gate.
  struct Slot {
    std::optional<Result> result;
    std::exception_ptr error;
  };

  void setInterrupted(bool value) {
    {
      const std::lock_guard lock(gate_->mutex);
      gate_->interrupted = value;
    }
    gate_->changed.notify_all();
  }
  bool interrupted() const {
    const std::lock_guard lock(gate_->mutex);
    return gate_->interrupted;
  }
  void pauseUntil(Clock::time_point when) {
    std::unique_lock lock(gate_->mutex);
    gate_->changed.wait_until(lock, when, [this] { return gate_->interrupted; });
  }

  void begin(const Send& send) {
    slot_ = std::make_shared<Slot>();
    const auto fail = [gate = gate_, slot = slot_](const std::exception_ptr& error) {
      const std::lock_guard lock(gate->mutex);
      slot->error = error;
      gate->changed.notify_all();
    };
    try {
      send(
          [gate = gate_, slot = slot_](Result result) {
            const std::lock_guard lock(gate->mutex);
            slot->result = std::move(result);
            gate->changed.notify_all();
          },
          fail);
    } catch (...) {
      fail(std::current_exception());
    }
  }

  std::shared_ptr<Ice::ObjectPrx> proxy_;
  LinkReport report_;
  std::shared_ptr<Ice::Connection> connection_;  ///< that carried the last answer
  std::mutex waits_;
  const std::shared_ptr<Gate> gate_ = std::make_shared<Gate>();
  std::shared_ptr<Slot> slot_;  ///< of the waits
  Clock::time_point not_before_{};
  std::string failure_;  ///< of the last request that ended; empty when it succeeded
};

/// What a server says of itself, such as the limits of a device; the last answer is kept. *Thread-safe*.
template <typename Result>
class AskedValue {
 public:
  using Send = typename PendingCall<Result>::Send;
  AskedValue(std::shared_ptr<Ice::ObjectPrx> proxy, Send send)
      : send_(std::move(send)), call_(std::move(proxy)) {}

  /// Waits at most `timeout` for an answer.
  /// @return why there is none; empty when it came, or while it is pending.
  std::string ask(std::chrono::milliseconds timeout) {
    auto outcome = call_.wait(send_, timeout);
    const std::lock_guard lock(mutex_);
    if (outcome.result) last_ = std::move(outcome.result);
    return outcome.failure;
  }
  std::optional<Result> last() const {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  /// Of PendingCall.
  void interrupt() { call_.interrupt(); }
  void allow() { call_.allow(); }

 private:
  const Send send_;
  PendingCall<Result> call_;
  mutable std::mutex mutex_;
  std::optional<Result> last_;
};

/// One wait of a client's samplesSince: samples newer than requested, or all samples of the server when its
/// time went back. `call` must belong to this stream alone; `convert` converts one sample from the wire.
template <typename Sample, typename IceBatch, typename Convert>
SampleBatch<Sample> pollRemoteSamples(PendingCall<IceBatch>& call, StampUs after_us,
                                      std::chrono::milliseconds timeout,
                                      const typename PendingCall<IceBatch>::Send& send, Convert&& convert) {
  const auto outcome = call.wait(send, timeout);
  if (!outcome.result) {
    return {SourceState::kWaiting, {}, outcome.failure.empty() ? "no sample yet" : outcome.failure};
  }
  SampleBatch<Sample> batch{fromIce(outcome.result->state), {}, outcome.result->message};
  batch.samples.reserve(outcome.result->samples.size());
  for (const auto& sample : outcome.result->samples) batch.samples.push_back(convert(sample));
  // The answer may belong to an earlier question.
  batch.samples = newerThan(std::move(batch.samples), after_us);
  if (batch.samples.empty() && batch.state == SourceState::kRunning) batch.state = SourceState::kWaiting;
  return batch;
}

}  // namespace vismem
