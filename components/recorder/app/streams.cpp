#include "recorder/app/streams.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/process/log.h"
#include "common/process/robot_identity.h"
#include "common/process/status.h"
#include "recorder/ice/estimate_messages.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;

/// A peer that is away is asked again so often (it has a pause of its own between tries to connect).
constexpr milliseconds kAway{100};
/// A peer that answers at once without anything new, as a recording at its end does.
constexpr milliseconds kNothing{20};
constexpr milliseconds kGazePeriod{100};

/// The word for the format in which a camera's server gives its pictures as they were captured: the first
/// that it names.
std::string formatOf(const avm::CameraInfo& info, ImageStorage storage) {
  const auto offers = [&](const char* format) {
    return std::find(info.formats.begin(), info.formats.end(), format) != info.formats.end();
  };
  if (storage == ImageStorage::kCaptured && !info.formats.empty()) return info.formats.front();
  // A grey camera's pixels are not made colour.
  const bool grey = !info.formats.empty() && info.formats.front() == "GRAY8" && offers("GRAY8");
  return grey ? "GRAY8" : "RGB8";
}

}  // namespace

Emit Streams::emitter() {
  return [this](RecordedMessage message) { service_.take(std::move(message)); };
}

void Streams::pause(milliseconds duration, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, stop, duration, [&] { return stop.stop_requested(); });
}

void Streams::run(ComponentHost& host, std::function<void(const std::stop_token&)> follow) {
  threads_.emplace_back(
      [follow = host.guarded(std::move(follow))](const std::stop_token& stop) mutable { follow(stop); });
}

void Streams::start(ComponentHost& host) {
  for (const auto& camera : config_.cameras) {
    run(host, [this, &host, camera](const std::stop_token& stop) { followCamera(host, camera, stop); });
  }
  const auto add = [&](const std::string& proxy,
                       void (Streams::*follow)(ComponentHost&, const std::stop_token&)) {
    if (proxy.empty()) return;
    run(host, [this, &host, follow](const std::stop_token& stop) { (this->*follow)(host, stop); });
  };
  add(config_.odometry, &Streams::followOdometry);
  add(config_.pan_tilt, &Streams::followPanTilt);
  add(config_.memory, &Streams::followMemory);
  add(config_.gaze, &Streams::followGaze);
  add(config_.localization, &Streams::followLocalization);
  add(config_.simulation, &Streams::followTruth);
  for (const std::string& proxy : config_.components) {
    run(host, [this, &host, proxy](const std::stop_token& stop) { followComponent(host, proxy, stop); });
  }
}

void Streams::stop() {
  for (std::jthread& thread : threads_) thread.request_stop();
  wake_.notify_all();
  threads_.clear();
}

namespace {

/// One camera's peer, asked for one image after another in the format in which it captures them.
class CameraFollower {
 public:
  CameraFollower(ComponentHost& host, const RecorderConfig::CameraStream& camera)
      : peer_(host.peer<avm::CameraPrx>(camera.name, camera.proxy)), storage_(camera.storage) {}

  /// @return the next image; empty while there is none.
  std::optional<avm::Frame> next() {
    if (!peer_->connected()) {
      format_.reset();
      sure_ = false;
    }
    if (!format_ && !askFormat()) return std::nullopt;
    auto result = peer_->call([&](avm::CameraPrx& proxy) { return proxy.getNext(*format_, last_); });
    if (!result || result->state != avm::SourceState::Running) return std::nullopt;
    if (!sure_) {
      // Before its first image a server may not know yet how it captures.
      sure_ = true;
      const std::string asked = *format_;
      if (askFormat() && *format_ != asked) return std::nullopt;  // the same image again, in the other format
    }
    const bool first = last_ < 0;
    missed_ = first || result->image.seq <= last_ + 1
                  ? 0
                  : static_cast<std::uint64_t>(result->image.seq - last_ - 1);
    last_ = result->image.seq;
    return std::move(result->image);
  }
  bool away() const { return !peer_->connected(); }
  /// Images between the last two that were passed over.
  std::uint64_t missed() const { return missed_; }

 private:
  bool askFormat() {
    const auto info = peer_->call([](avm::CameraPrx& proxy) { return proxy.getInfo(); });
    if (info) format_ = formatOf(*info, storage_);
    return info.has_value();
  }

  const std::shared_ptr<RemotePeer<avm::CameraPrx>> peer_;
  const ImageStorage storage_;
  std::optional<std::string> format_;
  bool sure_ = false;
  Ice::Long last_ = -1;
  std::uint64_t missed_ = 0;
};

}  // namespace

void Streams::followCamera(ComponentHost& host, const RecorderConfig::CameraStream& camera,
                           const std::stop_token& stop) {
  CameraFollower follower(host, camera);
  const CameraMessages messages(camera.topic, camera.storage);
  const std::string images = "images of " + camera.name;
  while (!stop.stop_requested()) {
    std::string wrong;
    try {
      const std::optional<avm::Frame> frame = follower.next();
      if (!frame) {
        pause(follower.away() ? kAway : kNothing, stop);
        continue;
      }
      if (follower.missed() > 0) service_.addMissed(messages.imageTopic(), follower.missed());
      wrong = messages.convert(*frame, emitter());
    } catch (const avm::InvalidArgument& refused) {
      wrong = refused.reason;  // a camera without this format
    }
    if (wrong.empty()) {
      host.status().healthy(images);
      host.status().count(camera.name);
    } else {
      host.status().fault(images, wrong);
      pause(kAway, stop);
    }
  }
}

