#include "common/recording/robot_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/config/text_format.h"
#include "common/recording/picture_decoder.h"
#include "common/recording/recorded_rows.h"
#include "common/recording/transform_tree.h"

namespace vismem {
namespace {

const std::array<std::string, 2> kRobotFrames{"base_footprint", "base_link"};
const std::array<std::string, 2> kPanJoints{"head_yaw", "pan"};
const std::array<std::string, 2> kTiltJoints{"head_pitch", "tilt"};

std::string listOf(const std::vector<std::string>& items) {
  return items.empty() ? "nothing" : joined(items, ", ");
}

std::string listOf(const std::vector<BagTopic>& topics) {
  std::vector<std::string> items;
  for (const BagTopic& topic : topics) items.push_back(topic.name + " (" + topic.type + ")");
  return listOf(items);
}

bool isImage(const BagTopic& topic) {
  return topic.type == kRawImageType || topic.type == kCompressedImageType;
}

/// "/camera/image_raw/compressed" and "/camera/image_raw" -> "/camera/camera_info".
std::string infoBeside(std::string image_topic) {
  const std::string suffix = "/compressed";
  if (image_topic.ends_with(suffix)) image_topic.resize(image_topic.size() - suffix.size());
  const auto slash = image_topic.rfind('/');
  return (slash == std::string::npos ? "" : image_topic.substr(0, slash + 1)) + "camera_info";
}

}  // namespace

struct RobotLog::Impl {
  explicit Impl(BagFile opened) : bag(std::move(opened)) {}

  struct Shot {
    std::size_t index = 0;  // in the bag's topic
    StampUs stamp_us = 0;
    CameraIntrinsics intrinsics;
    std::optional<Pose3> T_robot_camera;
  };

  mutable BagFile bag;
  RobotLogTopics topics;
  std::vector<Shot> shots;
  std::vector<StampUs> stamps;
  std::vector<OdometrySample> odometry;
  std::vector<PanTiltSample> joints;
  std::size_t without_pose = 0;
  mutable std::vector<std::string> notes;

  template <typename Sample>
  void noteCoverage(const char* what, const std::vector<Sample>& samples) {
    if (samples.empty()) return;
    const auto note = coverageNote(what, samples.front().stamp_us, samples.back().stamp_us, stamps);
    if (!note.empty()) notes.push_back(bag.file() + ": " + note);
  }

  /// Leaves out what was recorded after the clock jumped back, and says so.
  template <typename Item>
  void keepFirstEpoch(const std::string& topic, std::vector<Item>& items) {
    const std::size_t count = countBeforeJump(items);
    if (count == items.size()) return;
    notes.push_back(bag.file() + ": topic " + topic + ": the clock jumps back from " +
                    std::to_string(toSeconds(items[count - 1].stamp_us)) + " s to " +
                    std::to_string(toSeconds(items[count].stamp_us)) + " s: the " +
                    std::to_string(items.size() - count) + " messages after that are left out, " +
                    std::to_string(count) + " are kept");
    items.resize(count);
  }

  [[noreturn]] void fail(const std::string& topic, const std::string& what) const {
    throw RecordingError(bag.file() + ": " + (topic.empty() ? "" : "topic " + topic + ": ") + what);
  }

  /// The topic of that name, or the only one that fits.
  /// @return empty without a name and without a fitting topic.
  template <typename Fits>
  std::string choose(const std::string& named, const std::string& kind, const std::string& types,
                     Fits fits) const {
    std::vector<BagTopic> fitting;
    for (const BagTopic& topic : bag.topics()) {
      if (!named.empty() && topic.name == named) {
        if (!fits(topic)) fail(named, "has type " + topic.type + " (expected " + types + ")");
        return named;
      }
      if (fits(topic)) fitting.push_back(topic);
    }
    if (!named.empty()) fail(named, "is not in the bag, which has " + listOf(bag.topics()));
    if (fitting.size() > 1) {
      fail("",
           "several topics could be the " + kind + ": " + listOf(fitting) + " (name the one that is meant)");
    }
    return fitting.empty() ? "" : fitting.front().name;
  }

