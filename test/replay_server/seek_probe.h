/// @file Seeks in a replay_server over Ice, as a client sees it.
#pragma once

#include <avm/base.h>
#include <avm/camera.h>
#include <avm/pantilt.h>
#include <avm/replay.h>

#include <chrono>
#include <limits>
#include <memory>

#include "support/ice_client.h"

namespace vismem {

/// Stamps of the newest sample of each sensor [us].
struct SensorStamps {
  Ice::Long image = 0;
  Ice::Long odometry = 0;
  Ice::Long joints = 0;
  bool operator==(const SensorStamps&) const = default;
};

/// A client of all sensors of one replay_server, which is paused.
class SeekProbe {
 public:
  explicit SeekProbe(const ComponentProcess& server)
      : replay_(ice_.find<avm::ReplayPrx>(server, "Replay")),
        camera_(ice_.find<avm::CameraPrx>(server, "cameraA")),
        odometry_(ice_.find<avm::OdometryPrx>(server, "Encoders")),
        pan_tilt_(ice_.find<avm::PanTiltPrx>(server, "PanTilt")) {}

  struct Landing {
    double seconds = 0.0;  ///< from the command until all sensors were where they should be
    Ice::Long position_us = 0;
    SensorStamps sensors;
    avm::Frame image;
  };

  /// Seeks and asks all sensors until they stand at the expected stamps, or for `patience`.
  Landing seek(Ice::Long stamp_us, const SensorStamps& expected,
               std::chrono::seconds patience = std::chrono::seconds(5)) {
    const auto began = std::chrono::steady_clock::now();
    replay_->seek(stamp_us);
    Landing landing;
    do {
      const avm::FrameResult result = camera_->getNext("RGB8", last_seq_);
      if (result.state == avm::SourceState::Running) {
        landing.image = result.image;
        landing.sensors.image = result.image.stampUs;
        last_seq_ = result.image.seq;
      }
    } while (landing.sensors.image != expected.image && std::chrono::steady_clock::now() - began < patience);
    do {
      landing.sensors.odometry = newest(*odometry_);
      landing.sensors.joints = newest(*pan_tilt_);
    } while (landing.sensors != expected && std::chrono::steady_clock::now() - began < patience);
    landing.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    landing.position_us = replay_->info().stampUs;
    return landing;
  }
  avm::ReplayPrx& replay() { return *replay_; }

 private:
  template <typename Prx>
  static Ice::Long newest(Prx& proxy) {
    const auto batch = proxy.samplesSince(std::numeric_limits<Ice::Long>::min());
    return batch.samples.empty() ? 0 : batch.samples.back().stampUs;
  }

  IceClient ice_;
  const std::shared_ptr<avm::ReplayPrx> replay_;
  const std::shared_ptr<avm::CameraPrx> camera_;
  const std::shared_ptr<avm::OdometryPrx> odometry_;
  const std::shared_ptr<avm::PanTiltPrx> pan_tilt_;
  Ice::Long last_seq_ = -1;
};

}  // namespace vismem
