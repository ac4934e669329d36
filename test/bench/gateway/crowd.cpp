#include "bench/gateway/crowd.h"

#include <Glacier2/Router.h>

#include <algorithm>
#include <atomic>
#include <mutex>

namespace vismem {

class Crowd::Viewer : public std::enable_shared_from_this<Crowd::Viewer> {
 public:
  Viewer(Ice::Communicator& communicator, const test::Gateway& gateway, const std::string& endpoint,
         int number)
      // One connection for each id.
      : router_(Ice::uncheckedCast<Glacier2::RouterPrx>(communicator.stringToProxy(gateway.routerProxy(true))
                                                            ->ice_connectionId(std::to_string(number)))) {
    router_->createSession(test::Gateway::kViewer, test::Gateway::kPassword);
    camera_ = Ice::uncheckedCast<avm::CameraPrx>(communicator.stringToProxy("robot.view/cameraA:" + endpoint)
                                                     ->ice_router(router_)
                                                     ->ice_connectionId(std::to_string(number)));
  }

  void ask() {
    if (ended_) return;
    camera_->getNextAsync(
        "JPEG", last_,
        [self = shared_from_this()](const avm::FrameResult& result) {
          self->got(result);
          self->ask();
        },
        [self = shared_from_this()](const std::exception_ptr& reason) { self->failed(reason); });
  }

  void end() {
    ended_ = true;
    try {
      router_->destroySession();
    } catch (const std::exception&) {
      // It is gone with its connection.
    }
  }

  std::pair<std::int64_t, std::int64_t> take() { return {images_.exchange(0), bytes_.exchange(0)}; }

  std::string failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }

 private:
  void got(const avm::FrameResult& result) {
    if (result.state != avm::SourceState::Running) return;
    last_ = result.image.seq;
    ++images_;
    bytes_ += static_cast<std::int64_t>(result.image.pixels.size());
  }

  void failed(const std::exception_ptr& reason) {
    if (ended_) return;
    const std::lock_guard lock(mutex_);
    try {
      std::rethrow_exception(reason);
    } catch (const std::exception& error) {
      failure_ = error.what();
    }
  }

  const std::shared_ptr<Glacier2::RouterPrx> router_;
  std::shared_ptr<avm::CameraPrx> camera_;
  Ice::Long last_ = -1;  ///< of one call at a time
  std::atomic<bool> ended_ = false;
  std::atomic<std::int64_t> images_ = 0;
  std::atomic<std::int64_t> bytes_ = 0;
  mutable std::mutex mutex_;
  std::string failure_;
};

Crowd::Crowd(const test::Gateway& gateway, const std::string& endpoint, int viewers)
    : communicator_(gateway.client()) {
  for (int i = 0; i < viewers; ++i)
    viewers_.push_back(std::make_shared<Viewer>(*communicator_.communicator(), gateway, endpoint, i));
  for (const auto& viewer : viewers_) viewer->ask();
}

Crowd::~Crowd() {
  for (const auto& viewer : viewers_) viewer->end();
}

CrowdCount Crowd::take() {
  CrowdCount count;
  for (std::size_t i = 0; i < viewers_.size(); ++i) {
    const auto [images, bytes] = viewers_[i]->take();
    count.images += images;
    count.bytes += bytes;
    count.least_images = i == 0 ? images : std::min(count.least_images, images);
  }
  return count;
}

std::string Crowd::failure() const {
  for (const auto& viewer : viewers_) {
    if (auto failure = viewer->failure(); !failure.empty()) return failure;
  }
  return {};
}

}  // namespace vismem