  /// @throws RecordingError with the problems of all parts.
  void readAll(const RobotLogOptions& options);
  void openImages(const RobotLogOptions& options);
  void readIntrinsics(const RobotLogOptions& options);
  void useFieldOfView(double fov_rad);
  void findOdometry(const RobotLogOptions& options);
  void readOdometry(const RobotLogOptions& options);
  std::vector<RosOdometry> recordedOdometry(const RobotLogOptions& options);
  void readJoints(const RobotLogOptions& options);
  void readTransforms(const RobotLogOptions& options, const std::string& images_frame);
  std::string images_frame;
};

void RobotLog::Impl::openImages(const RobotLogOptions& options) {
  const std::string types = std::string(kRawImageType) + " or " + kCompressedImageType;
  const auto hasRawTwin = [&](const BagTopic& topic) {
    const auto isTwin = [&](const BagTopic& other) {
      return other.name + "/compressed" == topic.name && isImage(other);
    };
    return topic.name != options.image_topic && std::any_of(bag.topics().begin(), bag.topics().end(), isTwin);
  };
  topics.image = choose(options.image_topic, "camera's images", types,
                        [&](const BagTopic& topic) { return isImage(topic) && !hasRawTwin(topic); });
  if (topics.image.empty()) {
    fail("", "no images: found " + listOf(bag.topics()) + " (expected a topic of type " + types + ")");
  }
  const auto headers = bag.imageHeaders(topics.image);
  if (headers.empty()) fail(topics.image, "has no messages (expected images)");
  images_frame = headers.front().frame_id;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    const BagImageHeader& header = headers[i];
    if (!header.compressed && !isKnownEncoding(header.encoding)) {
      fail(topics.image, "image " + std::to_string(i) + " has the encoding \"" + header.encoding +
                             "\" (expected " + knownEncodings() + ")");
    }
    Shot shot;
    shot.index = i;
    shot.stamp_us = header.stamp_us + toStampUs(options.late_s);
    shots.push_back(shot);
  }
  keepFirstEpoch(topics.image, shots);
  std::stable_sort(shots.begin(), shots.end(),
                   [](const Shot& a, const Shot& b) { return a.stamp_us < b.stamp_us; });
  shots.erase(std::unique(shots.begin(), shots.end(),
                          [](const Shot& a, const Shot& b) { return a.stamp_us == b.stamp_us; }),
              shots.end());
}

void RobotLog::Impl::readIntrinsics(const RobotLogOptions& options) {
  std::string wanted = options.camera_info_topic;
  if (wanted.empty()) {
    const std::string beside = infoBeside(topics.image);
    for (const BagTopic& topic : bag.topics()) {
      if (topic.name == beside && topic.type == kCameraInfoType) wanted = beside;
    }
  }
  topics.camera_info = choose(wanted, "camera's calibration", kCameraInfoType,
                              [](const BagTopic& topic) { return topic.type == kCameraInfoType; });
  if (topics.camera_info.empty()) {
    if (options.fov_rad > 0.0) return useFieldOfView(options.fov_rad);
    fail("", "no calibration of the camera: found " + listOf(bag.topics()) + " (expected a topic of type " +
                 kCameraInfoType + ", or --topics fov=DEGREES, key ReplayServer.Camera.FieldOfView_deg)");
  }
  std::map<StampUs, CameraIntrinsics> by_stamp;
  for (const RosCameraInfo& info : bag.cameraInfos(topics.camera_info)) {
    CameraIntrinsics intrinsics;
    const std::string wrong = readCalibration(info, intrinsics);
    if (!wrong.empty()) fail(topics.camera_info, wrong);
    by_stamp.insert_or_assign(info.header.stamp_us, intrinsics);
  }
  if (by_stamp.empty()) fail(topics.camera_info, "has no messages (expected the camera's calibration)");
  for (Shot& shot : shots) {
    // The calibration of the image's stamp, or the last before it: it is valid until the next one.
    auto after = by_stamp.upper_bound(shot.stamp_us);
    if (after != by_stamp.begin()) --after;
    shot.intrinsics = after->second;
  }
}

void RobotLog::Impl::useFieldOfView(double fov_rad) {
  const auto size = pictureSize(bag.readImage(topics.image, shots.front().index));
  if (!size || size->width <= 0 || size->height <= 0)
    fail(topics.image, "the size of its first image is unknown");
  for (Shot& shot : shots) shot.intrinsics = intrinsicsFromFieldOfView(size->width, size->height, fov_rad);
}

