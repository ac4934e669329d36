#include "localization/app/gaze_sender.h"

#include <mutex>
#include <utility>

#include "common/memory_ice/gaze_ice.h"
#include "common/robot_ice/remote.h"

namespace vismem {
namespace {

/// Largest number of unanswered calls; further requests are lost.
constexpr int kMostCalls = 4;
constexpr std::chrono::seconds kIdle{1};

}  // namespace

/// State of the answers, which may arrive after the sender's end.
struct GazeSender::Shared {
  Shared(const std::shared_ptr<Ice::ObjectPrx>& proxy, StatusBoard& board, Logger& log)
      : link("Gaze", proxy, board, log), status(&board) {}

  void answered(const std::shared_ptr<avm::GazePrx>& proxy) {
    const std::lock_guard lock(mutex);
    --calls;
    if (!status) return;
    connection = proxy->ice_getCachedConnection();
    link.succeeded();
  }
  void failed(const std::shared_ptr<avm::GazePrx>& proxy, const std::exception_ptr& error, bool is_request) {
    const std::lock_guard lock(mutex);
    --calls;
    if (!status) return;
    try {
      std::rethrow_exception(error);
    } catch (const Ice::UserException& refusal) {
      // The peer is reachable and refuses.
      link.succeeded();
      if (is_request) status->count("gaze requests refused");
      status->error(describeFailure(*proxy, error));
    } catch (...) {
      if (is_request) status->count("gaze requests lost");
      link.failed(reasonOf(*proxy, error));
      if (const auto gone = std::exchange(connection, nullptr)) leaveIfSilent(*gone, error);
    }
  }

  std::mutex mutex;
  PeerLink link;
  StatusBoard* status;  ///< null after close()
  std::shared_ptr<Ice::Connection> connection;
  int calls = 0;  ///< unanswered
};

GazeSender::GazeSender(const std::shared_ptr<Ice::ObjectPrx>& proxy, StatusBoard& status, Logger& log)
    : proxy_(boundedProxy(Ice::uncheckedCast<avm::GazePrx>(proxy), kCommandTimeout_ms)),
      shared_(std::make_shared<Shared>(proxy, status, log)) {}

bool GazeSender::beginCall() {
  const std::lock_guard lock(shared_->mutex);
  if (!shared_->status || shared_->calls >= kMostCalls) return false;
  ++shared_->calls;
  last_call_ = std::chrono::steady_clock::now();
  return true;
}

void GazeSender::send(const GazePlan& plan) {
  const auto answered = [shared = shared_, proxy = proxy_](const auto&...) { shared->answered(proxy); };
  const auto failed = [shared = shared_, proxy = proxy_](bool is_request) {
    return [shared, proxy, is_request](const std::exception_ptr& error) {
      shared->failed(proxy, error, is_request);
    };
  };
  // A lost withdrawal ends at the request's deadline.
  if (plan.withdrawn && beginCall()) {
    proxy_->withdrawAsync(kGazeClientName, *plan.withdrawn, answered, failed(false));
  }
  if (!plan.request) return;
  const bool is_free = beginCall();
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->status) shared_->status->count(is_free ? "gaze requests" : "gaze requests lost");
  }
  if (is_free) proxy_->requestAsync(toIce(*plan.request), answered, failed(true));
}

void GazeSender::keepInTouch() {
  if (std::chrono::steady_clock::now() - last_call_ < kIdle || !beginCall()) return;
  proxy_->ice_pingAsync([shared = shared_, proxy = proxy_] { shared->answered(proxy); },
                        [shared = shared_, proxy = proxy_](const std::exception_ptr& error) {
                          shared->failed(proxy, error, false);
                        });
}

void GazeSender::close() {
  const std::lock_guard lock(shared_->mutex);
  shared_->status = nullptr;
  shared_->connection.reset();
}

}  // namespace vismem
