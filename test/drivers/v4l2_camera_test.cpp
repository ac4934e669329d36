// The driver of V4L2 cameras with cameras on umockdev: negotiation, images, and the message of each failure.
#include "drivers/camera_v4l2/v4l2_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/stat.h>

#include <fstream>

#include "common/drivers/host_clock.h"
#include "common/image_codec/image_codec.h"
#include "common/image_codec/jpeg_header.h"
#include "support/emulated_camera.h"
#include "support/eventually.h"
#include "support/file_permissions.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr char kPath[] = "/dev/video0";

std::unique_ptr<FrameSource> makeSource(const std::string& keys) {
  const auto properties = Properties::parse(keys, "test.cfg");
  ConfigReader config(properties);
  auto source = makeV4l2Camera(config);
  config.finish();
  return source;
}

class V4l2CameraTest : public testing::Test {
 protected:
  FrameSource& source(const std::string& keys = "") {
    if (!source_) source_ = makeSource(std::string("Device=") + kPath + "\n" + keys);
    return *source_;
  }
  Frame take() {
    FrameResult result;
    EXPECT_TRUE(eventually([&] { return (result = source().next(100ms)).frame.has_value(); }))
        << result.message;
    lost_ = result.message;
    return result.frame.value_or(Frame());
  }
  /// @return whether it says so while it waits.
  testing::AssertionResult waitsFor(const std::string& why) {
    std::string message;
    if (eventually([&] {
          const FrameResult result = source().next(20ms);
          if (!result.frame) message = result.message;
          return message == why;
        })) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << message;
  }

  std::unique_ptr<FrameSource> source_;
  std::string lost_;  ///< message of the last frame
};

