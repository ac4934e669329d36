#include "calibration/simulated_body_trial.h"

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/core/target/board_drawing.h"
#include "common/kinematics/calibrated_ports.h"
#include "simulator/core/simulation.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

/// Texture pixels a millimetre.
constexpr int kScale = 4;

/// The printed page as an image; its lower left corner is the image's.
cv::Mat pictureOf(const PrintedPage& page) {
  const int width = static_cast<int>(std::lround(page.width_mm * kScale));
  const int height = static_cast<int>(std::lround(page.height_mm * kScale));
  cv::Mat picture(height, width, CV_8UC1, cv::Scalar(255));
  const auto px = [](double mm) { return static_cast<int>(std::lround(mm * kScale)); };
  for (const PrintedRectangle& r : page.black) {
    const cv::Rect area(px(r.x), height - px(r.y + r.height), px(r.x + r.width) - px(r.x),
                        px(r.y + r.height) - px(r.y));
    cv::rectangle(picture, area, cv::Scalar(0), cv::FILLED);
  }
  return picture;
}

/// A floor with the board's middle at the origin.
World boardWorld(const BoardSpec& board) {
  const TemporaryFolder folder;
  const Paper paper{"large", 1e3 * board.columns * board.square_m.x() + 100.0,
                    1e3 * board.rows * board.square_m.y() + 100.0};
  const PrintedPage page = drawBoard(board, paper);
  cv::imwrite(folder / "board.png", pictureOf(page));
  const Eigen::Vector2d middle_mm =
      page.origin_mm +
      500.0 * Eigen::Vector2d(board.columns * board.square_m.x(), board.rows * board.square_m.y());
  const double x = 1e-3 * (0.5 * page.width_mm - middle_mm.x());
  const double y = 1e-3 * (0.5 * page.height_mm - middle_mm.y());
  std::ofstream(folder / "board.world")
      << "<?xml version=\"1.0\"?><sdf version=\"1.6\"><world name=\"board\">"
         "<scene><ambient>1 1 1 1</ambient><shadows>false</shadows></scene>"
         "<model name=\"floor\"><static>true</static><pose>0 0 -0.06 0 0 0</pose><link name=\"link\">"
         "<visual name=\"v\"><geometry><box><size>12 12 0.1</size></box></geometry><material>"
         "<ambient>0.5 0.45 0.4 1</ambient><diffuse>0.5 0.45 0.4 "
         "1</diffuse></material></visual></link></model>"
         "<model name=\"board\"><static>true</static><pose>"
      << x << " " << y << " -0.005 0 0 0</pose><link name=\"link\"><visual name=\"v\"><geometry><box><size>"
      << 1e-3 * page.width_mm << " " << 1e-3 * page.height_mm
      << " 0.01</size></box></geometry><material><ambient>1 1 1 1</ambient><diffuse>1 1 1 1</diffuse>"
         "<pbr><metal><albedo_map>board.png</albedo_map></metal></pbr></material></visual></link></model>"
         "</world></sdf>";
  return loadWorld(folder / "board.world", {folder.path()}).world;
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
  camera.errors.gaussian = 2.0;
  config.pan_tilt.backlash_rad = truth.backlash_rad;
  config.base.wheel_base_m = truth.wheels.base_m;
  config.odometry = noOdometryError();
  config.odometry.travel_sigma_sqrtm = truth.wheel_noise_sqrtm;
  return config;
}

/// The simulated camera with the lens as it is described.
class DescribedCamera : public FrameSource {
 public:
  explicit DescribedCamera(FrameSource& camera) : camera_(camera) {}
  FrameCapabilities capabilities() const override { return camera_.capabilities(); }
  PortReply configure(const FrameRequest& request) override { return camera_.configure(request); }
  PortReply start() override { return camera_.start(); }
  FrameResult next(std::chrono::milliseconds timeout) override {
    FrameResult result = camera_.next(timeout);
    if (result.frame) result.frame->intrinsics = boardCamera();
    return result;
  }
  void stop() override { camera_.stop(); }

 private:
  FrameSource& camera_;
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

SimulatedBodyTrial runInSimulator(const TrueRobot& truth, std::uint64_t seed, const BodyDriveParams& params) {
  Simulation simulation(configOf(truth, seed));
  // The inverse of a correction misreports.
  CalibratedPanTilt head(simulation.panTilt(),
                         {1.0 / truth.pan_scale, 1.0 / truth.tilt_scale, -toStampUs(truth.joint_delay_s)});
  CalibratedBase base(simulation.base(),
                      {{1.0 / truth.wheels.left_scale, 1.0 / truth.wheels.right_scale, kDescribedBase_m},
                       truth.wheels.base_m,
                       -toStampUs(truth.odometry_delay_s)});
  DescribedCamera camera(simulation.camera());
  SimulatedBodyTrial trial{{}, BodyDrive(params), 0.0, 0.0};
  BodyRecorderOptions options;
  options.board = truth.board;
  options.mount = describedMount();
  options.every_frame = false;
  options.advance = [&] {
    simulation.advanceToNextFrame();
    trial.farthest_m = std::max(trial.farthest_m, simulation.truth().T_world_robot.position().norm());
  };
  trial.record = recordBody(camera, head, base, trial.drive, options);
  trial.seconds = toSeconds(simulation.now());
  return trial;
}

}  // namespace vismem
