#include "calibration/app/body_recorder.h"

#include <chrono>
#include <optional>
#include <stdexcept>

#include "calibration/core/body/body_start.h"
#include "calibration/core/lens/board_pose.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Without a sample of everything, or with commands refused, for this long of the host's time, the drive
/// ends.
constexpr auto kPatience = 5s;
constexpr std::size_t kLeastCorners = 8;

/// Stops the base when it goes out of scope.
class BaseStop {
 public:
  explicit BaseStop(MobileBase& base) : base_(base) {}
  ~BaseStop() {
    base_.setVelocity(0.0, 0.0);
    base_.stop();
  }
  BaseStop(const BaseStop&) = delete;
  BaseStop& operator=(const BaseStop&) = delete;

 private:
  MobileBase& base_;
};

class Recorder {
 public:
  Recorder(FrameSource& camera, PanTiltUnit& head, MobileBase& base, BodyDrive& drive,
           const BodyRecorderOptions& options)
      : camera_(camera),
        head_(head),
        base_(base),
        drive_(drive),
        options_(options),
        detector_(options.board) {
    record_.board = options.board;
    record_.place = options.place;
  }

  BodyRecord run() {
    require("the camera", camera_.start());
    require("the pan-tilt unit", head_.start());
    require("the base", base_.start());
    const BaseStop stop_at_end(base_);
    try {
      while (!ended()) round();
      // What follows the last view belongs to it: joints and odometry may be late.
      for (int i = 0; i < kRoundsAfter; ++i) read();
    } catch (const std::exception& error) {
      drive_.stop(error.what());
    }
    return record_;
  }

 private:
  static constexpr int kRoundsAfter = 40;

  static void require(const char* what, const PortReply& reply) {
    if (!reply.ok()) throw std::runtime_error(std::string(what) + ": " + reply.message);
  }
  bool ended() const {
    return drive_.phase() == BodyDrivePhase::kDone || drive_.phase() == BodyDrivePhase::kStopped;
  }

  void round() {
    if (options_.stopped && options_.stopped()) drive_.stop("stopped by the user");
    const std::optional<Frame> frame = read();
    if (record_.joints.empty() || record_.odometry.empty() || !has_frame_) return;
    if (frame && wanted_) look(*frame);
    const OdometrySample& odometry = record_.odometry.back();
    const PanTiltSample& joints = record_.joints.back();
    const BodyDriveCommand command =
        drive_.update({odometry.stamp_us, {joints.pan_rad, joints.tilt_rad}, odometry.T_odom_robot});
    if (command.take_view) wanted_ = true;
    send(command);
    if (options_.progress) options_.progress(drive_, record_.views.size());
  }

  /// @return the image, if it was asked for and came.
  std::optional<Frame> read() {
    if (options_.advance) options_.advance();
    readSamples();
    if (options_.every_frame || wanted_ || !has_frame_) return takeFrame();
    return std::nullopt;
  }

  /// The plan commands at every round what it wants: one lost command is made good by the next.
  void send(const BodyDriveCommand& command) {
    std::string refused;
    const auto note = [&](const char* what, const PortReply& reply) {
      if (!reply.ok()) refused = std::string(what) + ": " + reply.message;
    };
    if (command.head) note("the pan-tilt unit", head_.command(*command.head));
    note("the base", base_.setVelocity(command.v_mps, command.w_radps));
    const auto now = Clock::now();
    if (refused.empty()) {
      refused_since_.reset();
    } else if (!refused_since_) {
      refused_since_ = now;
    } else if (now - *refused_since_ > kPatience) {
      throw std::runtime_error(refused);
    }
  }

  void readSamples() {
    const auto take = [](auto& port, auto& samples, std::string& why) {
      const StampUs after = samples.empty() ? -1 : samples.back().stamp_us;
      auto batch = port.samplesSince(after, 5ms);
      if (!batch.message.empty()) why = batch.message;
      for (const auto& sample : batch.samples) {
        if (samples.empty() || sample.stamp_us > samples.back().stamp_us) samples.push_back(sample);
      }
      return !batch.samples.empty();
    };
    if (take(head_, record_.joints, why_joints_)) joints_at_ = Clock::now();
    if (take(base_, record_.odometry, why_odometry_)) odometry_at_ = Clock::now();
    const auto now = Clock::now();
    if (now - joints_at_ > kPatience) throw std::runtime_error("no joint readings: " + why_joints_);
    if (now - odometry_at_ > kPatience) throw std::runtime_error("no odometry: " + why_odometry_);
    if (options_.every_frame && now - frame_at_ > kPatience)
      throw std::runtime_error("no images: " + why_frames_);
  }

  std::optional<Frame> takeFrame() {
    FrameResult result = camera_.next(options_.frame_wait);
    if (!result.message.empty()) why_frames_ = result.message;
    if (!result.frame) return std::nullopt;
    frame_at_ = Clock::now();
    if (result.frame->T_robot_camera) {
      throw std::runtime_error(
          "the images carry the camera's pose from the robot's own kinematics: there is no mounting to "
          "calibrate");
    }
    if (has_frame_ && result.frame->intrinsics != record_.intrinsics) {
      throw std::runtime_error(
          "the camera's lens changed during the drive: switch autofocus, zoom and stabilisation off");
    }
    record_.intrinsics = result.frame->intrinsics;
    has_frame_ = true;
    return std::move(result.frame);
  }

  void look(const Frame& frame) {
    wanted_ = false;
    BoardView view = detector_.detect(frame.image, frame.stamp_us).view;
    if (view.corners.size() < kLeastCorners) return;
    const PanTiltSample& joints = record_.joints.back();
    const OdometrySample& odometry = record_.odometry.back();
    if (const auto board = boardPoseFrom(frame.intrinsics, options_.board, view)) {
      const Pose3 T_robot_camera = cameraPose(options_.mount, joints.pan_rad, joints.tilt_rad);
      const Eigen::Vector3d p = middleFromRobot(T_robot_camera, *board, options_.board, options_.place);
      drive_.seen(odometry.stamp_us, transform(odometry.T_odom_robot, p));
    }
    if (record_.views.empty() || view.stamp_us > record_.views.back().stamp_us) {
      record_.views.push_back(std::move(view));
    }
  }

  FrameSource& camera_;
  PanTiltUnit& head_;
  MobileBase& base_;
  BodyDrive& drive_;
  const BodyRecorderOptions& options_;
  BoardDetector detector_;
  BodyRecord record_;
  bool has_frame_ = false;
  bool wanted_ = false;  ///< the next image is worth looking at
  Clock::time_point joints_at_ = Clock::now();
  Clock::time_point odometry_at_ = Clock::now();
  Clock::time_point frame_at_ = Clock::now();
  std::optional<Clock::time_point> refused_since_;
  std::string why_joints_ = "none came";
  std::string why_odometry_ = "none came";
  std::string why_frames_ = "none came";
};

}  // namespace

BodyRecord recordBody(FrameSource& camera, PanTiltUnit& head, MobileBase& base, BodyDrive& drive,
                      const BodyRecorderOptions& options) {
  return Recorder(camera, head, base, drive, options).run();
}

}  // namespace vismem