TEST_F(V4l2CameraTest, ReportsWhatItAgreesOn) {
  EmulatedCamera camera;
  EXPECT_EQ(source().configure({320, 240, 30.0}).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(source().capabilities().name, "/dev/video0 (Emulated Camera, YUYV)");
  EXPECT_EQ(source().configure({1280, 720, 30.0}).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(source().capabilities().name, "/dev/video0 (Emulated Camera, MJPEG)");
  const PortReply adjusted = source().configure({330, 250, 25.0});
  EXPECT_EQ(adjusted.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(adjusted.message,
            "320x240, the nearest that the camera offers; 30 Hz, the nearest that the camera offers");
  EXPECT_EQ(source().capabilities().rate_hz, 30.0);
  source().start();
  EXPECT_EQ(take().image.size(), cv::Size(320, 240));
  EXPECT_EQ(source().configure({}).message, "the camera runs; stop it before it is configured");
}

TEST_F(V4l2CameraTest, RejectsAFormatThatTheCameraHasNot) {
  EmulatedCamera camera;
  const PortReply reply = source("Format=NV12\n").configure({});
  EXPECT_EQ(reply.kind, PortReply::Kind::kRejected);
  EXPECT_EQ(reply.message, "/dev/video0: offers no NV12 (it has: YUYV, MJPEG)");
}

TEST_F(V4l2CameraTest, RejectsACameraWhoseFormatsItDoesNotRead) {
  EmulatedCamera::Description description;
  description.modes = {{"H264", 640, 480, {30}}};
  EmulatedCamera camera(description);
  EXPECT_EQ(source().configure({}).message, "/dev/video0: offers no format that is read here (it has: H264)");
}

TEST_F(V4l2CameraTest, KeepsToSizesInSteps) {
  EmulatedCamera::Description description;
  description.modes = {{"GREY", 640, 480, {50}, true}};
  EmulatedCamera camera(description);
  EXPECT_EQ(source().configure({200, 100, 0.0}).message, "208x96, the nearest that the camera offers");
  EXPECT_EQ(source().configure({160, 112, 50.0}).message, "");
  source().start();
  EXPECT_EQ(take().image.size(), cv::Size(160, 112));
}

TEST_F(V4l2CameraTest, ReportsWhenTheCameraDoesNotKeepWhatItLists) {
  EmulatedCamera camera;
  camera.overrideSize(176, 144);
  EXPECT_EQ(source().configure({320, 240, 0.0}).message, "176x144, the nearest that the camera offers");
  source().start();
  EXPECT_EQ(take().image.size(), cv::Size(176, 144));
}

TEST_F(V4l2CameraTest, StampsWithTheKernelsClock) {
  EmulatedCamera camera;
  source("Delay_ms=100\n").configure({320, 240, 50.0});
  source().start();
  Frame last = take();
  for (int i = 0; i < 3; ++i) {
    const Frame frame = take();
    // The emulated kernel stamps at whole periods.
    const double periods = toSeconds(frame.stamp_us - last.stamp_us) * 50.0;
    EXPECT_NEAR(periods, std::round(periods), 0.05);
    EXPECT_NEAR(periods, static_cast<double>(frame.seq - last.seq), 0.05) << "gaps count";
    EXPECT_GE(hostClock_us() - frame.stamp_us, 100'000);
    last = frame;
  }
}

TEST_F(V4l2CameraTest, StampsByArrivalWhereTheKernelsClockIsUnknown) {
  EmulatedCamera camera;
  camera.setUnknownClock(true);
  source().configure({320, 240, 50.0});
  const StampUs before_us = hostClock_us();
  source().start();
  const Frame frame = take();
  EXPECT_GE(frame.stamp_us, before_us);
  EXPECT_LE(frame.stamp_us, hostClock_us());
}

TEST_F(V4l2CameraTest, PassesOnWhatWasCaptured) {
  EmulatedCamera camera;
  FrameRequest request{320, 240, 50.0, true};
  source("Format=MJPEG\n").configure(request);
  source().start();
  const Frame frame = take();
  camera.hush();
  ASSERT_TRUE(frame.native);
  EXPECT_TRUE(frame.image.empty());
  EXPECT_EQ(frame.native->format, NativeFormat::kJpeg);
  // Of frames after it the last is known byte for byte.
  std::shared_ptr<const NativeImage> newest = frame.native;
  while (const auto next = source().next(100ms).frame) newest = next->native;
  EXPECT_EQ(newest->bytes, camera.lastPicture());
}

TEST_F(V4l2CameraTest, GivesPixelsToWhoWantsThem) {
  EmulatedCamera camera;
  source("Format=MJPEG\n").configure({320, 240, 0.0});
  source().start();
  const Frame frame = take();
  ASSERT_EQ(frame.image.type(), CV_8UC3);
  const auto shade = frame.image.at<cv::Vec3b>(100, 100)[0];
  EXPECT_GE(shade, 39);
  EXPECT_LE(shade, 141);
}

TEST_F(V4l2CameraTest, MakesWholeFilesOfBareJpeg) {
  EmulatedCamera camera;
  camera.setBareJpeg(true);
  source("Format=MJPEG\n").configure({320, 240, 0.0, true});
  source().start();
  const Frame frame = take();
  ASSERT_TRUE(frame.native);
  EXPECT_EQ(readJpegHeader(frame.native->bytes).error, "");
  EXPECT_EQ(decodeImage(*frame.native).error, "");
}

TEST_F(V4l2CameraTest, ReportsOfPicturesThatWereLost) {
  EmulatedCamera camera;
  source().configure({320, 240, 50.0});
  source().start();
  take();
  camera.damageNext();
  EXPECT_TRUE(eventually([&] {
    take();
    return lost_ == "/dev/video0: a picture was damaged on its way";
  })) << lost_;
  camera.shortenNext();
  EXPECT_TRUE(eventually([&] {
    take();
    return lost_ == "/dev/video0: a picture has 76800 bytes of 153600";
  })) << lost_;
}

EmulatedCamera::Description withControls() {
  EmulatedCamera::Description description;
  description.controls = {{V4L2_CID_GAIN, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 255, 5, 10, false},
                          {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 3, 1, 3, false},
                          {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 1,
                           5000, 1, 157, false}};
  return description;
}

TEST_F(V4l2CameraTest, SetsControlsEachTimeTheCameraComes) {
  EmulatedCamera camera(withControls());
  source("Control.exposure_time_absolute=100\nControl.auto_exposure=1\nControl.gain=20\n").configure({});
  source().start();
  take();
  EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_AUTO), 1);
  EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_ABSOLUTE), 100);
  EXPECT_EQ(camera.control(V4L2_CID_GAIN), 20);
  camera.unplug();
  EXPECT_TRUE(waitsFor("/dev/video0: no such device"));
  camera.setControl(V4L2_CID_GAIN, 0);
  camera.plugIn();
  take();
  EXPECT_EQ(camera.control(V4L2_CID_GAIN), 20);
}