void RobotLog::Impl::findOdometry(const RobotLogOptions& options) {
  const auto isOdometry = [](const BagTopic& topic) { return topic.type == kOdometryType; };
  if (!options.odometry_topic.empty()) {
    topics.odometry = choose(options.odometry_topic, "odometry", kOdometryType, isOdometry);
    return;
  }
  const auto found = odometryTopics(bag, topics.truth);
  topics.odometry = chooseOdometry(found, options.odom_frame);
  if (found.size() < 2) return;
  if (topics.odometry.empty()) {
    fail("", "several topics could be the odometry: " + textOf(found) + " (name the one that is meant)");
  }
  notes.push_back(bag.file() + ": the odometry is topic " + topics.odometry + ", of " + textOf(found));
}

/// Of its own topic, else from the transforms odom -> robot.
std::vector<RosOdometry> RobotLog::Impl::recordedOdometry(const RobotLogOptions& options) {
  if (!topics.odometry.empty()) return bag.odometry(topics.odometry);
  const std::string odom = options.odom_frame.empty() ? "odom" : options.odom_frame;
  std::vector<RosOdometry> samples;
  for (const BagTransform& t : bag.transforms()) {
    const bool robot = options.robot_frame.empty() ? std::find(kRobotFrames.begin(), kRobotFrames.end(),
                                                               t.child_frame_id) != kRobotFrames.end()
                                                   : t.child_frame_id == options.robot_frame;
    if (t.is_static || t.header.frame_id != odom || !robot) continue;
    samples.push_back({t.header, t.child_frame_id, t.pose});
  }
  if (samples.empty()) {
    fail("", "no odometry: found " + listOf(bag.topics()) + " (expected a topic of type " + kOdometryType +
                 ", or transforms from " + odom + " to the robot)");
  }
  topics.odometry = "of transforms";
  return samples;
}

void RobotLog::Impl::readOdometry(const RobotLogOptions& options) {
  findOdometry(options);
  for (const RosOdometry& raw : recordedOdometry(options)) {
    OdometrySample sample;
    sample.stamp_us = raw.header.stamp_us;
    const std::optional<Pose3> pose = toPose3(raw.pose);
    if (!pose) {
      fail(topics.odometry, "the orientation at " + std::to_string(toSeconds(sample.stamp_us)) +
                                " s is no rotation (expected a quaternion that is not zero)");
    }
    sample.T_odom_robot = toPose2(*pose);
    if (!isFinite(sample.T_odom_robot)) {
      fail(topics.odometry,
           "the position at " + std::to_string(toSeconds(sample.stamp_us)) + " s is not finite");
    }
    sample.v_mps = raw.v_mps;
    sample.w_radps = raw.w_radps;
    odometry.push_back(sample);
  }
  keepFirstEpoch(topics.odometry, odometry);
  makeIncreasing(odometry);
  if (odometry.size() < 2) {
    fail(topics.odometry,
         std::to_string(odometry.size()) +
             " samples with different stamps (expected at least two, to interpolate between)");
  }
}

void RobotLog::Impl::readJoints(const RobotLogOptions& options) {
  const bool named =
      !options.joint_topic.empty() || !options.pan_joint.empty() || !options.tilt_joint.empty();
  topics.joints = choose(options.joint_topic, "joint angles", kJointStateType,
                         [](const BagTopic& topic) { return topic.type == kJointStateType; });
  if (topics.joints.empty()) {
    if (named)
      fail("", "no joint angles: found " + listOf(bag.topics()) + " (expected a topic of type " +
                   kJointStateType + ")");
    return;
  }
  const auto recorded = bag.joints(topics.joints);
  std::map<std::string, int> names;
  for (const RosJointState& sample : recorded) {
    for (const std::string& name : sample.names) ++names[name];
  }
  const auto pick = [&](const std::string& wanted, const std::array<std::string, 2>& known) -> std::string {
    if (!wanted.empty()) return names.contains(wanted) ? wanted : "";
    for (const std::string& name : known) {
      if (names.contains(name)) return name;
    }
    return "";
  };
  topics.pan_joint = pick(options.pan_joint, kPanJoints);
  topics.tilt_joint = pick(options.tilt_joint, kTiltJoints);
  if (topics.pan_joint.empty() || topics.tilt_joint.empty()) {
    if (named) {
      std::vector<std::string> found;
      for (const auto& item : names) found.push_back(item.first);
      fail(topics.joints, "has the joints " + listOf(found) + " (expected " +
                              (options.pan_joint.empty() ? "head_yaw or pan" : options.pan_joint) + " and " +
                              (options.tilt_joint.empty() ? "head_pitch or tilt" : options.tilt_joint) + ")");
    }
    // Other joints of the robot are not needed.
    topics.joints = topics.pan_joint = topics.tilt_joint = "";
    return;
  }
  const int sign = options.tilt_sign != 0 ? options.tilt_sign : (topics.tilt_joint == "head_pitch" ? -1 : 1);
  for (const RosJointState& sample : recorded) {
    std::optional<double> pan;
    std::optional<double> tilt;
    for (std::size_t i = 0; i < std::min(sample.names.size(), sample.positions.size()); ++i) {
      if (sample.names[i] == topics.pan_joint) pan = sample.positions[i];
      if (sample.names[i] == topics.tilt_joint) tilt = sample.positions[i];
    }
    // Robots publish groups of joints in turn: messages without the head's joints are normal.
    if (!pan || !tilt) continue;
    if (!std::isfinite(*pan) || !std::isfinite(*tilt)) {
      fail(topics.joints,
           "an angle at " + std::to_string(toSeconds(sample.header.stamp_us)) + " s is not finite");
    }
    joints.push_back({sample.header.stamp_us, 0, *pan, sign * *tilt});
  }
  keepFirstEpoch(topics.joints, joints);
  makeIncreasing(joints);
}

