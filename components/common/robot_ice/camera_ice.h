/// @file A camera over Ice: broadcaster and servant of a FrameSource, and a client that implements
/// FrameSource.
#pragma once

#include <avm/camera.h>

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/robot/ports.h"
#include "common/robot_ice/frame_codec.h"
#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/remote.h"

namespace vismem {

/// Sends the newest frame to any number of clients. Frames come from a source on a thread of its own (start),
/// or from calls of publish. *Thread-safe.*
class FrameBroadcaster {
 public:
  using Latest = LatestValue<EncodedFrame>;
  /// Called with the source's answer to each request, before it is published; on the pump's thread.
  using Watch = std::function<void(const FrameResult&)>;

  explicit FrameBroadcaster(int jpeg_quality = 85) : jpeg_quality_(jpeg_quality) {}
  ~FrameBroadcaster() { stop(); }

  /// Pumps a source that was configured and started; it must outlive stop(). Its capabilities are read at the
  /// start and with its first frame. `watch` connects the source to the server's status.
  void start(FrameSource& source, Watch watch = {});
  /// Ends the pump and answers all waiting and later requests at once. The source keeps its state.
  void stop();

  /// Answers waiting requests, then encodes the formats that JdeRobot's clients are expected to request
  /// (expect).
  void publish(Frame frame);
  /// Registers the format of a client that does not wait. The next frames are encoded in it ahead, so that
  /// encoding and checksum do not delay the request.
  void expect(FrameFormat format);
  void setState(SourceState state, std::string message) { latest_.setState(state, std::move(message)); }
  /// Sets the capabilities; required before the first client if there is no source.
  void setCapabilities(FrameCapabilities capabilities);
  FrameCapabilities capabilities() const;

  Latest& latest() { return latest_; }
  /// Number of waiting clients.
  std::size_t waiting() const { return latest_.waiting(); }
  /// Called whenever waiting() or published() has risen, on any thread. To be set before start().
  void onConsumers(std::function<void()> changed);
  /// Number of published frames; all clients that waited for them have been answered.
  std::uint64_t published() const { return published_; }

 private:
  void pump(FrameSource& source, const Watch& watch, const std::stop_token& stop);

  int jpeg_quality_;
  mutable std::mutex mutex_;
  FrameCapabilities capabilities_;
  std::atomic<std::uint64_t> published_ = 0;
  /// By format: number of further frames that are encoded ahead.
  std::array<std::atomic<int>, 4> expected_{};
  std::function<void()> consumers_changed_;
  Latest latest_{"no frame yet"};
  std::jthread thread_;  ///< last member: joined before the others are destroyed
};

/// Serves avm::Camera and with it jderobot::Camera. *Thread-safe*; the broadcaster must outlive the adapter.
class CameraServant : public avm::Camera {
 public:
  /// @param name JdeRobot's name of the camera: by custom its identity.
  CameraServant(FrameBroadcaster& broadcaster, std::string name)
      : broadcaster_(broadcaster), name_(std::move(name)) {}

  void getNextAsync(std::string format, Ice::Long last_sequence,
                    std::function<void(const avm::FrameResult&)> response,
                    std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CameraInfo getInfo(const Ice::Current&) override;

  /// Describes the newest image as RGB8; before the first, the nominal size without md5sum.
  std::shared_ptr<jderobot::ImageDescription> getImageDescription(const Ice::Current&) override;
  jderobot::ImageFormat getImageFormat(const Ice::Current&) override;
  /// The newest image, of any age; timeStamp has its stamp.
  std::shared_ptr<jderobot::ImageData> getImageData(std::string format, const Ice::Current&) override;
  /// Focal lengths, principal point and, for a source with a pose, position, aim and roll. JdeRobot has no
  /// fields for distortion; see avm::Frame::cameraModel.
  std::shared_ptr<jderobot::CameraDescription> getCameraDescription(const Ice::Current&) override;
  /// Returns -1, refused: configuration and source define the description.
  int setCameraDescription(std::shared_ptr<jderobot::CameraDescription>, const Ice::Current&) override;
  /// Empty: frames are requested, not streamed.
  std::string startCameraStreaming(const Ice::Current&) override;
  /// Nothing to stop.
  void stopCameraStreaming(const Ice::Current&) override {}
  /// No effect: the servant has no state, and a failed source recovers by itself.
  void reset(const Ice::Current&) override {}

 private:
  using Deadline = std::chrono::steady_clock::time_point;
  void answerNext(FrameFormat format, std::optional<std::int64_t> have, Deadline deadline,
                  std::function<void(const avm::FrameResult&)> response,
                  std::function<void(std::exception_ptr)> exception);

  FrameBroadcaster& broadcaster_;
  std::string name_;
};

/// A remote camera as a port. An absent server gives kWaiting with the reason. After its return frames
/// continue, also with sequence numbers that restart. One consumer.
class RemoteFrameSource : public FrameSource {
 public:
  /// @param proxy need not be reachable; null: never delivers.
  /// @param format format on the wire; RGB8 needs no conversion.
  explicit RemoteFrameSource(const std::shared_ptr<avm::CameraPrx>& proxy,
                             FrameFormat format = FrameFormat::kRgb8, LinkReport report = {});

  /// The last capabilities from the server; without sizes before it was reached.
  FrameCapabilities capabilities() const override;
  /// The server decides: accepted if its known capabilities match the request, otherwise adjusted.
  PortReply configure(const FrameRequest& request) override;
  /// Waits up to a second for the server; accepted even without it.
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  /// Stops this client only; next() returns kWaiting until start(). Any thread; a waiting next() ends within
  /// 0.1 s.
  void stop() override { stopped_ = true; }

 private:
  std::shared_ptr<avm::CameraPrx> proxy_;
  FrameFormat format_;
  std::int64_t last_seq_ = -1;
  std::atomic<bool> stopped_ = false;
  std::string nothing_yet_ = "no frame yet";  ///< the last reason from the server
  PendingCall<avm::FrameResult> frames_;
  mutable AskedValue<avm::CameraInfo> info_;
};

}  // namespace vismem
