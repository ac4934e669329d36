/// @file A simulation that runs by the clock on a thread of its own, with ports for any thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "common/robot/control_ports.h"
#include "simulator/core/simulation.h"

namespace vismem {

/// Owns a Simulation and gives it to one thread, which steps it at `speed` simulated seconds per second, or
/// as fast as it can where that is too much (SimulationStatus::real_speed tells). Commands go to that thread
/// through a bounded queue and are answered when they are done; frames and samples are published.
/// *Thread-safe* between start() and stop(); the ports live as long as this.
class RealTimeSimulation : public SimulationControl {
 public:
  struct Hooks {
    std::function<void()> on_frame;                      ///< after each frame; must not block
    std::function<void(std::exception_ptr)> on_failure;  ///< the loop has ended by this
  };

  RealTimeSimulation(SimulationConfig config, double speed, Hooks hooks);
  ~RealTimeSimulation() override;

  void start();
  /// Ends the loop and answers everyone who waits.
  void stop();

  FrameSource& camera();
  PanTiltUnit& panTilt();
  MobileBase& base();

  SimulationStatus status() const override;
  SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  PortReply kidnap(const Pose2& T_world_robot) override;
  PortReply pause() override;
  PortReply resume() override;
  PortReply setSpeed(double speed) override;

 private:
  class CameraPort;
  class PanTiltPort;
  class BasePort;
  using Clock = std::chrono::steady_clock;
  using Command = std::packaged_task<PortReply(Simulation&)>;

  /// Runs a command on the simulation's thread and waits for its answer.
  PortReply execute(std::function<PortReply(Simulation&)> work);
  void loop(const std::stop_token& stop);
  /// One round: commands, steps up to the clock, the frame due. @return when the next round is due.
  Clock::time_point advance();
  void runCommands();
  void publishSamples();
  void measureSpeed(Clock::time_point now);

  template <typename Sample>
  SampleBatch<Sample> since(const std::deque<Sample>& ring, StampUs after_us,
                            std::chrono::milliseconds timeout);

  const Hooks hooks_;
  std::unique_ptr<Simulation> simulation_;  ///< of the loop's thread once started
  std::unique_ptr<CameraPort> camera_;
  std::unique_ptr<PanTiltPort> pan_tilt_;
  std::unique_ptr<BasePort> base_;

  // Of the loop's thread: at `origin_wall_` simulated time was `origin_us_`.
  Clock::time_point origin_wall_;
  StampUs origin_us_ = 0;
  Clock::time_point measured_wall_;
  StampUs measured_us_ = 0;
  bool clock_changed_ = true;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_loop_;
  std::condition_variable published_;
  bool running_ = false;
  std::deque<Command> commands_;
  SimulationStatus status_;
  std::optional<Frame> frame_;
  std::deque<PanTiltSample> pan_tilt_samples_;
  std::deque<OdometrySample> odometry_samples_;
  std::deque<TruthSample> truth_samples_;

  std::jthread thread_;  ///< last: ends before the rest goes
};

}  // namespace vismem