template <typename Prx, typename Convert>
void Streams::followSamples(ComponentHost& host, const std::string& name, const std::string& proxy,
                            const std::stop_token& stop, Convert convert) {
  const auto peer = host.peer<Prx>(name, proxy);
  Ice::Long last_us = std::numeric_limits<Ice::Long>::min();
  while (!stop.stop_requested()) {
    const auto batch = peer->call([&](Prx& p) { return p.samplesSince(last_us); });
    if (!batch || batch->samples.empty()) {
      pause(batch ? kNothing : kAway, stop);
      continue;
    }
    for (const auto& sample : batch->samples) {
      convert(sample);
      host.status().count(name);
    }
    last_us = batch->samples.back().stampUs;
  }
}

void Streams::followOdometry(ComponentHost& host, const std::stop_token& stop) {
  followSamples<avm::OdometryPrx>(
      host, "Odometry", config_.odometry, stop,
      [emit = emitter()](const avm::OdometrySample& sample) { convertOdometry(sample, emit); });
}

void Streams::followPanTilt(ComponentHost& host, const std::stop_token& stop) {
  followSamples<avm::PanTiltPrx>(
      host, "PanTilt", config_.pan_tilt, stop,
      [emit = emitter()](const avm::PanTiltSample& sample) { convertPanTilt(sample, emit); });
}

void Streams::followTruth(ComponentHost& host, const std::stop_token& stop) {
  const auto peer = host.peer<avm::SimulationPrx>("Simulation", config_.simulation);
  TruthMessages messages;
  Ice::Long last_us = std::numeric_limits<Ice::Long>::min();
  while (!stop.stop_requested()) {
    const auto batch = peer->call([&](avm::SimulationPrx& p) { return p.truthSince(last_us); });
    if (!batch || batch->samples.empty()) {
      pause(batch ? kNothing : kAway, stop);
      continue;
    }
    for (const auto& sample : batch->samples) messages.convert(sample, emitter());
    last_us = batch->samples.back().stampUs;
  }
}

void Streams::followMemory(ComponentHost& host, const std::stop_token& stop) {
  const auto peer = host.peer<avm::VisualMemoryPrx>("VisualMemory", config_.memory);
  Ice::Long revision = 0;
  while (!stop.stop_requested()) {
    const auto result = peer->call([&](avm::VisualMemoryPrx& p) { return p.next(revision); });
    if (!result || result->state != avm::SourceState::Running) {
      pause(result ? kNothing : kAway, stop);
      continue;
    }
    revision = result->update.snapshot.revision;
    convertMemory(result->update, emitter());
    host.status().count("VisualMemory");
  }
}

void Streams::followLocalization(ComponentHost& host, const std::stop_token& stop) {
  const auto peer = host.peer<avm::LocalizationPrx>("Localization", config_.localization);
  Ice::Long revision = 0;
  while (!stop.stop_requested()) {
    const auto result = peer->call([&](avm::LocalizationPrx& p) { return p.next(revision); });
    if (!result || result->state != avm::SourceState::Running) {
      pause(result ? kNothing : kAway, stop);
      continue;
    }
    const avm::PoseEstimate& estimate = result->estimate;
    revision = estimate.revision;
    convertEstimate(estimate, emitter());
    service_.updateReliability(estimate.hasPose ? estimate.reliability : 0.0, estimate.stampUs);
    host.status().count("Localization");
  }
}

void Streams::followGaze(ComponentHost& host, const std::stop_token& stop) {
  const auto peer = host.peer<avm::GazePrx>("Gaze", config_.gaze);
  std::optional<Ice::Long> last_us;
  while (!stop.stop_requested()) {
    try {
      const auto status = peer->call([](avm::GazePrx& p) { return p.status(); });
      if (status && status->stampUs != last_us) convertGaze(*status, emitter());
      if (status) last_us = status->stampUs;
    } catch (const avm::NotAvailable&) {
      last_us.reset();  // it has seen no image yet
    }
    pause(kGazePeriod, stop);
  }
}

void Streams::followComponent(ComponentHost& host, const std::string& proxy, const std::stop_token& stop) {
  const std::string name = componentOfStatus(proxy.substr(0, proxy.find_first_of(": ")));
  const auto peer = host.peer<avm::ComponentPrx>(name, proxy);
  const milliseconds period(static_cast<int>(1e3 * config_.status_period_s));
  bool known = false;
  while (!stop.stop_requested()) {
    if (!peer->connected()) known = false;
    if (const auto status = peer->call([](avm::ComponentPrx& p) { return p.getStatus(); })) {
      convertComponent(*status, service_.newestStamp(), emitter());
      if (!known) {
        if (const auto settings = peer->call([](avm::ComponentPrx& p) { return p.getConfiguration(); })) {
          SessionFolder::Settings list;
          for (const avm::Setting& setting : *settings) list.emplace_back(setting.key, setting.value);
          known = true;
          try {
            session_.add(status->name, status->version, std::move(list));
          } catch (const RecordingError& error) {
            host.status().error(error.what());
          }
        }
      }
    }
    pause(period, stop);
  }
}

}  // namespace vismem