TEST_F(V4l2CameraTest, ReportsControlsThatCannotBe) {
  const std::pair<std::string, std::string> cases[] = {
      {"Control.gian=5\n", "no control gian (it has gain, auto_exposure, exposure_time_absolute)"},
      {"Control.gain=300\n", "gain = 300 (must be 0..255)"},
      {"Control.gain=12\n", "gain became 10, not 12 (its step is 5)"}};
  EmulatedCamera camera(withControls());
  for (const auto& [keys, message] : cases) {
    source_.reset();
    source(keys).start();
    EXPECT_TRUE(waitsFor("/dev/video0: " + message));
  }
  camera.fail(VIDIOC_S_CTRL, EACCES);
  EXPECT_TRUE(waitsFor("/dev/video0: gain cannot be set now (it is read-only, or an automatic is on)"));
  camera.fail(VIDIOC_S_CTRL, EIO);
  EXPECT_TRUE(waitsFor("/dev/video0: gain = 12: Input/output error"));
}

TEST_F(V4l2CameraTest, WaitsForOneThatIsAbsentAndGoesOnWhenItReturns) {
  EmulatedCamera camera;
  camera.unplug();
  const PortReply reply = source().configure({320, 240, 50.0});
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message,
            "size and rate will be agreed on when the camera is there: /dev/video0: no such device");
  source().start();
  EXPECT_TRUE(waitsFor("/dev/video0: no such device"));
  camera.plugIn();
  const Frame first = take();
  EXPECT_EQ(first.image.size(), cv::Size(320, 240));
  camera.unplug();
  EXPECT_TRUE(waitsFor("/dev/video0: no such device"));
  camera.plugIn();
  const Frame again = take();
  EXPECT_GT(again.seq, first.seq);
  EXPECT_GT(again.stamp_us, first.stamp_us);
}

/// An error of a request, and what is said of it. The camera itself is still there.
struct Failure {
  const char* name;
  unsigned long request;
  int error;
  const char* message;
};

class V4l2Failures : public testing::TestWithParam<Failure> {};

INSTANTIATE_TEST_SUITE_P(
    OfRequests, V4l2Failures,
    testing::Values(Failure{"NoVideoDevice", VIDIOC_QUERYCAP, ENOTTY, "not a video device"},
                    Failure{"NoAnswer", VIDIOC_QUERYCAP, EIO, "Input/output error"},
                    Failure{"BusyFormat", VIDIOC_S_FMT, EBUSY, "another program uses it"},
                    Failure{"NoFormat", VIDIOC_S_FMT, EINVAL, "no format can be set: Invalid argument"},
                    Failure{"BusyBuffers", VIDIOC_REQBUFS, EBUSY, "another program uses it"},
                    Failure{"NoMemory", VIDIOC_REQBUFS, ENOMEM, "gives no buffers: Cannot allocate memory"},
                    Failure{"NoBuffer", VIDIOC_QUERYBUF, EINVAL, "describes no buffer: Invalid argument"},
                    Failure{"NotQueued", VIDIOC_QBUF, EIO, "takes no buffer back: Input/output error"},
                    Failure{"NoBandwidth", VIDIOC_STREAMON, ENOSPC,
                            "the USB bus has no bandwidth left for this size and rate"},
                    Failure{"NoStream", VIDIOC_STREAMON, EPROTO, "does not begin to stream: Protocol error"},
                    Failure{"NoPicture", VIDIOC_DQBUF, EIO, "gives no picture: Input/output error"},
                    Failure{"Unplugged", VIDIOC_DQBUF, ENODEV, "was unplugged"}),
    [](const auto& which) { return which.param.name; });

TEST_P(V4l2Failures, AreReportedAndOvercome) {
  EmulatedCamera camera;
  const auto source = makeSource(std::string("Device=") + kPath + "\n");
  source->start();
  camera.fail(GetParam().request, GetParam().error);
  const std::string expected = std::string(kPath) + ": " + GetParam().message;
  std::string message;
  EXPECT_TRUE(eventually([&] {
    // Requests of the start occur again only after a loss of the running stream.
    const FrameResult result = source->next(20ms);
    if (result.frame) {
      source->stop();
      source->start();
    } else if (!result.message.empty()) {
      message = result.message;
    }
    return message == expected;
  })) << message;
  camera.fail(GetParam().request, 0);
  EXPECT_TRUE(eventually([&] { return source->next(100ms).frame.has_value(); }));
}