void RobotLog::Impl::readTransforms(const RobotLogOptions& options, const std::string& frame_of_images) {
  TransformTree tree(options.max_gap_us);
  std::map<std::string, StampUs> newest_us;  // by child: others may publish later
  std::size_t left_out = 0;
  for (const BagTransform& transform : bag.transforms()) {
    const auto& [stamp_us, parent] = transform.header;
    const std::string& child = transform.child_frame_id;
    if (!transform.is_static) {
      StampUs& newest = newest_us.try_emplace(child, stamp_us).first->second;
      if (stamp_us < newest - kClockBackUs) {
        ++left_out;
        continue;
      }
      newest = std::max(newest, stamp_us);
    }
    const std::optional<Pose3> pose = toPose3(transform.pose);
    if (!pose || !pose->matrix().allFinite()) {
      fail("", "the transform " + parent + " -> " + child + " at " + std::to_string(toSeconds(stamp_us)) +
                   " s is not a finite pose");
    }
    if (transform.is_static) {
      tree.addStatic(parent, child, *pose);
    } else {
      tree.add(parent, child, stamp_us, *pose);
    }
  }
  if (left_out > 0) {
    notes.push_back(bag.file() + ": " + std::to_string(left_out) +
                    " transforms from after a jump of the clock back are left out");
  }
  const bool named = !options.robot_frame.empty() || !options.camera_frame.empty();
  const std::string camera = options.camera_frame.empty() ? frame_of_images : options.camera_frame;
  std::string robot = options.robot_frame;
  for (const std::string& known : kRobotFrames) {
    if (robot.empty() && tree.connected(known, camera)) robot = known;
  }
  if (robot.empty() || !tree.connected(robot, camera)) {
    const bool joints_known = !joints.empty();
    if (!named && joints_known) return;
    fail("", "the camera's pose is unknown: no transforms join " +
                 (robot.empty() ? "base_footprint or base_link" : robot) + " and \"" + camera +
                 "\", found the frames " + listOf(tree.frames()) +
                 (named ? "" : ", and no joints called head_yaw and head_pitch or pan and tilt") +
                 " (name the frames or the joints)");
  }
  topics.robot_frame = robot;
  topics.camera_frame = camera;
  for (Shot& shot : shots) shot.T_robot_camera = tree.lookup(robot, camera, shot.stamp_us);
  const auto gone =
      std::remove_if(shots.begin(), shots.end(), [](const Shot& s) { return !s.T_robot_camera; });
  without_pose = static_cast<std::size_t>(std::distance(gone, shots.end()));
  shots.erase(gone, shots.end());
  if (shots.empty()) {
    fail(topics.image, "no image has a known transform from " + robot + " to " + camera + " at its stamp");
  }
}

