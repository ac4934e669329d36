/// @file The simulated robot in its world, in lock-step: time moves only when told to. DESIGN 6.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/kinematics/kinematics.h"
#include "common/kinematics/random_stream.h"
#include "common/robot/control_ports.h"
#include "common/robot/ports.h"
#include "simulator/core/world.h"

namespace vismem {

class Renderer;

struct SimulationConfig {
  World world;
  std::uint64_t seed = 1;
  Pose2 start;
  double camera_rate_hz = 30.0;
  CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  CameraMount mount;         ///< default: at 0.45 m above the robot's origin
  double image_noise = 2.0;  ///< standard deviation [grey levels]
  BaseParams base;
  PanTiltParams pan_tilt;
  OdometryErrorParams odometry = defaultOdometryError();

  SimulationConfig();
};

/// One robot in one world. Time starts at 0 and moves in steps of 10 ms. *Single-threaded*: a process gives
/// it to one thread. Its ports are valid as long as it lives; their waits return at once.
class Simulation : public SteppedRobot {
 public:
  static constexpr StampUs kStep_us = 10'000;

  /// @throws std::invalid_argument for unusable intrinsics or rates, or a start inside an obstacle.
  explicit Simulation(SimulationConfig config);
  ~Simulation() override;

  bool advanceToNextFrame() override;
  FrameSource& camera() override;
  PanTiltUnit& panTilt() override;
  MobileBase& base() override;

  /// One step of 10 ms.
  void step();
  StampUs now() const { return now_us_; }
  TruthSample truth() const;
  /// The truth of every step that is newer, of the last 5 s, oldest first.
  std::vector<TruthSample> truthSince(StampUs after_us) const;
  /// As many steps of 10 ms as reach now() + dt or go just past it. For the real-time process and tests.
  void advance(StampUs dt_us);
  /// Puts the robot elsewhere; its odometry notices nothing. Rejected inside an obstacle or if not finite.
  PortReply kidnap(const Pose2& T_world_robot);
  /// True when a frame fell due since the last one was taken.
  bool frameDue() const { return due_frame_.has_value(); }
  /// Renders the newest frame due; empty if none is.
  std::optional<Frame> takeFrame();

  const SimulationConfig& config() const { return config_; }
  const Renderer& renderer() const { return *renderer_; }

 private:
  class CameraPort;
  class PanTiltPort;
  class BasePort;

  /// What a frame will show, remembered when it falls due, rendered when taken.
  struct DueFrame {
    StampUs stamp_us;
    std::uint64_t seq;
    Pose3 T_world_camera;
  };

  void addNoise(cv::Mat& image, std::uint64_t seq) const;

  SimulationConfig config_;
  std::unique_ptr<Renderer> renderer_;
  SimulatedBase base_;
  SimulatedOdometry odometry_;
  SimulatedPanTilt pan_tilt_;
  StampUs now_us_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t frames_ = 0;
  std::uint32_t kidnaps_ = 0;
  std::optional<DueFrame> due_frame_;
  std::deque<PanTiltSample> pan_tilt_samples_;
  std::deque<OdometrySample> odometry_samples_;
  std::deque<TruthSample> truth_samples_;
  std::vector<std::int8_t> noise_;
  std::unique_ptr<CameraPort> camera_port_;
  std::unique_ptr<PanTiltPort> pan_tilt_port_;
  std::unique_ptr<BasePort> base_port_;
};

}  // namespace vismem
