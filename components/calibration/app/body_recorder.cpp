#include "calibration/app/body_recorder.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>

#include "calibration/core/body/body_start.h"
#include "calibration/core/lens/board_pose.h"
#include "common/config/config_error.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// A port that fails for this long, by Patience, ends the drive.
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

/// How long a port has failed. The time in which this process stood still counts as one short round: nobody
/// could answer.
class Patience {
 public:
  /// @return whether it has failed for too long.
  bool isOver(bool has_succeeded) {
    const auto now = Clock::now();
    failed_ =
        has_succeeded ? Clock::duration::zero() : failed_ + std::min<Clock::duration>(now - last_, 500ms);
    last_ = now;
    return failed_ > kPatience;
  }

 private:
  Clock::time_point last_ = Clock::now();
  Clock::duration failed_ = Clock::duration::zero();
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
    guarded([&] {
      while (!ended()) round();
    });
    // What follows the last view belongs to it: joints and odometry may be late.
    wanted_ = false;
    guarded([&] {
      for (int i = 0; i < kRoundsAfter; ++i) read();
    });
    return record_;
  }

 private:
  static constexpr int kRoundsAfter = 40;

  /// A failure ends the drive, not what it has recorded.
  template <typename Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const ConfigError&) {
      throw;
    } catch (const std::exception& error) {
      if (!ended()) drive_.stop(error.what());
    }
  }
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
    const auto check = [](const char* what, const PortReply& reply, Patience& patience) {
      if (patience.isOver(reply.ok())) throw std::runtime_error(std::string(what) + ": " + reply.message);
    };
    if (command.head) check("the pan-tilt unit", head_.command(*command.head), head_commands_);
    check("the base", base_.setVelocity(command.v_mps, command.w_radps), base_commands_);
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
    if (joints_.isOver(take(head_, record_.joints, why_joints_)))
      throw std::runtime_error("no joint readings: " + why_joints_);
    if (odometry_.isOver(take(base_, record_.odometry, why_odometry_)))
      throw std::runtime_error("no odometry: " + why_odometry_);
  }

  std::optional<Frame> takeFrame() {
    FrameResult result = camera_.next(options_.frame_wait);
    if (!result.message.empty()) why_frames_ = result.message;
    if (frames_.isOver(result.frame.has_value())) throw std::runtime_error("no images: " + why_frames_);
    if (!result.frame) return std::nullopt;
    if (result.frame->T_robot_camera) {
      throw ConfigError(
          {"the images carry the camera's pose from the robot's own kinematics: there is no mounting to "
           "calibrate"});
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
  Patience joints_;
  Patience odometry_;
  Patience frames_;
  Patience head_commands_;
  Patience base_commands_;
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
