#include "calibration/simulated_body_trial.h"

#include <algorithm>
#include <stdexcept>

#include "calibration/app/board_world.h"
#include "simulator/core/simulation.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

World boardWorld(const BoardSpec& board) {
  const TemporaryFolder folder;
  return loadWorld(writeBoardWorld(board, folder.path()), {folder.path()}).world;
}

SimulationConfig configOf(const TrueRobot& truth, std::uint64_t seed) {
  SimulationConfig config;
  config.world = boardWorld(truth.board);
  config.seed = seed;
  config.start = truth.start;
  // The simulator's joints have no zeros: they are in the mounting.
  const CameraMount mount = mountOf(parametersOf(truth));
  config.T_robot_pantilt = mount.T_robot_pantilt;
  SimulatedCameraParams& camera = config.cameras.front();
  camera.T_carrier_camera_body = mount.T_head_camera_body;
  camera.intrinsics = truth.intrinsics;
  camera.stated_intrinsics = truth.stated;
  camera.errors.gaussian = 2.0;
  config.pan_tilt.backlash_rad = truth.backlash_rad;
  config.base.wheel_base_m = truth.wheels.base_m;
  config.joints = {truth.pan_scale, truth.tilt_scale, toStampUs(truth.joint_delay_s)};
  config.wheels = {truth.wheels, kDescribedBase_m, toStampUs(truth.odometry_delay_s)};
  config.odometry = noOdometryError();
  config.odometry.travel_sigma_sqrtm = truth.wheel_noise_sqrtm;
  return config;
}

/// A head some of whose commands fail.
class FaultyHead : public PanTiltUnit {
 public:
  FaultyHead(PanTiltUnit& head, const std::function<HeadFault(int)>& fault) : head_(head), fault_(fault) {}

  PanTiltLimits limits() const override { return head_.limits(); }
  PortReply start() override { return head_.start(); }
  PortReply command(const PanTiltCommand& command) override {
    const HeadFault fault = fault_ ? fault_(commands_++) : HeadFault::kNone;
    if (fault == HeadFault::kThrows) throw std::runtime_error("the head is gone");
    return fault == HeadFault::kRefused ? PortReply::rejected("no answer") : head_.command(command);
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    return head_.samplesSince(after_us, timeout);
  }
  void stop() override { head_.stop(); }

 private:
  PanTiltUnit& head_;
  const std::function<HeadFault(int)>& fault_;
  int commands_ = 0;
};

}  // namespace

BoardSpec a2Board() {
  BoardSpec board;
  board.columns = 6;
  board.rows = 4;
  board.square_m = {0.09, 0.09};
  return board;
}

TrueRobot drawnForSimulator(std::uint64_t seed) {
  TrueRobot truth = drawnRobot(seed);
  truth.board = a2Board();
  truth.row_time_s = 0.0;
  truth.axis_skew_rad = 0.0;
  truth.start.x = -0.9;
  return truth;
}

BodyDriveParams driveInSimulator() {
  BodyDriveParams params;
  params.rig.mount = describedMount();
  params.ring_m = 0.9;
  params.board_radius_m = 0.33;
  return params;
}

SimulatedBodyTrial runInSimulator(const TrueRobot& truth, std::uint64_t seed, const BodyDriveParams& params,
                                  const std::function<HeadFault(int)>& fault) {
  Simulation simulation(configOf(truth, seed));
  SimulatedBodyTrial trial{{}, BodyDrive(params), 0.0, 0.0};
  BodyRecorderOptions options;
  options.board = truth.board;
  options.mount = describedMount();
  options.every_frame = false;
  options.advance = [&] {
    simulation.advanceToNextFrame();
    trial.farthest_m = std::max(trial.farthest_m, simulation.truth().T_world_robot.position().norm());
  };
  FaultyHead head(simulation.panTilt(), fault);
  trial.record = recordBody(simulation.camera(), head, simulation.base(), trial.drive, options);
  trial.seconds = toSeconds(simulation.now());
  return trial;
}

}  // namespace vismem
