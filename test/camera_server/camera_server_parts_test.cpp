// The parts of camera_server without Ice: calibration files, rotated images, lens, health, configuration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>

#include "camera_server/app/camera_drivers.h"
#include "camera_server/app/camera_health.h"
#include "camera_server/app/config.h"
#include "camera_server/core/camera_info.h"
#include "camera_server/core/orientation.h"
#include "camera_server/core/prepared_camera.h"
#include "common/config/config_error.h"
#include "common/process/log.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// As camera_calibration writes it.
const std::string kCameraInfo = R"(image_width: 640
image_height: 480
camera_name: head_camera
camera_matrix:
  rows: 3
  cols: 3
  data: [520.5, 0. , 320.25,
         0. , 521.5, 240.75,
         0. , 0. , 1. ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.1, -0.2, 0.001, -0.002, 0.05]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [520.5, 0, 320.25, 0, 0, 521.5, 240.75, 0, 0, 0, 1, 0]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string problemOf(const std::string& text) {
  try {
    parseCameraInfo(text, "lens.yaml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CameraInfo, IsReadAsRosWritesIt) {
  const CameraIntrinsics lens = parseCameraInfo(kCameraInfo, "lens.yaml");
  EXPECT_EQ(lens, (CameraIntrinsics{640, 480, 520.5, 521.5, 320.25, 240.75, 0.1, -0.2, 0.001, -0.002, 0.05}));
}

TEST(CameraInfo, UnderstandsTheVariantsOfDistortion) {
  const std::string five = "data: [0.1, -0.2, 0.001, -0.002, 0.05]";
  EXPECT_EQ(parseCameraInfo(replaced(kCameraInfo, five, "data: [0.1, -0.2, 0, 0]"), "").k3, 0.0);
  EXPECT_FALSE(parseCameraInfo(replaced(kCameraInfo, five, "data: []"), "").hasDistortion());
  std::string rational = replaced(kCameraInfo, "plumb_bob", "rational_polynomial");
  EXPECT_EQ(parseCameraInfo(replaced(rational, five, "data: [0.1, 0, 0, 0, 0.3, 0, 0, 0]"), "").k3, 0.3);
  EXPECT_EQ(problemOf(replaced(rational, five, "data: [0.1, 0, 0, 0, 0, 0.1, 0, 0]")),
            "lens.yaml:12: distortion_coefficients after the first 5 must be 0");
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "plumb_bob", "equidistant")),
            "lens.yaml:10: distortion_model equidistant (must be plumb_bob, or rational_polynomial without "
            "k4, k5, k6)");
}

TEST(CameraInfo, NamesFileLineAndRule) {
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "image_width: 640\n", "")),
            "lens.yaml: missing key \"image_width\"");
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "640", "wide")),
            "lens.yaml:1: image_width must be a whole number, 1..16384");
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "520.5, 0. ,", "520.5,")),
            "lens.yaml:5: camera_matrix must have 9 numbers");
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "521.5", "much")),
            "lens.yaml:8: camera_matrix must hold numbers");
  EXPECT_EQ(problemOf(replaced(kCameraInfo, "521.5", ".nan")),
            "lens.yaml:8: camera_matrix must hold numbers");
  EXPECT_THAT(problemOf(replaced(kCameraInfo, "521.5", "-5")),
              HasSubstr("lens.yaml:5: focal length 520.5, -5 px"));
  EXPECT_THAT(problemOf("a: [1, 2"), HasSubstr("lens.yaml:1:"));
  EXPECT_THAT(problemOf(""), HasSubstr("must hold keys such as image_width"));
  EXPECT_THAT(problemOf(std::string("\x00\xff\x13[", 4)), HasSubstr("lens.yaml"));
}

/// Every pixel is its own: its column and row.
cv::Mat indexPicture() {
  cv::Mat image(3, 4, CV_8UC3);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 4; ++u)
      image.at<cv::Vec3b>(v, u) = cv::Vec3b(static_cast<uchar>(u), static_cast<uchar>(v), 0);
  }
  return image;
}

