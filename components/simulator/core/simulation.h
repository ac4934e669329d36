/// @file The simulated robot in its world, in lock-step: time moves only when told to. DESIGN 6.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/kinematics/kinematics.h"
#include "common/kinematics/random_stream.h"
#include "common/robot/control_ports.h"
#include "common/robot/ports.h"
#include "simulator/core/humanoid.h"
#include "simulator/core/renderer.h"
#include "simulator/core/scenario.h"
#include "simulator/core/scene.h"
#include "simulator/core/simulated_camera.h"
#include "simulator/core/world.h"

namespace vismem {

struct SimulationConfig {
  World world;
  std::uint64_t seed = 1;
  Pose2 start;
  /// Where the axes of the pan-tilt unit (of a humanoid: of its neck) cross; default 0.45 m above the origin.
  Pose3 T_robot_pantilt;
  std::vector<SimulatedCameraParams> cameras{1};  ///< the first is camera(); names must differ
  BaseParams base;
  /// Set: a humanoid that walks; empty: wheels.
  std::optional<WalkParams> walk;
  PanTiltParams pan_tilt;
  OdometryErrorParams odometry = defaultOdometryError();
  RendererOptions rendering;

  SimulationConfig();
  /// Where the robot believes that a camera on its head sits.
  CameraMount mount(std::size_t camera = 0) const;
};

/// A humanoid of the size of a Nao: a neck with a Nao's limits, a camera 6 cm above and ahead of it at a
/// height of about 0.45 m, whose frames carry the pose that its kinematics believe, slow steps, odometry that
/// slips with the feet. No latency and no calibration error: those are said where they are wanted.
SimulationConfig humanoidSimulation();

/// One robot in one world. Time starts at 0 and moves in steps of 10 ms. The same configuration, seed and
/// commands give the same trajectories and images, however many threads render. *Single-threaded*: a process
/// gives it to one thread. Its ports are valid as long as it lives; their waits return at once.
class Simulation : public SteppedRobot {
 public:
  static constexpr StampUs kStep_us = 10'000;

  /// @throws std::invalid_argument for unusable cameras, or a start inside an obstacle.
  explicit Simulation(SimulationConfig config);
  ~Simulation() override;

  /// Moves to the delivery of the next frame of the first camera that was not announced before.
  bool advanceToNextFrame() override;
  FrameSource& camera() override { return camera(0); }
  FrameSource& camera(std::size_t index);
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
  /// Everything from the beginning, at time 0, with another seed; the scenario too, models that were added
  /// go.
  void reset(std::uint64_t seed);

  /// Puts the robot elsewhere; its odometry notices nothing. Rejected inside an obstacle or if not finite.
  PortReply kidnap(const Pose2& T_world_robot);
  /// The encoders count this much more than the robot goes, over the next 100 ms. Within 1 m.
  PortReply slip(const WheelTravel& extra);
  /// Plays a scenario from now on, instead of the one before. Rejected if it names models that are not there.
  PortReply play(Scenario scenario);
  void stopScenario();
  /// What of the scenario could not be done since this was asked last: FILE:LINE and why.
  std::vector<std::string> takeScenarioProblems();
  /// Speeds of a scenario's driver; whoever commands the base over its port takes over from him.
  void driveByScenario(double v_mps, double w_radps);
  /// Models may be added, removed, moved and made to walk between steps.
  MovingWorld& scene() { return scene_; }

  /// True when a frame has arrived since the last one was taken.
  bool frameDue(std::size_t camera = 0) const;
  /// Renders the newest frame that has arrived; empty if none has.
  std::optional<Frame> takeFrame(std::size_t camera = 0);
  /// The same without rendering it, for whoever makes up what the camera sees: renderer() shows the scene of
  /// its moment afterwards.
  std::optional<ExposedFrame> takeExposure(std::size_t camera = 0);
  /// The exposure of the frame taken last of a camera, for experiments: its true pose. Empty before the first.
  const std::optional<ExposedFrame>& lastExposure(std::size_t camera = 0) const { return taken_.at(camera); }
  /// What is really seen in the frame taken last of a camera; empty before the first.
  std::optional<TruthImages> truthImages(std::size_t camera = 0);
  /// True pose of a camera now, for experiments.
  Pose3 truePoseOfCamera(std::size_t camera = 0) const;

  const SimulationConfig& config() const { return config_; }
  const Renderer& renderer() const { return *renderer_; }

 private:
  class CameraPort;
  class PanTiltPort;
  class BasePort;

  /// What moves cameras, at one instant.
  struct Carriers {
    Pose2 T_world_robot;
    BodyPosture posture;
    PanTilt neck;
  };
  Carriers carriers() const;
  Pose3 truePose(const SimulatedCameraParams& camera, const Carriers& at) const;
  Pose3 believedPose(const SimulatedCameraParams& camera, const Carriers& at) const;
  void begin();
  void expose(const Carriers& before, const Carriers& after);
  /// The base learns of models that came, went or moved.
  void noticeObstacles();
  void showScene(const ExposedFrame& frame);

  SimulationConfig config_;
  std::unique_ptr<Renderer> renderer_;
  SceneState shown_;  ///< by the renderer
  MovingWorld scene_;
  std::uint64_t scene_revision_ = 0;
  SimulatedBase base_;
  std::optional<HumanoidWalk> walk_;
  SimulatedOdometry odometry_;
  SimulatedPanTilt pan_tilt_;
  std::vector<SimulatedCamera> cameras_;
  std::vector<std::optional<ExposedFrame>> taken_;
  std::optional<Scenario> scenario_;  ///< as it began, for a reset
  std::unique_ptr<class ScenarioPlayer> player_;
  std::vector<std::string> scenario_problems_;
  StampUs now_us_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t announced_ = 0;  ///< frames of the first camera that advanceToNextFrame() reached
  std::uint32_t kidnaps_ = 0;
  std::optional<StampUs> commanded_us_;  ///< last command over the base's port
  std::deque<PanTiltSample> pan_tilt_samples_;
  std::deque<OdometrySample> odometry_samples_;
  std::deque<TruthSample> truth_samples_;
  std::vector<std::unique_ptr<CameraPort>> camera_ports_;
  std::unique_ptr<PanTiltPort> pan_tilt_port_;
  std::unique_ptr<BasePort> base_port_;
};

}  // namespace vismem
