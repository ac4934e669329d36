/// @file The threads around the memory: one per source, one that owns the pipeline, one that gives commands.
/// No Ice: any implementation of the ports will do. See M7, G3, A6.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "active_visual_memory/core/ground/camera_knock.h"
#include "active_visual_memory/core/memory_pipeline.h"
#include "common/process/status.h"
#include "common/robot/clock_watch.h"
#include "common/robot/observation.h"
#include "common/robot/ports.h"

namespace vismem {

/// Requests of gaze clients, from any thread to the perception loop. *Thread-safe.*
class SharedGazeClient final : public GazeClient {
 public:
  explicit SharedGazeClient(bool has_pan_tilt) : has_pan_tilt_(has_pan_tilt) {}

  PortReply setMode(GazeMode mode) override {
    return guarded(mode == GazeMode::kOff, [&] { return queue_.setMode(mode); });
  }
  PortReply fixate(const Eigen::Vector3d& p_odom) override {
    return guarded(false, [&] { return queue_.fixate(p_odom); });
  }
  PortReply request(const GazeRequest& request) override {
    return guarded(false, [&] { return queue_.request(request); });
  }
  PortReply withdraw(const std::string& client, const std::string& key) override {
    return guarded(true, [&] { return queue_.withdraw(client, key); });
  }
  std::optional<GazeStatus> status() override {
    const std::scoped_lock lock(mutex_);
    return queue_.status();
  }

  std::vector<GazeRequestQueue::Item> take() {
    const std::scoped_lock lock(mutex_);
    return queue_.take();
  }
  void publish(const GazeStatus& status, const Eigen::Vector2d& p_odom_robot) {
    const std::scoped_lock lock(mutex_);
    queue_.publish(status, p_odom_robot);
  }

 private:
  /// @param without_unit whether `call` makes sense without a pan-tilt unit.
  template <typename Call>
  PortReply guarded(bool without_unit, Call call) {
    if (!has_pan_tilt_ && !without_unit) return PortReply::rejected("no pan-tilt unit is configured");
    const std::scoped_lock lock(mutex_);
    return call();
  }

  const bool has_pan_tilt_;
  std::mutex mutex_;
  GazeRequestQueue queue_;
};

/// *Thread-safe*: start and stop from one thread, reset from any.
class PerceptionLoop {
 public:
  struct Params {
    ObservationAssembler::Params assembler;
    MemoryPipelineParams pipeline;
    bool every_frame = false;
    double images_lost_s = 0.5;
    double calibrated_tilt_rad =
        0.0;  ///< standard deviation of the calibrated camera tilt; 0: not calibrated
  };

  /// Result of one observation. Called by the owner thread; must not block.
  using Consumer = std::function<void(const RobotObservation&, const AttentiveVisualMemory::StepResult&)>;
  /// No usable image: none comes, no odometry covers it, or the source is finished.
  using NoImages = std::function<void(SourceState, const std::string& why)>;
  /// A thread ended with an exception.
  using Failed = std::function<void(std::exception_ptr)>;

  /// @param pan_tilt null: no unit. All ports outlive stop().
  PerceptionLoop(const Params& params, std::shared_ptr<const Palette> palette, FrameSource& camera,
                 PanTiltUnit* pan_tilt, MobileBase& base, SharedGazeClient& gaze, StatusBoard& status);
  ~PerceptionLoop() { stop(); }

  void start(Consumer consumer, NoImages no_images, Failed failed);
  /// Ends all threads; returns when they have ended.
  void stop();
  /// Drops the memory before the next image.
  void reset();
  /// Has the owner thread change the pipeline before the next image. @return rejected: too many changes wait.
  PortReply change(std::function<void(MemoryPipeline&)> change);

 private:
  using Clock = std::chrono::steady_clock;

  /// Input since the last iteration.
  struct Inbox {
    std::deque<Frame> frames;
    std::vector<PanTiltSample> pan_tilt_samples;
    std::vector<OdometrySample> odometry_samples;
    bool reset_wanted = false;
    std::vector<std::function<void(MemoryPipeline&)>> changes;
    SourceState camera_state = SourceState::kWaiting;
    std::string camera_message = "no image yet";
  };
  struct Clocks {
    ClockWatch camera;
    ClockWatch odometry;
  };

  void startThread(std::function<void(const std::stop_token&)> work);
  /// Runs a port until it is to stop. @param take  takes what is new into the inbox; returns whether there
  /// was any.
  template <typename Port, typename Take>
  void read(const std::stop_token& stop, const char* name, Port& port, Take take);
  bool takeFrame();
  template <typename Port, typename Sample>
  void readSamples(const std::stop_token& stop, const char* name, Port& port, std::vector<Sample>& inbox);
  void run(const std::stop_token& stop);
  Inbox takeInbox(const std::stop_token& stop);
  /// @return whether there was an observation.
  bool processAll(ObservationAssembler& assembler, MemoryPipeline& pipeline);
  /// Gauges of the camera tilt: mount roll, mount pitch, camera pitch, camera roll, and their sum, with a
  /// note when a calibrated camera was knocked.
  void reportCameraTilt(const AttentiveVisualMemory& memory);
  /// Gauges of the light and of edges whose colours are no pair of the palette, with a note when the light
  /// changes.
  void reportLight(const LightEstimator& light);
  /// Reports that there is no usable image, once for each state and reason.
  void reportNoImages(const Inbox& inbox, bool frames_come, const ObservationAssembler& assembler);
  void checkClocks(const Inbox& inbox, Clocks& clocks);
  void send(const PanTiltCommand& command);
  void giveCommands(const std::stop_token& stop);

  const Params params_;
  FrameSource& camera_;
  PanTiltUnit* const pan_tilt_;
  MobileBase& base_;
  SharedGazeClient& gaze_;
  StatusBoard& status_;
  MemoryPipeline pipeline_;
  Consumer consumer_;
  NoImages no_images_;
  Failed failed_;

  std::mutex inbox_mutex_;
  std::condition_variable_any inbox_filled_;
  Inbox inbox_;

  std::mutex command_mutex_;
  std::condition_variable_any command_given_;
  std::optional<PanTiltCommand> command_;

  // Of the owner thread.
  std::optional<std::pair<SourceState, std::string>> blind_;  ///< what was reported; empty while images come
  std::string unusable_;  ///< why the last image could not be used; empty if it could
  std::uint32_t epoch_ = 0;
  KnockAlarm knock_alarm_;
  std::string light_;  ///< as it was described last

  std::vector<std::jthread> threads_;  ///< last member: ends before the rest goes
};

}  // namespace vismem
