#include "common/recording/robot_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numeric>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/angles.h"
#include "recording/bag_writer.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A folder of its own for every test, gone with it.
class RobotLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("recording_" + std::to_string(::getpid()) + "_" + info->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name = "log.bag") const { return (folder_ / name).string(); }

  /// 16x16 pixels, red of pixel i is i, green 100, blue 200.
  static std::vector<std::uint8_t> pixels(bool bgr) {
    std::vector<std::uint8_t> data;
    for (int i = 0; i < 256; ++i) {
      const std::uint8_t rgb[3] = {static_cast<std::uint8_t>(i), 100, 200};
      for (int c = 0; c < 3; ++c) data.push_back(rgb[bgr ? 2 - c : c]);
    }
    return data;
  }

  /// Two images at 1.0 and 1.2 s, odometry and joints at their own stamps around them, tf at the images'.
  std::string write(const std::function<void(BagWriter&)>& images,
                    const std::function<void(BagWriter&)>& rest = writeRest) const {
    BagWriter bag(path());
    images(bag);
    rest(bag);
    bag.close();
    return path();
  }

  static void writeRawImages(BagWriter& bag) {
    bag.image("/camera/image_raw", 1'000'000, "rgb8", 16, 16, pixels(false));
    bag.image("/camera/image_raw", 1'200'000, "bgr8", 16, 16, pixels(true));
  }
  static void writeInfo(BagWriter& bag) {
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0, "plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5});
  }
  static void writeOdometry(BagWriter& bag) {
    bag.odometry("/odom", 950'000, 1.0, 2.0, 0.5);
    bag.odometry("/odom", 1'250'000, 1.3, 2.0, 0.6);
  }
  static void writeJoints(BagWriter& bag) {
    bag.joints("/joint_states", 960'000, {"elbow", "head_yaw", "head_pitch"}, {9.0, 0.2, 0.3});
    bag.joints("/joint_states", 1'260'000, {"head_yaw", "head_pitch"}, {0.4, -0.3});
  }
  static void writeTransforms(BagWriter& bag) {
    bag.transform("/tf", 900'000, "odom", "base_footprint", 7.0, 7.0, 0.0, 0.0);
    bag.transform("/tf_static", 900'000, "neck", "camera_optical_frame", 0.0, 1.0, 0.0, 0.0);
    bag.transform("/tf", 900'000, "base_footprint", "neck", 0.1, 0.0, 0.4, 0.0);
    bag.transform("/tf", 1'100'000, "base_footprint", "neck", 0.3, 0.0, 0.4, 0.0);
    bag.transform("/tf", 1'200'000, "base_footprint", "neck", 0.7, 0.0, 0.5, degToRad(90.0));
  }
  static void writeRest(BagWriter& bag) {
    writeInfo(bag);
    writeOdometry(bag);
    writeJoints(bag);
    writeTransforms(bag);
  }

  static std::string errorOf(const std::string& file, const RobotLogOptions& options = {}) {
    try {
      RobotLog::open(file, options);
    } catch (const RecordingError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
};

TEST_F(RobotLogTest, GivesRawImagesAsRgbWithTheirIntrinsics) {
  const RobotLog log = RobotLog::open(write(writeRawImages));
  // Header stamps, not the times of recording 3 ms later.
  ASSERT_EQ(log.frameStamps(), (std::vector<StampUs>{1'000'000, 1'200'000}));
  for (std::size_t i = 0; i < 2; ++i) {
    const Frame frame = log.readFrame(i);
    EXPECT_EQ(frame.stamp_us, log.frameStamps()[i]);
    EXPECT_EQ(frame.seq, i);
    ASSERT_EQ(frame.image.type(), CV_8UC3);
    EXPECT_EQ(frame.image.at<cv::Vec3b>(1, 3), cv::Vec3b(19, 100, 200)) << "rgb8 and bgr8 give the same";
    EXPECT_EQ(frame.intrinsics.fx, 20.0);
    EXPECT_EQ(frame.intrinsics.cx, 7.5);
    EXPECT_EQ(frame.intrinsics.k2, 0.2);
    EXPECT_EQ(frame.intrinsics.k3, 0.5);
  }
}

TEST_F(RobotLogTest, DecodesCompressedImages) {
  const auto writePng = [](BagWriter& bag) {
    cv::Mat bgr(16, 16, CV_8UC3, cv::Scalar(30, 20, 10));
    std::vector<std::uint8_t> png;
    cv::imencode(".png", bgr, png);
    bag.compressedImage("/camera/image_raw/compressed", 1'000'000, png);
  };
  const RobotLog log = RobotLog::open(write(writePng));
  EXPECT_EQ(log.topics().camera_info, "/camera/camera_info");
  EXPECT_EQ(log.readFrame(0).image.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
}

TEST_F(RobotLogTest, GivesGreyImagesAsTheyAre) {
  std::vector<std::uint8_t> grey(256);
  std::iota(grey.begin(), grey.end(), 0);
  const RobotLog log = RobotLog::open(
      write([&](BagWriter& bag) { bag.image("/camera/image_raw", 1'000'000, "mono8", 16, 16, grey); }));
  const Frame frame = log.readFrame(0);
  ASSERT_EQ(frame.image.type(), CV_8UC1);
  EXPECT_EQ(frame.image.at<std::uint8_t>(1, 2), 18);
}

TEST_F(RobotLogTest, ComposesTransformsAndInterpolatesThemAtTheImage) {
  const RobotLog log = RobotLog::open(write(writeRawImages));
  ASSERT_TRUE(log.knowsCameraPose());
  EXPECT_EQ(log.topics().robot_frame, "base_footprint");
  // At 1.0 s the neck is halfway between 0.1 and 0.3; the camera sits 1 m to its left.
  const Pose3 first = *log.readFrame(0).T_robot_camera;
  EXPECT_NEAR((first.translation() - Eigen::Vector3d(0.2, 1.0, 0.4)).norm(), 0.0, 1e-9);
  // At 1.2 s a transform has exactly this stamp; the neck's left is then the robot's back.
  const Pose3 second = *log.readFrame(1).T_robot_camera;
  EXPECT_NEAR((second.translation() - Eigen::Vector3d(0.7 - 1.0, 0.0, 0.5)).norm(), 0.0, 1e-9);
}

TEST_F(RobotLogTest, KeepsOdometryAndJointsAtTheirOwnStamps) {
  const RobotLog log = RobotLog::open(write(writeRawImages));
  ASSERT_EQ(log.odometry().size(), 2u);
  EXPECT_EQ(log.odometry()[0].stamp_us, 950'000);
  EXPECT_NEAR(log.odometry()[1].T_odom_robot.x, 1.3, 1e-12);
  EXPECT_NEAR(log.odometry()[1].T_odom_robot.theta, 0.6, 1e-12);
  ASSERT_EQ(log.joints().size(), 2u);
  EXPECT_EQ(log.joints()[1].stamp_us, 1'260'000);
  EXPECT_EQ(log.joints()[0].pan_rad, 0.2);
  EXPECT_EQ(log.joints()[0].tilt_rad, -0.3) << "a Nao's head_pitch is positive looking down";
}

TEST_F(RobotLogTest, TakesJointsByNameAndSign) {
  const auto rest = [](BagWriter& bag) {
    writeInfo(bag);
    writeOdometry(bag);
    bag.joints("/joint_states", 1'000'000, {"a", "b"}, {0.1, 0.2});
  };
  RobotLogOptions options;
  options.pan_joint = "b";
  options.tilt_joint = "a";
  options.tilt_sign = -1;
  const RobotLog log = RobotLog::open(write(writeRawImages, rest), options);
  EXPECT_FALSE(log.knowsCameraPose());
  ASSERT_EQ(log.joints().size(), 1u);
  EXPECT_EQ(log.joints()[0].pan_rad, 0.2);
  EXPECT_EQ(log.joints()[0].tilt_rad, -0.1);
  options.tilt_joint = "c";
  EXPECT_THAT(errorOf(path(), options),
              HasSubstr("topic /joint_states: has the joints a, b (expected b and c)"));
}

TEST_F(RobotLogTest, LeavesOutImagesWithoutATransform) {
  const RobotLog log = RobotLog::open(write([](BagWriter& bag) {
    writeRawImages(bag);
    bag.image("/camera/image_raw", 1'300'000, "rgb8", 16, 16, pixels(false));
  }));
  EXPECT_EQ(log.frameStamps().size(), 2u);
  EXPECT_EQ(log.framesWithoutPose(), 1u);
}

TEST_F(RobotLogTest, SaysWhatIsMissing) {
  const auto nothing = [](BagWriter&) {};
  const std::string file = path();
  EXPECT_THAT(errorOf(write(nothing)),
              AllOf(HasSubstr(file + ": no images: found"), HasSubstr("/odom (nav_msgs/Odometry)"),
                    HasSubstr("expected a topic of type sensor_msgs/Image")));
  const auto noOdometry = [](BagWriter& bag) {
    writeInfo(bag);
    writeJoints(bag);
  };
  EXPECT_THAT(errorOf(write(writeRawImages, noOdometry)),
              AllOf(HasSubstr("no odometry"), HasSubstr("expected a topic of type nav_msgs/Odometry")));
  EXPECT_THAT(errorOf(write(writeRawImages, writeOdometry)), HasSubstr("no calibration of the camera"));
  const auto noPose = [](BagWriter& bag) {
    writeInfo(bag);
    writeOdometry(bag);
  };
  EXPECT_THAT(errorOf(write(writeRawImages, noPose)),
              AllOf(HasSubstr("the camera's pose is unknown"), HasSubstr("camera_optical_frame")));
}

TEST_F(RobotLogTest, AsksForANameWhereSeveralTopicsFit) {
  const auto twoCameras = [](BagWriter& bag) {
    writeRawImages(bag);
    bag.image("/rear/image_raw", 1'000'000, "rgb8", 16, 16, pixels(false));
  };
  EXPECT_THAT(errorOf(write(twoCameras)),
              AllOf(HasSubstr("several topics could be the camera's images"), HasSubstr("/rear/image_raw")));
  RobotLogOptions options;
  options.image_topic = "/camera/image_raw";
  EXPECT_EQ(RobotLog::open(path(), options).frameStamps().size(), 2u);
  options.image_topic = "/odom";
  EXPECT_THAT(errorOf(path(), options), HasSubstr("topic /odom: has type nav_msgs/Odometry (expected"));
  options.image_topic = "/front";
  EXPECT_THAT(errorOf(path(), options), HasSubstr("topic /front: is not in the bag"));
}

TEST_F(RobotLogTest, RejectsImagesItCannotRead) {
  const auto depth = [](BagWriter& bag) {
    bag.image("/camera/image_raw", 1'000'000, "16UC1", 16, 16, std::vector<std::uint8_t>(512));
  };
  EXPECT_THAT(
      errorOf(write(depth)),
      HasSubstr(
          "topic /camera/image_raw: image 0 has the encoding \"16UC1\" (expected rgb8, bgr8 or mono8)"));
  const auto torn = [](BagWriter& bag) { bag.compressedImage("/camera/image_raw", 1'000'000, {1, 2, 3}); };
  EXPECT_THAT(errorOf(write(torn)), HasSubstr("image 0 (png, 3 bytes) cannot be decoded"));
  const auto small = [](BagWriter& bag) {
    bag.image("/camera/image_raw", 1'000'000, "mono8", 2, 2, std::vector<std::uint8_t>(4));
  };
  EXPECT_THAT(errorOf(write(small)), HasSubstr("image 0 is 2x2 (expected 16x16"));
}

TEST_F(RobotLogTest, RejectsAnUnknownDistortion) {
  const auto rest = [](BagWriter& bag) {
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0, "equidistant", {0.1, 0.2, 0.3, 0.4});
    writeOdometry(bag);
    writeTransforms(bag);
  };
  EXPECT_THAT(errorOf(write(writeRawImages, rest)),
              HasSubstr("topic /camera/camera_info: distortion model \"equidistant\" (expected plumb_bob)"));
}

TEST_F(RobotLogTest, NamesAFileThatIsNoBag) {
  EXPECT_THAT(errorOf(path("absent.bag")), HasSubstr("absent.bag: cannot be opened"));
  std::ofstream(path("text.bag")) << "hello, world: no bag";
  EXPECT_THAT(errorOf(path("text.bag")),
              HasSubstr("text.bag: not a ROS 1 bag: begins with \"hello, world\""));
  std::ofstream(path("empty.bag")).flush();
  EXPECT_THAT(errorOf(path("empty.bag")), HasSubstr("not a ROS 1 bag"));
}

TEST_F(RobotLogTest, NamesABagThatWasCutOff) {
  write(writeRawImages);
  std::ifstream whole(path(), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  // From just behind the magic line to just before the end: wherever it was cut, an error, never a crash.
  for (std::size_t length = 14; length < bytes.size(); length += 1 + bytes.size() / 40) {
    std::ofstream(path("cut.bag"), std::ios::binary) << bytes.substr(0, length);
    EXPECT_THAT(errorOf(path("cut.bag")), AllOf(HasSubstr("cut.bag"), HasSubstr("reindex")))
        << "at " << length;
  }
}

TEST_F(RobotLogTest, ReadsTheRecordingOfARealNao) {
  const char* data = std::getenv("AVM_DATA");
  const fs::path folder = data ? fs::path(data) : fs::path(VISMEM_SOURCE_DIR) / "../shared/data";
  const fs::path bag = folder / "nao_field_2009/nao_field_2009.bag";
  if (!fs::exists(bag)) GTEST_SKIP() << bag << " is not here: set AVM_DATA to the folder of the data sets";
  const RobotLog log = RobotLog::open(bag.string());
  EXPECT_EQ(log.frameStamps().size(), 160u);
  EXPECT_EQ(log.framesWithoutPose(), 0u);
  EXPECT_EQ(log.odometry().size(), 274u);
  EXPECT_EQ(log.joints().size(), 274u);
  EXPECT_GE(log.frameStamps().front(), 486'549'000);
  EXPECT_LE(log.frameStamps().back(), 519'895'000);
  double lowest_pan = 0.0;
  double highest_pan = 0.0;
  for (const auto& sample : log.joints()) {
    lowest_pan = std::min(lowest_pan, sample.pan_rad);
    highest_pan = std::max(highest_pan, sample.pan_rad);
  }
  EXPECT_NEAR(radToDeg(lowest_pan), -59.0, 1.0);
  EXPECT_NEAR(radToDeg(highest_pan), 80.0, 1.0);
  for (std::size_t i = 0; i < log.frameStamps().size(); ++i) {
    const Frame frame = log.readFrame(i);
    EXPECT_EQ(frame.image.size(), cv::Size(320, 240));
    const Pose3& pose = *frame.T_robot_camera;
    EXPECT_GE(pose.translation().z(), 0.405) << "frame " << i;
    EXPECT_LE(pose.translation().z(), 0.495) << "frame " << i;
    const double below_horizon_deg = radToDeg(std::asin(-pose.linear().col(2).z()));
    EXPECT_GE(below_horizon_deg, -2.0) << "frame " << i;
    EXPECT_LE(below_horizon_deg, 74.0) << "frame " << i;
  }
}

}  // namespace
}  // namespace vismem
