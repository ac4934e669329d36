/// @file A camera over Ice: the broadcaster and servant over any FrameSource, and the client, which is one
/// again.
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

/// Gives the newest frame to any number of clients. Frames come from a source on a thread of its own (start),
/// or from whoever makes them (publish). *Thread-safe.*
class FrameBroadcaster {
 public:
  using Latest = LatestValue<EncodedFrame>;
  /// Told what the source answered to each request, before it is published; on the pump's thread.
  using Watch = std::function<void(const FrameResult&)>;

  explicit FrameBroadcaster(int jpeg_quality = 85) : jpeg_quality_(jpeg_quality) {}
  ~FrameBroadcaster() { stop(); }

  /// Pumps a source that was configured and started; it must outlive stop(). Its capabilities are read at the
  /// start and with its first frame. `watch` is how a server's status learns of the source.
  void start(FrameSource& source, Watch watch = {});
  /// Ends the pump, answers all waiting requests and all later ones at once. The source is left as it is.
  void stop();

  /// Answers those who wait for a frame, then makes what JdeRobot's clients may ask for next (expect).
  void publish(Frame frame);
  /// A client that does not wait asked for this format: that of the next frames is made before it is asked
  /// for, so that its encoding and checksum are no part of the request.
  void expect(FrameFormat format);
  void setState(SourceState state, std::string message) { latest_.setState(state, std::move(message)); }
  /// What the camera says of itself; to be set before clients come where there is no source.
  void setCapabilities(FrameCapabilities capabilities);
  FrameCapabilities capabilities() const;

  Latest& latest() { return latest_; }
  /// Clients that wait for a frame newer than theirs.
  std::size_t waiting() const { return latest_.waiting(); }
  /// Frames so far; whoever waited for one of them has been answered.
  std::uint64_t published() const { return published_; }

 private:
  void pump(FrameSource& source, const Watch& watch, const std::stop_token& stop);

  int jpeg_quality_;
  mutable std::mutex mutex_;
  FrameCapabilities capabilities_;
  std::atomic<std::uint64_t> published_ = 0;
  /// By format: for how many frames more it is made ahead.
  std::array<std::atomic<int>, 4> expected_{};
  Latest latest_{"no frame yet"};
  std::jthread thread_;  ///< last member: ends before the rest goes
};

/// avm::Camera and with it jderobot::Camera. *Thread-safe*; the broadcaster must outlive the adapter.
class CameraServant : public avm::Camera {
 public:
  /// @param name JdeRobot's name of the camera: by custom its identity.
  CameraServant(FrameBroadcaster& broadcaster, std::string name)
      : broadcaster_(broadcaster), name_(std::move(name)) {}

  void getNextAsync(std::string format, Ice::Long last_sequence,
                    std::function<void(const avm::FrameResult&)> response,
                    std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CameraInfo getInfo(const Ice::Current&) override;

  /// Of the newest image as RGB8; before the first its nominal size and no md5sum.
  std::shared_ptr<jderobot::ImageDescription> getImageDescription(const Ice::Current&) override;
  jderobot::ImageFormat getImageFormat(const Ice::Current&) override;
  /// The newest image, however old it is: its timeStamp tells.
  std::shared_ptr<jderobot::ImageData> getImageData(std::string format, const Ice::Current&) override;
  /// Focal lengths, principal point and, where the source knows its pose, position, aim and roll. JdeRobot
  /// has no fields for distortion: avm::Frame::cameraModel has it.
  std::shared_ptr<jderobot::CameraDescription> getCameraDescription(const Ice::Current&) override;
  /// -1, refused: the description is what configuration and source say.
  int setCameraDescription(std::shared_ptr<jderobot::CameraDescription>, const Ice::Current&) override;
  /// Empty: frames are asked for, not streamed.
  std::string startCameraStreaming(const Ice::Current&) override;
  /// Nothing to stop.
  void stopCameraStreaming(const Ice::Current&) override {}
  /// Nothing to set back: the servant keeps no state, and a source that fails is brought back by itself.
  void reset(const Ice::Current&) override {}

 private:
  using Deadline = std::chrono::steady_clock::time_point;
  void answerNext(FrameFormat format, std::optional<std::int64_t> have, Deadline deadline,
                  std::function<void(const avm::FrameResult&)> response,
                  std::function<void(std::exception_ptr)> exception);

  FrameBroadcaster& broadcaster_;
  std::string name_;
};

/// A remote camera as a port. A server that is away gives kWaiting with the reason; its return is noticed by
/// itself, sequence numbers that begin anew included. One consumer.
class RemoteFrameSource : public FrameSource {
 public:
  /// @param proxy need not be reachable; null: never delivers. @param format what travels; RGB8 costs no
  /// time.
  explicit RemoteFrameSource(const std::shared_ptr<avm::CameraPrx>& proxy,
                             FrameFormat format = FrameFormat::kRgb8, LinkReport report = {});

  /// As the server said last; without sizes before it was reached.
  FrameCapabilities capabilities() const override;
  /// The server decides: accepted when it is known to give what is asked for, otherwise adjusted.
  PortReply configure(const FrameRequest& request) override;
  /// Waits up to a second for the server; accepted even without it.
  PortReply start() override;
  FrameResult next(std::chrono::milliseconds timeout) override;
  /// The server goes on; next() gives nothing until start(). Any thread; a waiting next() ends within 0.1 s.
  void stop() override { stopped_ = true; }

 private:
  std::string askInfo(std::chrono::milliseconds timeout) const;

  std::shared_ptr<avm::CameraPrx> proxy_;
  FrameFormat format_;
  std::int64_t last_seq_ = -1;
  std::atomic<bool> stopped_ = false;
  std::string nothing_yet_ = "no frame yet";  ///< as the server explained it last
  PendingCall<avm::FrameResult> frames_;
  mutable PendingCall<avm::CameraInfo> infos_;
  mutable std::mutex mutex_;
  mutable std::optional<avm::CameraInfo> info_;
};

}  // namespace vismem
