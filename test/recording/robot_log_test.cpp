#include "common/recording/robot_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/angles.h"
#include "recording/bag_writer.h"
#include "support/build_paths.h"

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
    } catch (const std::exception& error) {
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

TEST_F(RobotLogTest, GivesALateImageTheTransformsOfItsStamp) {
  RobotLogOptions options;
  options.late_s = 0.05;
  const Frame first = RobotLog::open(write(writeRawImages), options).readFrame(0);
  EXPECT_EQ(first.stamp_us, 1'050'000);
  EXPECT_NEAR(first.T_robot_camera->translation().x(), 0.25, 1e-9);
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
      HasSubstr("topic /camera/image_raw: image 0 has the encoding \"16UC1\" (expected rgb8, bgr8, rgba8"));
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
  EXPECT_THAT(errorOf(path("absent.bag")),
              HasSubstr("absent.bag: no such file or folder (must be a ROS 1 bag)"));
  std::ofstream(path("text.bag")) << "hello, world: no bag";
  EXPECT_THAT(errorOf(path("text.bag")),
              HasSubstr("text.bag: not a ROS 1 bag: begins with \"hello, world\""));
  std::ofstream(path("empty.bag")).flush();
  EXPECT_THAT(errorOf(path("empty.bag")), HasSubstr("not a ROS 1 bag"));
}