TEST_F(V4l2CameraTest, TakesAnErrorForAnUnplugWhereNothingAnswersAnyMore) {
  // uvcvideo answers EINVAL or EIO while it clears up after an unplug.
  EmulatedCamera camera;
  source().start();
  take();
  camera.fail(VIDIOC_QUERYCAP, ENODEV);
  camera.fail(VIDIOC_DQBUF, EINVAL);
  EXPECT_TRUE(eventually([&] {
    const FrameResult result = source().next(5ms);
    return result.message == "/dev/video0: was unplugged" || result.message == "/dev/video0: no such device";
  }));
}

TEST_F(V4l2CameraTest, OpensASilentCameraAnew) {
  EmulatedCamera camera;
  V4l2Camera::Params params;
  params.device = kPath;
  params.silent_after = 200ms;
  source_ = std::make_unique<V4l2Camera>(params);
  source().configure({320, 240, 50.0});
  source().start();
  take();
  camera.hush();
  EXPECT_TRUE(waitsFor("/dev/video0: gives no pictures"));
  camera.hush(false);
  take();
}

TEST_F(V4l2CameraTest, SaysWhatIsNoCamera) {
  EmulatedCamera::Description description;
  description.captures = false;
  EmulatedCamera camera(description);
  EXPECT_THAT(source().configure({}).message,
              HasSubstr("/dev/video0: is no camera that we can read (\"Emulated Camera\" of driver emulated "
                        "gives no pictures by streaming)"));
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "text";
  const auto file = makeSource("Device=" + (folder / "file") + "\n");
  EXPECT_THAT(file->configure({}).message, HasSubstr("file: not a video device"));
  const auto directory = makeSource("Device=" + folder.path().string() + "\n");
  EXPECT_THAT(directory->configure({}).message, HasSubstr(": not a video device"));
}

TEST_F(V4l2CameraTest, SaysWhoMayOpenIt) {
  const TemporaryFolder folder;
  std::ofstream(folder / "closed") << "text";
  ASSERT_EQ(chmod((folder / "closed").c_str(), 0), 0);
  const auto closed = makeSource("Device=" + (folder / "closed") + "\n");
  const FilePermissionsCount permissions_count;
  EXPECT_THAT(closed->configure({}).message,
              HasSubstr("closed: no permission (cameras belong to the group video)"));
}

TEST(V4l2Cameras, AreAsManyAsOneLikes) {
  EmulatedCamera::Description second;
  second.number = 2;
  second.modes = {{"GREY", 64, 48, {50}}};
  EmulatedCamera left;
  EmulatedCamera right(second);
  const auto a = makeSource("Device=/dev/video0\n");
  const auto b = makeSource("Device=/dev/video2\n");
  a->start();
  b->start();
  const auto size = [](FrameSource& source) {
    FrameResult result;
    eventually([&] { return (result = source.next(100ms)).frame.has_value(); });
    return result.frame ? result.frame->image.size() : cv::Size();
  };
  EXPECT_EQ(size(*a), cv::Size(640, 480));
  EXPECT_EQ(size(*b), cv::Size(64, 48));
}

TEST(V4l2Keys, AreChecked) {
  const auto properties = Properties::parse("Format=H264\nControl.gain=x\nDelay_ms=-1\n", "r.cfg");
  ConfigReader config(properties);
  makeV4l2Camera(config);
  std::string all;
  for (const Problem& problem : config.allProblems()) all += problem.text() + "\n";
  EXPECT_THAT(all, HasSubstr("missing key \"Device\" (must be a camera's device, such as /dev/video0)"));
  EXPECT_THAT(all, HasSubstr("r.cfg:1: Format = H264"));
  EXPECT_THAT(all, HasSubstr("r.cfg:2: Control.gain = x"));
  EXPECT_THAT(all, HasSubstr("r.cfg:3: Delay_ms = -1 (must be 0..1000)"));
}

}  // namespace
}  // namespace vismem
