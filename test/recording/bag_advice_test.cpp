// Tests C1. What bag_info advises on bags of other people, and logs of JdeRobot.
#include "common/recording/bag_advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/recording/jderobot_log.h"
#include "recording/bag_writer.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BagAdviceTest : public ::testing::Test {
 protected:
  void images(BagWriter& bag, const std::string& topic, int count) const {
    for (int i = 0; i < count; ++i) {
      bag.image(topic, 1'000'000 + 100'000 * i, "mono8", 16, 16, std::vector<std::uint8_t>(256, 7), "eye");
    }
  }
  void odometry(BagWriter& bag) const {
    bag.odometry("/odom", 900'000, 0.0, 0.0, 0.0);
    bag.odometry("/odom", 2'000'000, 1.0, 0.0, 0.0);
  }
  BagAdvice advise(const RobotLogOptions& wanted = {}) const { return adviseOn(BagFile(file_), wanted); }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "log.bag";
};

TEST_F(BagAdviceTest, NamesTheTopicsOfABagWithSeveralCameras) {
  {
    BagWriter bag(file_);
    images(bag, "/front/image", 2);
    images(bag, "/rear/image", 3);
    bag.cameraInfo("/rear/camera_info", 1'000'000, 16, 16, 20.0);
    bag.cameraInfo("/front/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_link", "eye", 0.0, 0.0, 0.4, 0.0);
    odometry(bag);
    bag.close();
  }
  const BagAdvice advice = advise();
  EXPECT_TRUE(advice.log) << advice.problem;
  // The camera with most images, and the calibration beside it without a key.
  EXPECT_THAT(advice.arguments, ElementsAre("--ReplayServer.Topics.Image=/rear/image"));
  EXPECT_THAT(advice.roles[0].candidates, ElementsAre("/rear/image", "/front/image"));
  EXPECT_EQ(RobotLog::open(file_, advice.options).frameStamps().size(), 3u) << "the advice alone plays it";
  RobotLogOptions wanted;
  EXPECT_EQ(applyTopics("image=/front/image", wanted), "");
  EXPECT_THAT(advise(wanted).arguments, ElementsAre("--ReplayServer.Topics.Image=/front/image"));
  EXPECT_EQ(applyTopics("image=/nothing", wanted), "");
  EXPECT_THAT(advise(wanted).problem,
              HasSubstr("the bag has no topic /nothing of that type: name one of /rear/image"));
}

// A robot's second camera may have an image more than its first: the memory's own is the first.
TEST_F(BagAdviceTest, OfCamerasWithNearlyAsManyImagesTheFirstByNamePlays) {
  {
    BagWriter bag(file_);
    images(bag, "/cameraB/image_raw", 30);
    images(bag, "/cameraA/image_raw", 29);
    bag.close();
  }
  EXPECT_THAT(advise().roles[0].candidates, ElementsAre("/cameraA/image_raw", "/cameraB/image_raw"));
}

// Unpacking a compressed bag takes most of the time: advice and recording share one opening of the file.
TEST_F(BagAdviceTest, OpensTheFileOnce) {
  {
    BagWriter bag(file_, "bz2");
    images(bag, "/camera/image_raw", 2);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_link", "eye", 0.0, 0.0, 0.4, 0.0);
    odometry(bag);
    bag.close();
  }
  BagFile bag(file_);
  fs::remove(file_);
  const BagAdvice advice = adviseOn(std::move(bag), {});
  ASSERT_TRUE(advice.log) << advice.problem;
  EXPECT_EQ(advice.log->readFrame(1).image.rows, 16);
}

TEST_F(BagAdviceTest, SaysWhatIsNeededForEachMissingRole) {
  {
    BagWriter bag(file_);
    images(bag, "/camera/image_raw", 2);
    bag.close();
  }
  BagAdvice advice = advise();
  EXPECT_FALSE(advice.log);
  ASSERT_EQ(advice.roles.size(), 4u);
  EXPECT_THAT(advice.roles[0].needed, IsEmpty());
  EXPECT_THAT(advice.roles[1].needed, HasSubstr("ReplayServer.Camera.FieldOfView_deg"));
  EXPECT_THAT(advice.roles[2].needed, HasSubstr("nav_msgs/Odometry"));
  EXPECT_THAT(advice.roles[3].needed, HasSubstr("ReplayServer.Camera.Fixed=yes"));
  EXPECT_THAT(advice.problem, HasSubstr("calibration: needed"));
}

TEST_F(BagAdviceTest, PlaysACameraWithoutCalibrationOnTransformsAlone) {
  {
    BagWriter bag(file_);
    images(bag, "/camera/image_raw", 2);
    bag.transform("/tf", 900'000, "odom", "base_link", 0.0, 0.0, 0.0, 0.0);
    bag.transform("/tf", 1'300'000, "odom", "base_link", 1.0, 0.0, 0.0, 0.5);
    bag.close();
  }
  EXPECT_THAT(advise().problem, HasSubstr("FieldOfView_deg"));
  RobotLogOptions wanted;
  wanted.fov_rad = degToRad(90.0);
  EXPECT_THAT(advise(wanted).problem, HasSubstr("the camera's pose is unknown"));
  EXPECT_THAT(advise(wanted).roles.back().needed, HasSubstr("ReplayServer.Camera.Fixed=yes"));
  wanted.fixed_camera = true;
  const BagAdvice advice = advise(wanted);
  ASSERT_TRUE(advice.log) << advice.problem;
  const RobotLog log = RobotLog::open(file_, advice.options);
  EXPECT_FALSE(log.knowsCameraPose());
  ASSERT_EQ(log.odometry().size(), 2u);
  EXPECT_NEAR(log.odometry()[1].T_odom_robot.theta, 0.5, 1e-12);
}

TEST_F(BagAdviceTest, PicksTheOdometryThatAloneIsInItsFrame) {
  const auto write = [&](const std::string& other_frame) {
    BagWriter bag(file_);
    images(bag, "/camera/image_raw", 2);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_link", "eye", 0.0, 0.0, 0.4, 0.0);
    for (const std::int64_t stamp_us : {900'000, 2'000'000}) {
      bag.odometry("/ekf", stamp_us, 7.0, 0.0, 0.0, other_frame);
      bag.odometry("/ekf", stamp_us + 50'000, 7.0, 0.0, 0.0, other_frame);
      bag.odometry("/wheels", stamp_us, 3.0, 0.0, 0.0, "/odom");
    }
    bag.close();
  };
  write("map");
  const BagAdvice advice = advise();
  EXPECT_TRUE(advice.log) << advice.problem;
  EXPECT_THAT(advice.arguments, ElementsAre("--ReplayServer.Topics.Odometry=/wheels"));
  EXPECT_EQ(advice.roles[2].note, "/ekf (map -> ), /wheels (odom -> )");
  const RobotLog log = RobotLog::open(file_);
  EXPECT_EQ(log.topics().odometry, "/wheels") << "also without advice";
  EXPECT_THAT(log.notes(), Contains(HasSubstr("the odometry is topic /wheels, of /ekf (map -> )")));
  write("odom");
  EXPECT_THAT(advise().problem, HasSubstr("which of /ekf (odom -> ), /wheels (odom -> ) is meant"));
  EXPECT_THAT([&] { RobotLog::open(file_); },
              testing::ThrowsMessage<RecordingError>(
                  HasSubstr("several topics could be the odometry: /ekf (odom -> ), /wheels (odom -> )")));
  RobotLogOptions wanted;
  EXPECT_EQ(applyTopics("odometry=/ekf", wanted), "");
  EXPECT_TRUE(advise(wanted).log);
}

TEST_F(BagAdviceTest, NamesAllLacksAtOnce) {
  {
    BagWriter bag(file_);
    images(bag, "/camera/image_raw", 2);
    bag.close();
  }
  EXPECT_THAT(advise().problem,
              testing::AllOf(HasSubstr("calibration: needed"), HasSubstr("\nodometry: needed"),
                             HasSubstr("\ncamera pose: needed")));
  EXPECT_THAT([&] { RobotLog::open(file_); },
              testing::ThrowsMessage<RecordingError>(
                  testing::AllOf(HasSubstr("no calibration of the camera"), HasSubstr("no odometry"),
                                 HasSubstr("the camera's pose is unknown"))));
}

TEST_F(BagAdviceTest, FindsTheTruthUnderUsualAndGivenNames) {
  const auto write = [&](const std::string& topic, bool as_odometry) {
    BagWriter bag(file_);
    images(bag, "/camera/image_raw", 2);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 16, 16, 20.0);
    bag.transform("/tf_static", 1'000'000, "base_link", "eye", 0.0, 0.0, 0.4, 0.0);
    odometry(bag);
    for (const std::int64_t stamp_us : {1'000'000, 1'500'000}) {
      if (as_odometry) {
        bag.odometry(topic, stamp_us, 2.0, 1.0, 0.5, "odom");
      } else {
        bag.pose(topic, stamp_us, 2.0, 1.0, 0.5);
      }
    }
    bag.close();
  };
  for (const bool as_odometry : {false, true}) {
    write("/ground_truth", as_odometry);
    const RobotLog log = RobotLog::open(file_);
    EXPECT_EQ(log.topics().odometry, "/odom") << "the truth is no odometry";
    ASSERT_EQ(log.truth().size(), 2u);
    EXPECT_EQ(log.truth()[1].stamp_us, 1'500'000);
    EXPECT_NEAR(log.truth()[1].T_world_robot.theta, 0.5, 1e-12);
    EXPECT_EQ(advise().truth, "/ground_truth");
  }
  write("/mocap/robot", false);
  EXPECT_TRUE(RobotLog::open(file_).truth().empty());
  RobotLogOptions wanted;
  EXPECT_EQ(applyTopics("truth=/mocap/robot,images=/camera/image_raw", wanted), "");
  EXPECT_EQ(RobotLog::open(file_, wanted).truth().size(), 2u);
  EXPECT_THAT(replayArguments(wanted), ElementsAre("--ReplayServer.Topics.Image=/camera/image_raw"));
  wanted.truth_topic = "/mocap";
  EXPECT_THAT([&] { RobotLog::open(file_, wanted); },
              testing::ThrowsMessage<RecordingError>(HasSubstr("whose poses are /mocap/robot, /odom")));
}

TEST_F(BagAdviceTest, ReadsTopicsFromTheCommandLine) {
  RobotLogOptions options;
  EXPECT_EQ(applyTopics("", options), "");
  EXPECT_EQ(applyTopics("image=/a,camera_info=/b,odometry=/c,joints=/d,robot=r,camera=c,odom=o,pan=p,tilt=t",
                        options),
            "");
  EXPECT_EQ(options.image_topic + options.camera_info_topic + options.odometry_topic + options.joint_topic,
            "/a/b/c/d");
  EXPECT_EQ(options.robot_frame + options.camera_frame + options.odom_frame + options.pan_joint +
                options.tilt_joint,
            "rcopt");
  EXPECT_THAT(applyTopics("picture=/a", options),
              HasSubstr("\"picture=/a\" (must be ROLE=/topic with a role of image, "));
  EXPECT_THAT(applyTopics("image", options), HasSubstr("\"image\" (must be"));
  EXPECT_THAT(applyTopics("image=", options), HasSubstr("\"image=\" (must be"));
}

TEST_F(BagAdviceTest, TakesWhatTheBagLacksOfItsCameraFromTheCommandLine) {
  RobotLogOptions options;
  EXPECT_EQ(applyTopics("fov=62.5,image=/a,fixed=yes", options), "");
  EXPECT_NEAR(radToDeg(options.fov_rad), 62.5, 1e-9);
  EXPECT_TRUE(options.fixed_camera);
  EXPECT_THAT(replayArguments(options),
              ElementsAre("--ReplayServer.Topics.Image=/a", "--ReplayServer.Camera.FieldOfView_deg=62.5",
                          "--ReplayServer.Camera.Fixed=yes"));
  EXPECT_EQ(topicsText(options), "image=/a,fov=62.5,fixed=yes");
  EXPECT_EQ(topicsText({}), "");
  for (const char* wrong : {"fov=", "fov=0.5", "fov=180", "fov=60x", "fov=nan"}) {
    EXPECT_THAT(applyTopics(wrong, options),
                HasSubstr("\" (must be the camera's horizontal field of view, 1..179 degrees)"))
        << wrong;
  }
  EXPECT_THAT(applyTopics("fixed=maybe", options), HasSubstr("\"fixed=maybe\" (must be fixed=yes"));
}

class JdeRobotLogTest : public ::testing::Test {
 protected:
  JdeRobotLogTest() {
    fs::create_directories(root() / "images/camera1");
    fs::create_directories(root() / "encoders/encoder1");
    write("images/camera1/cameraData.jde", "0\n100\nabc\n200\r\n");
    write("images/camera1/0.png", "png");
    write("images/camera1/100.jpg", "jpg");
    write("encoders/encoder1/encoderData.jde", "50\n150\n160\n");
    encoders(50, {1000.0F, -500.0F, 90.0F, 0.0F, 1.0F});
    encoders(150, {1100.0F, -500.0F, 180.0F, -1.0F, 0.0F});
    write("encoders/encoder1/160", "short");
  }
  fs::path root() const { return folder_.path() / "log"; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(root() / name, std::ios::binary) << text;
  }
  void encoders(int ms, std::vector<float> values) const {
    std::string bytes(values.size() * sizeof(float), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    write("encoders/encoder1/" + std::to_string(ms), bytes);
  }
  TemporaryFolder folder_;
};

TEST_F(JdeRobotLogTest, ReadsImagesAndEncoders) {
  const JdeRobotLog log = readJdeRobotLog(root(), 1);
  ASSERT_EQ(log.images.size(), 2u);
  EXPECT_EQ(log.images[0].format, "png");
  EXPECT_EQ(log.images[1].stamp_us, 100'000);
  EXPECT_EQ(log.images[1].format, "jpeg");
  ASSERT_EQ(log.odometry.size(), 2u);
  // Millimetres and degrees become metres and radians.
  EXPECT_NEAR(log.odometry[0].x_m, 1.0, 1e-6);
  EXPECT_NEAR(log.odometry[0].y_m, -0.5, 1e-6);
  EXPECT_NEAR(log.odometry[0].theta_rad, degToRad(90.0), 1e-6);
  EXPECT_THAT(log.notes, ElementsAre(HasSubstr("1 lines are no number"),
                                     HasSubstr("1 images that cameraData.jde names are not there"),
                                     HasSubstr("1 samples are left out (expected files of 20 bytes")));
}

TEST_F(JdeRobotLogTest, SaysWhatIsMissing) {
  try {
    readJdeRobotLog(root(), 2);
    FAIL() << "there is no camera 2";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("images/camera2/cameraData.jde"));
  }
  fs::remove_all(root() / "encoders");
  EXPECT_THAT(readJdeRobotLog(root(), 1).notes,
              Contains(HasSubstr("no odometry (expected encoder1/encoderData.jde)")));
  std::size_t wrong = 0;
  EXPECT_THAT(parseJdeStamps("5\n-1\n99999999999999999999\n7 \n", wrong), ElementsAre(5, 7));
  EXPECT_EQ(wrong, 2u);
}

}  // namespace
}  // namespace vismem
