/// @file A simulation in real time on a thread of its own, with ports for any thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/robot/control_ports.h"
#include "simulator/core/simulation.h"

namespace vismem {

/// Owns a Simulation on one thread, which steps it at `speed` simulated seconds per second. A slower machine
/// runs at its own maximum; SimulationStatus::real_speed reports the reached speed. In lock-step it advances
/// to the next frame of the first camera as soon as all consumers wait for it. Commands go to that thread
/// through a bounded queue and are answered after their execution; frames and samples are published.
/// *Thread-safe* between start() and stop(); the ports live as long as this.
class RealTimeSimulation : public SimulationControl {
 public:
  struct Hooks {
    std::function<void()> on_round;                      ///< ten times a second at least; must not block
    std::function<void()> on_frame;                      ///< after each frame; must not block
    std::function<void(std::exception_ptr)> on_failure;  ///< the loop has ended by this
    std::function<void(const std::string&)> on_problem;  ///< an event of a scenario that failed
    /// Lock-step: number of consumers that have received all of the first camera's `frames` and wait for
    /// another. Called after consumersChanged(); must not block.
    std::function<int(std::uint64_t frames)> consumers_waiting;
  };

  /// One stream of images: of a camera, or the ground truth beside it.
  enum class OutputKind { kImage, kDepth, kObjects };

  RealTimeSimulation(SimulationConfig config, double speed, Hooks hooks);
  ~RealTimeSimulation() override;

  /// To be called before start(): a scenario to play from time 0. Rejected if it names unknown models.
  PortReply prepareScenario(Scenario scenario);
  void start();
  /// Ends the loop and answers all waiting requests.
  void stop();

  /// Lock-step: another consumer waits, or frames have arrived. Any thread.
  void consumersChanged();

  FrameSource& camera() { return output(0); }
  /// Images of all cameras in their order, each followed by its ground truth where it is configured.
  std::size_t outputs() const { return outputs_.size(); }
  FrameSource& output(std::size_t index);
  /// The camera's name, with /depth or /objects for ground truth.
  std::string outputName(std::size_t index) const;
  PanTiltUnit& panTilt();
  /// Crossing point of the pan-tilt axes on the robot [m].
  Eigen::Vector3d panTiltPosition() const;
  MobileBase& base();

  SimulationStatus status() const override;
  SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  PortReply kidnap(const Pose2& T_world_robot) override;
  PortReply pause() override;
  PortReply resume() override;
  PortReply setSpeed(double speed) override;
  PortReply step(int steps) override;
  PortReply setLockStep(int consumers) override;
  PortReply reset(std::uint64_t seed) override;
  std::vector<ModelStatus> models() override;
  PortReply addModel(const std::string& name, const PropShape& shape, const Pose3& T_world_model) override;
  PortReply removeModel(const std::string& name) override;
  PortReply placeModel(const std::string& name, const Pose3& T_world_model) override;
  PortReply walkModel(const std::string& name, const Way& way) override;
  PortReply standModel(const std::string& name) override;
  PortReply slip(double left_m, double right_m) override;
  PortReply playScenario(const std::string& text) override;

 private:
  class OutputPort;
  class PanTiltPort;
  class BasePort;
  using Clock = std::chrono::steady_clock;
  using Command = std::packaged_task<PortReply(Simulation&)>;

  /// Runs a command on the simulation's thread and waits for its answer.
  PortReply execute(std::function<PortReply(Simulation&)> work);
  void loop(const std::stop_token& stop);
  /// One round: commands, steps, the frames due.
  /// @return when the next round is due.
  Clock::time_point advance();
  /// As advance, in real time, and in lock-step with the consumers of images.
  Clock::time_point advanceByClock(Clock::time_point now, double speed);
  Clock::time_point advanceInLockStep(Clock::time_point now, int consumers);
  void setOrigin(Clock::time_point now);
  void runCommands();
  void publishFrames();
  void publishSamples();
  void measureSpeed(Clock::time_point now);

  /// @param stopped of the port that asks; guarded by the mutex.
  template <typename Sample>
  SampleBatch<Sample> since(const std::deque<Sample>& ring, StampUs after_us,
                            std::chrono::milliseconds timeout, const bool* stopped = nullptr);
  void setStopped(bool& stopped, bool value);

  const Hooks hooks_;
  std::unique_ptr<Simulation> simulation_;  ///< of the loop's thread once started
  std::vector<std::unique_ptr<OutputPort>> outputs_;
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
  bool consumers_changed_ = false;
  std::deque<Command> commands_;
  SimulationStatus status_;
  std::vector<std::optional<Frame>> frames_;  ///< by output: the newest undelivered one
  std::uint64_t given_out_ = 0;               ///< frames of the first camera
  std::deque<PanTiltSample> pan_tilt_samples_;
  std::deque<OdometrySample> odometry_samples_;
  std::deque<TruthSample> truth_samples_;

  std::jthread thread_;  ///< last: ends before the rest goes
};

}  // namespace vismem