TEST_F(RobotLogTest, OpensABagThatWasCutOffOrNamesIt) {
  write(writeRawImages);
  std::ifstream whole(path(), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  // From just behind the magic line to just before the end: wherever it was cut, a recording with a note of
  // what was lost, or an error that names the file; never a crash.
  int opened = 0;
  for (std::size_t length = 14; length < bytes.size(); length += 1 + bytes.size() / 40) {
    std::ofstream(path("cut.bag"), std::ios::binary) << bytes.substr(0, length);
    try {
      const RobotLog log = RobotLog::open(path("cut.bag"));
      EXPECT_THAT(log.notes(), ::testing::Contains(HasSubstr("indexed again"))) << "at " << length;
      ++opened;
    } catch (const RecordingError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.bag")) << "at " << length;
    }
  }
  EXPECT_GE(opened, 5) << "the index is the last third of this file";
}

TEST_F(RobotLogTest, KeepsWhatWasRecordedBeforeTheClockJumpedBack) {
  const RobotLog log = RobotLog::open(write(
      [](BagWriter& bag) {
        bag.image("/camera/image_raw", 11'000'000, "rgb8", 16, 16, pixels(false));
        bag.image("/camera/image_raw", 11'200'000, "rgb8", 16, 16, pixels(false));
        bag.image("/camera/image_raw", 1'000'000, "rgb8", 16, 16, pixels(false));
      },
      [](BagWriter& bag) {
        writeInfo(bag);
        writeJoints(bag);
        bag.odometry("/odom", 11'000'000, 1.0, 2.0, 0.5);
        bag.odometry("/odom", 11'250'000, 1.3, 2.0, 0.6);
        bag.odometry("/odom", 1'000'000, 0.0, 0.0, 0.0);
      }));
  EXPECT_EQ(log.frameStamps(), (std::vector<StampUs>{11'000'000, 11'200'000}));
  EXPECT_EQ(log.odometry().size(), 2u);
  EXPECT_THAT(log.notes(),
              ::testing::Contains(AllOf(HasSubstr("topic /camera/image_raw: the clock jumps back from 11.2"),
                                        HasSubstr("1 messages after that are left out, 2 are kept"))));
}

TEST_F(RobotLogTest, TakesAFieldOfViewInPlaceOfAMissingCalibration) {
  const std::string file = write(writeRawImages, [](BagWriter& bag) {
    writeOdometry(bag);
    writeTransforms(bag);
  });
  EXPECT_THAT(errorOf(file),
              AllOf(HasSubstr("no calibration of the camera"), HasSubstr("Camera.FieldOfView_deg")));
  RobotLogOptions options;
  options.fov_rad = degToRad(90.0);
  // Half of 16 pixels at 45 degrees.
  EXPECT_NEAR(RobotLog::open(file, options).intrinsics(0).fx, 8.0, 1e-9);
}

TEST_F(RobotLogTest, NotesImagesThatTheOdometryDoesNotCover) {
  const auto noteOf = [](StampUs begin_us, StampUs end_us) {
    return coverageNote("odometry", begin_us, end_us, {10'000'000, 11'000'000, 12'000'000, 13'500'000});
  };
  EXPECT_EQ(noteOf(10'000'000, 12'000'000),
            "1 of 4 images cannot be used: odometry at 10.000..12.000 s, images at 10.000..13.500 s");
  EXPECT_EQ(noteOf(9'000'000, 12'600'000), "") << "the recording ends";
  EXPECT_EQ(noteOf(1'000'000, 4'000'000),
            "4 of 4 images cannot be used: odometry at 1.000..4.000 s, images at 10.000..13.500 s")
      << "another clock";
}

TEST_F(RobotLogTest, JoinsTheBagsOfAFolder) {
  fs::create_directories(path("parts"));
  const auto part = [&](const std::string& name, std::int64_t offset_us) {
    BagWriter bag(path("parts/" + name));
    bag.image("/camera/image_raw", 1'000'000 + offset_us, "rgb8", 16, 16, pixels(false));
    bag.cameraInfo("/camera/camera_info", 1'000'000 + offset_us, 16, 16, 20.0);
    bag.odometry("/odom", 950'000 + offset_us, 1.0, 2.0, 0.5);
    bag.joints("/joint_states", 960'000 + offset_us, {"pan", "tilt"}, {0.2, 0.3});
    bag.close();
  };
  part("a_0001.bag", 500'000);
  part("a_0000.bag", 0);
  const RobotLog log = RobotLog::open(path("parts"));
  EXPECT_EQ(log.frameStamps(), (std::vector<StampUs>{1'000'000, 1'500'000}));
  EXPECT_EQ(log.odometry().size(), 2u);
  fs::create_directories(path("nothing"));
  EXPECT_THAT(errorOf(path("nothing")), HasSubstr("a folder without a recording"));
}

TEST_F(RobotLogTest, DecodesTheNamedEncodings) {
  // A picture of one colour in each encoding: R 200, G 100, B 50 (grey: 128).
  const auto repeated = [](std::vector<std::uint8_t> pattern, std::size_t bytes) {
    std::vector<std::uint8_t> data;
    while (data.size() < bytes) data.insert(data.end(), pattern.begin(), pattern.end());
    data.resize(bytes);
    return data;
  };
  // A row of a Bayer picture holds two of its colours: 8 pairs for 16 pixels.
  const auto bayer = [&](std::vector<std::uint8_t> even, std::vector<std::uint8_t> odd) {
    std::vector<std::uint8_t> data;
    for (int row = 0; row < 16; ++row) {
      const auto line = repeated(row % 2 == 0 ? even : odd, 16);
      data.insert(data.end(), line.begin(), line.end());
    }
    return data;
  };
  const std::map<std::string, std::vector<std::uint8_t>> pictures{
      {"rgba8", repeated({200, 100, 50, 255}, 1024)},
      {"bgra8", repeated({50, 100, 200, 255}, 1024)},
      {"rgb8", repeated({200, 100, 50}, 768)},
      {"bgr8", repeated({50, 100, 200}, 768)},
      {"bayer_rggb8", bayer({200, 100}, {100, 50})},
      {"bayer_bggr8", bayer({50, 100}, {100, 200})},
      {"bayer_gbrg8", bayer({100, 50}, {200, 100})},
      {"bayer_grbg8", bayer({100, 200}, {50, 100})},
      // BT.601: Y = 16 + 0.257 R + 0.504 G + 0.098 B = 123, U = 128 - 0.148 R - 0.291 G + 0.439 B = 91,
      // V = 128 + 0.439 R - 0.368 G - 0.071 B = 175.
      {"yuv422", repeated({91, 123, 175, 123}, 512)},
      {"yuv422_yuy2", repeated({123, 91, 123, 175}, 512)},
      {"yuyv", repeated({123, 91, 123, 175}, 512)}};
  for (const auto& [encoding, data] : pictures) {
    const RobotLog log = RobotLog::open(
        write([&](BagWriter& bag) { bag.image("/camera/image_raw", 1'000'000, encoding, 16, 16, data); }));
    const cv::Vec3b pixel = log.readFrame(0).image.at<cv::Vec3b>(8, 8);
    EXPECT_NEAR(pixel[0], 200, 3) << encoding;
    EXPECT_NEAR(pixel[1], 100, 3) << encoding;
    EXPECT_NEAR(pixel[2], 50, 3) << encoding;
  }
}

TEST_F(RobotLogTest, ReadsWhatRosbagCompressed) {
  const std::string plain = path("none.bag");
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    BagWriter bag(path(compression + ".bag"), compression);
    writeRawImages(bag);
    writeRest(bag);
    bag.close();
    const RobotLog log = RobotLog::open(path(compression + ".bag"));
    const RobotLog expected = RobotLog::open(plain);
    EXPECT_THAT(log.notes(), ::testing::IsEmpty());
    ASSERT_EQ(log.frameStamps(), expected.frameStamps()) << compression;
    EXPECT_EQ(cv::norm(log.readFrame(1).image, expected.readFrame(1).image, cv::NORM_INF), 0.0)
        << compression;
    EXPECT_EQ(log.odometry().size(), expected.odometry().size());
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
