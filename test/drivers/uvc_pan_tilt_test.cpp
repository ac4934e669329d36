// The driver of cameras with pan-tilt motors, with cameras on umockdev, and the message of each failure.
#include "drivers/pantilt_uvc/uvc_pan_tilt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>

#include "common/geometry/angles.h"
#include "support/emulated_camera.h"
#include "support/eventually.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr int kDegree = 3600;

EmulatedCamera::Description absolute() {
  EmulatedCamera::Description description;
  description.controls = {
      {V4L2_CID_PAN_ABSOLUTE, "Pan, Absolute", 1, -40 * kDegree, 40 * kDegree, kDegree, 2 * kDegree, false},
      {V4L2_CID_TILT_ABSOLUTE, "Tilt, Absolute", 1, -20 * kDegree, 20 * kDegree, kDegree, 0, false}};
  return description;
}

EmulatedCamera::Description orbit() {
  EmulatedCamera::Description description;
  description.orbit = true;
  return description;
}

class UvcPanTiltTest : public testing::Test {
 protected:
  PanTiltUnit& unit(const std::string& keys = "") {
    if (!unit_) {
      const auto properties = Properties::parse("Device=/dev/video0\n" + keys, "test.cfg");
      ConfigReader config(properties);
      unit_ = makeUvcPanTilt(config);
      config.finish();
    }
    return *unit_;
  }
  PortReply position(double pan_deg, double tilt_deg) {
    return unit().command({PanTiltCommand::Kind::kPosition, degToRad(pan_deg), degToRad(tilt_deg), 0.0, 0.0});
  }
  std::string waitingFor() { return unit().samplesSince(std::numeric_limits<StampUs>::max(), 0ms).message; }
  std::string condition() { return unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms).message; }
  PanTiltSample newest() {
    const auto batch = unit().samplesSince(std::numeric_limits<StampUs>::min(), 100ms);
    return batch.samples.empty() ? PanTiltSample() : batch.samples.back();
  }

  std::unique_ptr<PanTiltUnit> unit_;
};

TEST_F(UvcPanTiltTest, BeginsWhereTheCameraLooks) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  EXPECT_NEAR(radToDeg(newest().pan_rad), -2.0, 1e-9) << "V4L2 counts to the right";
  EXPECT_EQ(camera.timesSet(V4L2_CID_PAN_ABSOLUTE), 0) << "and is left there";
  EXPECT_NEAR(radToDeg(unit().limits().max_pan_rad), 40.0, 1e-9) << "of the 60 configured";
  EXPECT_NEAR(radToDeg(unit().limits().min_tilt_rad), -20.0, 1e-9);
}

TEST_F(UvcPanTiltTest, LeadsTheCameraToItsCommand) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  ASSERT_TRUE(position(30.0, 10.0).ok());
  EXPECT_TRUE(eventually([&] {
    return camera.control(V4L2_CID_PAN_ABSOLUTE) == -30 * kDegree &&
           camera.control(V4L2_CID_TILT_ABSOLUTE) == 10 * kDegree;
  }));
  EXPECT_GT(camera.timesSet(V4L2_CID_PAN_ABSOLUTE), 5) << "32 degrees at 60 a second";
}

TEST_F(UvcPanTiltTest, HasItsOwnSignsAndZero) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit("Pan.Inverted=yes\nTilt.Zero_deg=5\n").start().message, "");
  ASSERT_TRUE(position(20.0, 10.0).ok());
  EXPECT_TRUE(eventually([&] {
    return camera.control(V4L2_CID_PAN_ABSOLUTE) == 20 * kDegree &&
           camera.control(V4L2_CID_TILT_ABSOLUTE) == 5 * kDegree;
  }));
}

TEST_F(UvcPanTiltTest, StandsWhenStopped) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  ASSERT_TRUE(unit().command({PanTiltCommand::Kind::kVelocity, 0.0, 0.0, degToRad(20.0), 0.0}).ok());
  EXPECT_TRUE(eventually([&] { return camera.control(V4L2_CID_PAN_ABSOLUTE) < -3 * kDegree; }));
  unit().stop();
  EXPECT_GT(camera.control(V4L2_CID_PAN_ABSOLUTE), -35 * kDegree) << "the end of its way was 40 to the left";
  EXPECT_EQ(position(1.0, 1.0).message, "the pan-tilt unit is stopped");
}

TEST_F(UvcPanTiltTest, ReportsACameraThatDoesNotFollow) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  camera.jam(true);
  ASSERT_TRUE(position(8.0, 4.0).ok());
  EXPECT_TRUE(eventually([&] {
    return condition() == "the camera does not follow (jammed?): pan is 10 deg off, tilt is 4 deg off";
  })) << condition();
  camera.jam(false);
  ASSERT_TRUE(position(0.0, 0.0).ok());
  EXPECT_TRUE(eventually([&] { return condition().empty(); })) << condition();
}

TEST_F(UvcPanTiltTest, ComesBackAfterItWasPulledOut) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  camera.unplug();
  EXPECT_TRUE(eventually([&] { return waitingFor() == "/dev/video0: no such device"; })) << waitingFor();
  EXPECT_EQ(position(1.0, 1.0).message, "/dev/video0: no such device");
  camera.plugIn();
  EXPECT_TRUE(eventually([&] { return position(10.0, 0.0).ok(); }));
  EXPECT_TRUE(eventually([&] { return camera.control(V4L2_CID_PAN_ABSOLUTE) == -10 * kDegree; }));
}

