/// @file The simulated robot in its world with stepped time.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/kinematics/calibrated_ports.h"
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
  /// Crossing point of the axes of the pan-tilt unit or of the humanoid's neck; default 0.45 m above the
  /// origin.
  Pose3 T_robot_pantilt;
  std::vector<SimulatedCameraParams> cameras{1};  ///< the first is camera(); names must differ
  BaseParams base;
  /// Set: a humanoid that walks; empty: wheels.
  std::optional<WalkParams> walk;
  PanTiltParams pan_tilt;
  OdometryErrorParams odometry = defaultOdometryError();
  /// What would correct the angles and stamps of the joints that the robot reports, and its wheels.
  JointCorrection joints;
  WheelCorrectionParams wheels;
  RendererOptions rendering;

  SimulationConfig();
  /// Mounting of a camera according to the robot's calibration.
  CameraMount mount(std::size_t camera = 0) const;
};

/// A humanoid of the size of a Nao: a neck with a Nao's limits, a camera 6 cm above and ahead of it at a
/// height of about 0.45 m, slow steps, odometry with slipping feet. Its frames carry the pose from its
/// kinematics. Latency and calibration error are 0 here.
SimulationConfig humanoidSimulation();

/// One robot in one world. Time starts at 0 and moves in steps of 10 ms. The same configuration, seed and
/// commands give the same trajectories and images for any number of render threads. *Single-threaded*. Its
/// ports are valid during its lifetime; their waits return at once.
class Simulation : public SteppedRobot {
 public:
  static constexpr StampUs kStep_us = 10'000;

  /// @throws std::invalid_argument for unusable cameras, or a start inside an obstacle or beyond 100 km.
  explicit Simulation(SimulationConfig config);
  ~Simulation() override;

  /// Advances to the delivery of the first camera's next frame.
  bool advanceToNextFrame() override;
  FrameSource& camera() override { return camera(0); }
  FrameSource& camera(std::size_t index);
  PanTiltUnit& panTilt() override;
  MobileBase& base() override;

  /// One step of 10 ms.
  void step();
  StampUs now() const { return now_us_; }
  TruthSample truth() const;
  /// Ground truth of every newer step of the last 5 s, oldest first.
  std::vector<TruthSample> truthSince(StampUs after_us) const;
  /// Steps of 10 ms up to now() + dt_us or just past it. For the real-time process and tests.
  void advance(StampUs dt_us);
  /// Restarts world and scenario at time 0 with another seed and removes added models.
  void reset(std::uint64_t seed);

  /// Moves the robot to another pose without effect on its odometry. Rejected inside an obstacle or if not
  /// finite.
  PortReply kidnap(const Pose2& T_world_robot);
  /// Wheel slip: travel of the encoders beyond that of the robot, over the next 100 ms. Within 1 m.
  PortReply slip(const WheelTravel& extra);
  /// Plays a scenario from now on in place of the present one. Rejected if it names unknown models.
  PortReply play(Scenario scenario);
  void stopScenario();
  /// Events of the scenario that failed since the last call: FILE:LINE and the reason.
  std::vector<std::string> takeScenarioProblems();
  /// Speeds of a scenario's driver; commands over the base's port replace them.
  void driveByScenario(double v_mps, double w_radps);
  /// Models may be added, removed, moved and made to walk between steps.
  MovingWorld& scene() { return scene_; }

  /// True when a frame has arrived since the last one was taken.
  bool frameDue(std::size_t camera = 0) const;
  /// Renders the newest frame that has arrived; empty if none has.
  std::optional<Frame> takeFrame(std::size_t camera = 0);
  /// The exposure of the last frame of a camera with its true pose, for experiments. Empty before the first.
  const std::optional<ExposedFrame>& lastExposure(std::size_t camera = 0) const { return taken_.at(camera); }
  /// Ground truth of the last frame of a camera; empty before the first.
  std::optional<TruthImages> truthImages(std::size_t camera = 0);
  /// Present true pose of a camera, for tests.
  Pose3 truePoseOfCamera(std::size_t camera = 0) const;

  const SimulationConfig& config() const { return config_; }
  const Renderer& renderer() const { return *renderer_; }

 private:
  class CameraPort;
  class PanTiltPort;
  class BasePort;

  /// Poses of the parts that carry cameras, at one instant.
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
  /// Updates the base's obstacles after changes of the models.
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
  std::optional<Scenario> scenario_;  ///< in its initial state, for a reset
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
  CalibratedPanTilt reported_pan_tilt_;
  CalibratedBase reported_base_;
};

}  // namespace vismem