void RobotLog::Impl::readAll(const RobotLogOptions& options) {
  std::string problems;
  const auto succeeds = [&problems](auto&& read) {
    try {
      read();
      return true;
    } catch (const RecordingError& error) {
      problems += (problems.empty() ? "" : "\n") + std::string(error.what());
      return false;
    }
  };
  const bool images = succeeds([&] { openImages(options); });
  if (images) succeeds([&] { readIntrinsics(options); });
  succeeds([&] { topics.truth = truthTopic(bag, options.truth_topic); });
  succeeds([&] { readOdometry(options); });
  if (!options.fixed_camera && succeeds([&] { readJoints(options); }) && images) {
    succeeds([&] { readTransforms(options, images_frame); });
  }
  if (!problems.empty()) throw RecordingError(problems);
}

RobotLog::RobotLog(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RobotLog::~RobotLog() = default;
RobotLog::RobotLog(RobotLog&&) noexcept = default;
RobotLog& RobotLog::operator=(RobotLog&&) noexcept = default;

RobotLog RobotLog::open(const std::string& path, const RobotLogOptions& options) {
  return open(BagFile(bagsOf(path)), options);
}

RobotLog RobotLog::open(const std::vector<std::string>& paths, const RobotLogOptions& options) {
  return open(BagFile(bagsOf(paths)), options);
}

RobotLog RobotLog::open(BagFile bag, const RobotLogOptions& options) {
  auto impl = std::make_unique<Impl>(std::move(bag));
  impl->readAll(options);
  for (const Impl::Shot& shot : impl->shots) impl->stamps.push_back(shot.stamp_us);
  impl->noteCoverage("odometry", impl->odometry);
  impl->noteCoverage("joint angles", impl->joints);
  RobotLog log(std::move(impl));
  // Reports a problem of all images at the opening.
  log.readFrame(0);
  const auto& damage = log.impl_->bag.notes();
  log.impl_->notes.insert(log.impl_->notes.begin(), damage.begin(), damage.end());
  return log;
}

const std::string& RobotLog::file() const {
  return impl_->bag.file();
}
const RobotLogTopics& RobotLog::topics() const {
  return impl_->topics;
}
const std::vector<StampUs>& RobotLog::frameStamps() const {
  return impl_->stamps;
}
const std::vector<BagTopic>& RobotLog::contents() const {
  return impl_->bag.topics();
}
const std::vector<std::string>& RobotLog::notes() const {
  return impl_->notes;
}
bool RobotLog::knowsCameraPose() const {
  return !impl_->topics.robot_frame.empty();
}
std::size_t RobotLog::framesWithoutPose() const {
  return impl_->without_pose;
}
const std::vector<OdometrySample>& RobotLog::odometry() const {
  return impl_->odometry;
}
const std::vector<PanTiltSample>& RobotLog::joints() const {
  return impl_->joints;
}
std::vector<TruePose> RobotLog::truth() const {
  return readTruth(impl_->bag, impl_->topics.truth);
}

CameraIntrinsics RobotLog::intrinsics(std::size_t index) const {
  return impl_->shots.at(index).intrinsics;
}

Frame RobotLog::readFrame(std::size_t index, bool native) const {
  const Impl::Shot& shot = impl_->shots.at(index);
  const BagImage raw = impl_->bag.readImage(impl_->topics.image, shot.index);
  Frame frame;
  frame.stamp_us = shot.stamp_us;
  frame.seq = index;
  frame.intrinsics = shot.intrinsics;
  frame.T_robot_camera = shot.T_robot_camera;
  const std::string which = "image " + std::to_string(shot.index) + " ";
  const auto checkSize = [&](const cv::Size& size) {
    if (size.width == frame.intrinsics.width && size.height == frame.intrinsics.height) return;
    impl_->fail(impl_->topics.image,
                which + "is " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                    " (expected " + std::to_string(frame.intrinsics.width) + "x" +
                    std::to_string(frame.intrinsics.height) + ", as " + impl_->topics.camera_info + " says)");
  };
  try {
    // Before anything of the claimed size is allocated.
    if (const auto size = pictureSize(raw)) checkSize(*size);
    if (native) frame.native = nativePicture(raw);
    if (!frame.native) frame.image = decodePicture(raw);
  } catch (const RecordingError& error) {
    const std::string what = error.what();
    if (what.find(impl_->topics.image) != std::string::npos) throw;
    impl_->fail(impl_->topics.image, which + what);
  }
  if (!frame.native) checkSize(frame.image.size());
  return frame;
}

}  // namespace vismem