TEST_F(UvcPanTiltTest, CountsTheStepsOfAnOrbit) {
  EmulatedCamera camera(orbit());
  ASSERT_TRUE(unit("ResetTakes_s=0.05\n").start().ok());
  ASSERT_TRUE(eventually([&] { return position(0.0, 0.0).ok(); }));
  EXPECT_EQ(camera.timesSet(V4L2_CID_PAN_RESET), 1);
  EXPECT_EQ(camera.timesSet(V4L2_CID_TILT_RESET), 1);
  ASSERT_TRUE(position(30.0, -10.0).ok());
  EXPECT_TRUE(eventually([&] {
    return camera.turned(V4L2_CID_PAN_RELATIVE) == -30 * 64 &&
           camera.turned(V4L2_CID_TILT_RELATIVE) == -10 * 64;
  })) << camera.turned(V4L2_CID_PAN_RELATIVE);
  EXPECT_TRUE(eventually([&] { return std::abs(radToDeg(newest().pan_rad) - 30.0) < 1e-9; }));
}

TEST_F(UvcPanTiltTest, RefusesWhileAnOrbitFindsItsZero) {
  EmulatedCamera camera(orbit());
  const PortReply reply = unit("ResetTakes_s=1\n").start();
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, "/dev/video0: finds its zero");
  EXPECT_EQ(position(1.0, 1.0).message, "/dev/video0: finds its zero");
  camera.unplug();
  EXPECT_TRUE(eventually([&] { return waitingFor() == "/dev/video0: no such device"; })) << waitingFor();
  camera.plugIn();
  EXPECT_TRUE(eventually([&] { return position(1.0, 1.0).ok(); }));
  EXPECT_EQ(camera.timesSet(V4L2_CID_PAN_RESET), 2);
}

TEST_F(UvcPanTiltTest, SaysWhatCannotTurn) {
  EmulatedCamera camera;
  EXPECT_EQ(unit().start().message, "/dev/video0: cannot turn (\"Emulated Camera\")");
  unit_.reset();
  EXPECT_EQ(unit("Motors=absolute\n").start().message,
            "/dev/video0: has no control of absolute angles (\"Emulated Camera\")");
  unit_.reset();
  EXPECT_EQ(unit("Motors=orbit\n").start().message,
            "/dev/video0: has not the motors of an Orbit (\"Emulated Camera\")");
}

TEST_F(UvcPanTiltTest, SaysWhatIsWrongWithItsRanges) {
  auto description = absolute();
  description.controls[0].maximum = description.controls[0].minimum;
  {
    EmulatedCamera camera(description);
    EXPECT_EQ(unit().start().message, "/dev/video0: reports an invalid range");
    unit_.reset();
  }
  EmulatedCamera camera(absolute());
  EXPECT_EQ(unit("Pan.Minimum_deg=50\n").start().message,
            "/dev/video0: nothing of the configured limits is within the camera's own");
}

TEST_F(UvcPanTiltTest, ReportsErrorsOfTheCamera) {
  EmulatedCamera camera(absolute());
  ASSERT_EQ(unit().start().message, "");
  camera.fail(VIDIOC_G_CTRL, EIO);
  EXPECT_TRUE(eventually([&] {
    return waitingFor() == "/dev/video0: does not report its angles: Input/output error";
  })) << waitingFor();
  camera.fail(VIDIOC_G_CTRL, 0);
  EXPECT_TRUE(eventually([&] { return position(20.0, 0.0).ok(); }));
  camera.fail(VIDIOC_S_EXT_CTRLS, EPROTO);
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(position(-20.0, 0.0));
    return waitingFor() == "/dev/video0: does not turn: Protocol error";
  })) << waitingFor();
  camera.fail(VIDIOC_S_EXT_CTRLS, EBUSY);
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(position(20.0, 0.0));
    return waitingFor() == "/dev/video0: another program uses it";
  })) << waitingFor();
  camera.fail(VIDIOC_S_EXT_CTRLS, 0);
  EXPECT_TRUE(eventually([&] { return position(1.0, 1.0).ok(); }));
}

TEST(UvcOrbit, SaysWhenItDoesNotReset) {
  EmulatedCamera camera(orbit());
  camera.fail(VIDIOC_S_CTRL, EIO);
  const auto properties = Properties::parse("Device=/dev/video0\n", "test.cfg");
  ConfigReader config(properties);
  EXPECT_EQ(makeUvcPanTilt(config)->start().message,
            "/dev/video0: does not go to its zero: Input/output error");
}

TEST(UvcKeys, AreChecked) {
  const auto properties = Properties::parse("Motors=big\nPan.Minimum_deg=70\nResetTakes_s=-1\n", "r.cfg");
  ConfigReader config(properties);
  makeUvcPanTilt(config);
  std::string all;
  for (const Problem& problem : config.allProblems()) all += problem.text() + "\n";
  EXPECT_THAT(all, HasSubstr("missing key \"Device\" (must be the camera's device, such as /dev/video0)"));
  EXPECT_THAT(all, HasSubstr("r.cfg:1: Motors = big"));
  EXPECT_THAT(all, HasSubstr("r.cfg:2: Pan.Minimum_deg = 70 (must be less than Pan.Maximum_deg)"));
  EXPECT_THAT(all, HasSubstr("r.cfg:3: ResetTakes_s = -1 (must be 0..60)"));
}

}  // namespace
}  // namespace vismem