TEST(Orientation, TurnsClockwiseThenMirrors) {
  const cv::Mat turned = oriented(indexPicture(), {1, false});
  ASSERT_EQ(turned.size(), cv::Size(3, 4));
  EXPECT_EQ(turned.at<cv::Vec3b>(0, 2), cv::Vec3b(0, 0, 0)) << "the top left comes to the top right";
  const cv::Mat both = oriented(indexPicture(), {1, true});
  EXPECT_EQ(both.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(oriented(indexPicture(), {2, false}).at<cv::Vec3b>(2, 3), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(oriented(indexPicture(), {3, false}).at<cv::Vec3b>(3, 0), cv::Vec3b(0, 0, 0));
}

TEST(Orientation, LeavesTheGivenPictureAsItIs) {
  for (int turns = 0; turns < 4; ++turns) {
    cv::Mat picture = (cv::Mat_<std::uint8_t>(2, 2) << 1, 2, 3, 4);
    const cv::Mat before = picture.clone();
    Orientation orientation;
    orientation.quarter_turns = turns;
    orientation.mirror = true;
    oriented(picture, orientation);
    EXPECT_EQ(cv::norm(picture, before, cv::NORM_INF), 0.0) << turns << " quarter turns";
  }
}

TEST(Orientation, TheCameraModelTurnsWithThePicture) {
  const CameraIntrinsics k{64, 48, 50, 55, 30, 25, 0.1, -0.05, 0.01, -0.02, 0.03};
  const Eigen::Vector3d p(0.2, -0.3, 1.0);
  for (int turns = 0; turns < 4; ++turns) {
    for (const bool mirror : {false, true}) {
      const Orientation orientation{turns, mirror};
      // The pixel of a point, moved with the image step by step ...
      Eigen::Vector2d px = distortPixel(k, *projectToIdeal(k, p));
      Eigen::Vector3d direction = p;
      int width = k.width, height = k.height;
      for (int i = 0; i < turns; ++i) {
        px = Eigen::Vector2d(height - 1 - px.y(), px.x());
        direction = Eigen::Vector3d(-direction.y(), direction.x(), direction.z());
        std::swap(width, height);
      }
      if (mirror) {
        px.x() = width - 1 - px.x();
        direction.x() = -direction.x();
      }
      // ... is where the turned model shows it.
      const CameraIntrinsics turned = oriented(k, orientation);
      EXPECT_EQ(turned.width, width);
      EXPECT_NEAR((distortPixel(turned, *projectToIdeal(turned, direction)) - px).norm(), 0.0, 1e-9)
          << turns << mirror;
    }
  }
}

/// Gives one frame of a size, then says it waits.
class OneFrame : public FrameSource {
 public:
  OneFrame(int width, int height) : width_(width), height_(height) {}
  FrameCapabilities capabilities() const override { return {"one", width_, height_, 10.0, true}; }
  PortReply configure(const FrameRequest& request) override {
    asked = request;
    return PortReply::accepted();
  }
  PortReply start() override { return PortReply::accepted(); }
  FrameResult next(std::chrono::milliseconds) override {
    Frame frame;
    frame.image = cv::Mat(height_, width_, CV_8UC3, cv::Scalar::all(9));
    frame.intrinsics = intrinsicsFromFieldOfView(width_, height_, 1.0);
    frame.T_robot_camera = Pose3::Identity();
    return {SourceState::kRunning, std::move(frame), {}};
  }
  void stop() override {}
  FrameRequest asked;

 private:
  int width_, height_;
};

TEST(PreparedCamera, ScalesTheCalibrationToThePicture) {
  Lens lens;
  lens.calibrated = parseCameraInfo(kCameraInfo, "");
  PreparedCamera camera(std::make_unique<OneFrame>(320, 240), {}, lens);
  const CameraIntrinsics k = camera.next(0ms).frame->intrinsics;
  EXPECT_EQ(k.width, 320);
  EXPECT_DOUBLE_EQ(k.fx, 260.25);
  // The picture's corner stays: (320.25 + 0.5) / 2 - 0.5.
  EXPECT_DOUBLE_EQ(k.cx, 159.875);
  EXPECT_DOUBLE_EQ(k.k1, 0.1);
  EXPECT_EQ(camera.lensProblem(), "");
}

TEST(PreparedCamera, ACalibrationOfAnotherShapeIsAProblem) {
  Lens lens;
  lens.calibrated = parseCameraInfo(kCameraInfo, "");
  PreparedCamera camera(std::make_unique<OneFrame>(640, 360), {}, lens);
  const CameraIntrinsics own = camera.next(0ms).frame->intrinsics;
  EXPECT_EQ(own, intrinsicsFromFieldOfView(640, 360, 1.0));
  EXPECT_EQ(camera.lensProblem(), "the calibration is of 640x480 pictures, these have 640x360");
}

TEST(PreparedCamera, AsksForTheTurnedSize) {
  Lens lens;
  lens.horizontal_view_rad = 0.8;
  auto inner = std::make_unique<OneFrame>(64, 48);
  OneFrame& driver = *inner;
  PreparedCamera camera(std::move(inner), {3, false}, lens);
  camera.configure({240, 320, 30.0, true});
  EXPECT_EQ(driver.asked.width, 320);
  EXPECT_EQ(driver.asked.height, 240);
  EXPECT_FALSE(driver.asked.accept_native) << "what must be turned must be pixels";
  EXPECT_EQ(camera.capabilities().width, 48);
  EXPECT_FALSE(camera.capabilities().knows_camera_pose);
  const Frame frame = *camera.next(0ms).frame;
  EXPECT_EQ(frame.image.size(), cv::Size(48, 64));
  EXPECT_EQ(frame.intrinsics, intrinsicsFromFieldOfView(48, 64, 0.8));
  EXPECT_FALSE(frame.T_robot_camera);
}

class CameraHealthTest : public testing::Test {
 protected:
  void hear(const FrameResult& result, const std::string& lens = "") {
    health_.heard(result, lens, now_, 1'000'000'000);
  }
  std::string reason() { return status_.report().reason; }
  static FrameResult frame(const std::string& message = "") {
    Frame frame;
    frame.stamp_us = 999'990'000;
    return {SourceState::kRunning, std::move(frame), message};
  }

  std::ostringstream text_;
  Logger log_{"camera_server", LogLevel::kInfo, text_, [] { return std::string("now"); }};
  StatusBoard status_{"camera_server", "1", log_};
  CameraHealth health_{status_, "cameraA", 10.0};
  SteadyTime now_ = SteadyTime{} + 100s;
};

TEST_F(CameraHealthTest, ReportsWhatIsWrongAndThatItIsOver) {
  status_.serving();
  hear({SourceState::kWaiting, std::nullopt, "/dev/video0: no such file"});
  EXPECT_EQ(status_.report().state, RunState::kDegraded);
  EXPECT_THAT(reason(), HasSubstr("cameraA: /dev/video0: no such file"));
  hear(frame());
  EXPECT_EQ(status_.report().state, RunState::kRunning);
  hear({SourceState::kFinished, std::nullopt, "end of video a.avi"});
  EXPECT_THAT(reason(), HasSubstr("cameraA: end of video a.avi"));
  hear(frame(), "the calibration is of 640x480 pictures, these have 640x360");
  EXPECT_THAT(reason(), HasSubstr("cameraA: the calibration is of 640x480"));
}

TEST_F(CameraHealthTest, SilenceIsAFaultOnlyAfterItsPatience) {
  status_.serving();
  hear(frame());
  now_ += 1900ms;
  hear({SourceState::kWaiting, std::nullopt, ""});
  EXPECT_EQ(status_.report().state, RunState::kRunning);
  now_ += 200ms;
  hear({SourceState::kWaiting, std::nullopt, ""});
  EXPECT_THAT(reason(), HasSubstr("cameraA: no picture for over 2 s"));
}

TEST_F(CameraHealthTest, KeepsLostPicturesAmongTheErrorsAndCounts) {
  status_.serving();
  hear(frame("walk/7.jpg: is a JPEG file cut short"));
  const StatusReport report = status_.report();
  EXPECT_EQ(report.state, RunState::kRunning);
  ASSERT_EQ(report.errors.size(), 1U);
  EXPECT_EQ(report.errors[0].text, "cameraA: walk/7.jpg: is a JPEG file cut short");
  ASSERT_EQ(report.rates.size(), 1U);
  EXPECT_EQ(report.rates[0].name, "cameraA");
  ASSERT_EQ(report.latencies.size(), 1U);
  EXPECT_NEAR(report.latencies[0].figures.p50_s, 0.01, 0.001);
}

std::vector<std::string> problemsOf(const std::string& text) {
  const auto properties = Properties::parse(text, "a.cfg");
  ConfigReader config(properties);
  ConfigReader group = config.group("CameraServer");
  DriverRegistry<FrameSource> drivers;
  registerCameraDrivers(drivers);
  try {
    readCameraServerConfig(group, drivers);
    config.finish();
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(CameraServerConfig, SeveralCamerasEachWithItsOwnKeys) {
  EXPECT_THAT(problemsOf("CameraServer.Camera.cameraA.Driver=pattern\nCameraServer.Camera.cameraA.Bars=8\n"
                         "CameraServer.Camera.rear.Driver=files\nCameraServer.Camera.rear.Source=x\n"
                         "CameraServer.Camera.rear.Rotate_deg=180\nCameraServer.Camera.rear.Rate_hz=5\n"),
              IsEmpty());
}

TEST(CameraServerConfig, NamesEverythingThatIsWrong) {
  EXPECT_THAT(problemsOf(""),
              ElementsAre("a.cfg: missing key \"CameraServer.Camera.cameraA.Driver\" (must be a driver: "
                          "files, pattern, v4l2)"));
  EXPECT_THAT(problemsOf("CameraServer.Camera.cameraA.Driver=usb\n"),
              ElementsAre(HasSubstr("Driver = usb (unknown driver; must be one of: files, pattern, v4l2)")));
  EXPECT_THAT(problemsOf("CameraServer.Camera.cam/1.Driver=pattern\n"),
              ElementsAre(HasSubstr("a camera's name must be of letters, digits, _ and -")));
  const std::string camera = "CameraServer.Camera.cameraA.Driver=pattern\nCameraServer.Camera.cameraA.";
  EXPECT_THAT(problemsOf(camera + "Source=x\n"),
              ElementsAre(HasSubstr("a.cfg:2: unknown key \"CameraServer.Camera.cameraA.Source\"")));
  EXPECT_THAT(problemsOf(camera + "Rotate_deg=45\n"),
              ElementsAre(HasSubstr("must be one of: 0, 90, 180, 270")));
  EXPECT_THAT(problemsOf(camera + "Width_px=-1\n"),
              ElementsAre(HasSubstr("Width_px = -1 (must be 0..16384)")));
  EXPECT_THAT(problemsOf(camera + "Lens.Focal_px=500 500\n"),
              testing::Contains(HasSubstr("missing key \"CameraServer.Camera.cameraA.Lens.Centre_px\"")));
  EXPECT_THAT(problemsOf(camera + "Calibration=absent.yaml\n"), ElementsAre(HasSubstr("no such file")));
  const TemporaryFolder folder;
  std::ofstream(folder / "lens.yaml") << kCameraInfo;
  EXPECT_THAT(problemsOf(camera + "Calibration=" + (folder / "lens.yaml") + "\n"), IsEmpty());
  EXPECT_THAT(problemsOf(camera + "Calibration=" + (folder / "lens.yaml") +
                         "\nCameraServer.Camera.cameraA.HorizontalView_deg=50\n"),
              ElementsAre(HasSubstr("only one of Calibration, Lens.* and HorizontalView_deg")));
  std::ofstream(folder / "lens.yaml") << "image_width: 640\n";
  EXPECT_THAT(problemsOf(camera + "Calibration=" + (folder / "lens.yaml") + "\n"),
              ElementsAre((folder / "lens.yaml") + ": missing key \"image_height\""));
}

}  // namespace
}  // namespace vismem
