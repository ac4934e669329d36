// The hardware servers on real drivers of the kernel, in a virtual machine of QEMU; their clients run on the
// host, over Ice. Devices and faults: README.md. Run by `scripts/test --hwkernel`, which prepares the
// machine.
#include <Ice/Ice.h>
#include <avm/camera.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <opencv2/core.hpp>

#include "common/geometry/angles.h"
#include "common/image_codec/image_codec.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "hwkernel/guest.h"
#include "support/build_paths.h"
#include "support/eventually.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr int kCameras = 9999, kMaestro = 9977, kTurning = 9978, kBase = 9990, kOrbit = 9979;
/// Everything is emulated, and programs are loaded over a file system of the host's.
constexpr auto kLong = 90s;

/// A picture of the camera by USB.
std::vector<std::uint8_t> picture() {
  cv::Mat image(120, 160, CV_8UC3, cv::Scalar(30, 90, 200));
  image.colRange(0, 40).setTo(cv::Scalar(220, 60, 10));
  return encodeJpeg(image, 90);
}

class HwKernel : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* boot = std::getenv("VISMEM_HWKERNEL");
    if (boot == nullptr) return;
    guest = std::make_unique<Guest>(boot, std::vector<int>{kCameras, kMaestro, kTurning, kBase, kOrbit});
    if (!guest->waitUntilReady()) {
      ADD_FAILURE() << "the machine does not come up:\n" << guest->console();
      guest.reset();
      return;
    }
    const auto jpeg = picture();
    guest->writeFile("picture.jpg", {jpeg.begin(), jpeg.end()});
    const std::string camera = " --CameraServer.Camera.";
    server("camera_server", kCameras,
           "--CameraServer.PlainRemote=yes --CameraServer.Endpoints='tcp -h 0.0.0.0 -p 9999'" + camera +
               "vivid.Driver=v4l2" + camera + "vivid.Device=/dev/video0" + camera + "vivid.Width_px=640" +
               camera + "vivid.Height_px=480" + camera + "vivid.Rate_hz=10" + camera +
               "vivid.Control.brightness=100" + camera + "usb.Driver=v4l2" + camera +
               "usb.Device=/dev/video1" + camera + "usb.Format=MJPEG" + camera + "raw.Driver=v4l2" + camera +
               "raw.Device=/dev/video5");
    plugMaestro();
    plugCamera();
    plugSerial();
    server("pantilt_server", kMaestro,
           "--PanTiltServer.PlainRemote=yes --PanTiltServer.Endpoints='tcp -h 0.0.0.0 -p 9977' "
           "--PanTiltServer.Driver=maestro");
    server("pantilt_server", kTurning,
           "--PanTiltServer.PlainRemote=yes --PanTiltServer.Endpoints='tcp -h 0.0.0.0 -p 9978' "
           "--PanTiltServer.Driver=uvc "
           "--PanTiltServer.Device=/dev/video1");
    server("base_server", kBase,
           "--BaseServer.PlainRemote=yes --BaseServer.Endpoints='tcp -h 0.0.0.0 -p 9990' "
           "--BaseServer.Driver=pioneer "
           "--BaseServer.Port=/dev/ttyACM0 "
           "--BaseServer.Watchdog_s=2");
  }
  static void TearDownTestSuite() { guest.reset(); }
  void SetUp() override {
    if (std::getenv("VISMEM_HWKERNEL") == nullptr) {
      GTEST_SKIP() << "needs a kernel and QEMU: scripts/test --hwkernel prepares and runs it";
    }
    ASSERT_TRUE(guest) << "the machine did not come up";
  }

  static void inside(const std::string& command) {
    const auto result = guest->run(command);
    EXPECT_EQ(result.code, 0) << command << "\n" << result.output;
  }
  static void server(const std::string& name, int port, const std::string& options) {
    inside("setsid " VISMEM_BIN_DIR "/" + name + " " + options + " > /mnt/" + std::to_string(port) +
           ".log 2>&1 & echo $! > /run/" + std::to_string(port) + ".pid");
  }
  static void device(const std::string& name, const std::string& arguments) {
    inside("setsid " VISMEM_BIN_DIR "/hwkernel_devices " + arguments + " > /mnt/" + name +
           ".log 2>&1 & echo $! > /run/" + name + ".pid");
  }
  static void unplug(const std::string& name) { inside("kill -9 $(cat /run/" + name + ".pid)"); }
  static void plugMaestro() { device("maestro", "maestro 0 /mnt/maestro"); }
  static void plugCamera() { device("camera", "camera 1 /mnt/camera /mnt/picture.jpg"); }
  static void plugSerial() {
    inside(
        "cd /sys/kernel/config/usb_gadget && if [ ! -d g ]; then mkdir g && cd g && echo 0x1d6b > idVendor "
        "&& echo 0x0104 > "
        "idProduct && mkdir configs/c.1 functions/acm.0 && ln -s functions/acm.0 configs/c.1/; fi");
    inside("ls /sys/class/udc | head -1 > /sys/kernel/config/usb_gadget/g/UDC");
    inside("for i in $(seq 100); do [ -c /dev/ttyACM0 ] && exit 0; sleep 0.1; done; exit 1");
    device("robot", "robot /dev/ttyGS0");
  }
  static void unplugSerial() { inside("echo '' > /sys/kernel/config/usb_gadget/g/UDC"); }
  static std::string state(const std::string& name) {
    std::ifstream file(guest->file(name));
    std::string line;
    std::getline(file, line);
    return line;
  }

  template <typename Prx>
  std::shared_ptr<Prx> find(int port, const std::string& identity) {
    return Ice::uncheckedCast<Prx>(
        ice_->stringToProxy(identity + ":tcp -h 127.0.0.1 -p " + std::to_string(guest->port(port))));
  }
  /// The reason in a server's status; "?" while it cannot be asked.
  std::string reason(int port, const std::string& name) {
    try {
      return find<avm::ComponentPrx>(port, name + "/component")->getStatus().reason;
    } catch (const Ice::Exception&) {
      return "?";
    }
  }
  testing::AssertionResult says(int port, const std::string& name, const std::string& part) {
    std::string last;
    if (eventually([&] { return (last = reason(port, name)).find(part) != std::string::npos; }, kLong)) {
      return testing::AssertionSuccess();
    }
    std::ifstream log(guest->file(std::to_string(port) + ".log"));
    return testing::AssertionFailure() << "it says: " << last << "\n" << log.rdbuf();
  }
  /// A frame of a camera, waited for.
  avm::Frame frame(const std::string& camera, const std::string& format, Ice::Long after = -1) {
    const auto proxy = find<avm::CameraPrx>(kCameras, camera);
    avm::FrameResult result;
    EXPECT_TRUE(eventually(
        [&] {
          try {
            result = proxy->getNext(format, after);
          } catch (const Ice::Exception&) {
            return false;
          }
          return result.state == avm::SourceState::Running && result.image.seq != after;
        },
        kLong))
        << result.message << "\n"
        << std::ifstream(guest->file("9999.log")).rdbuf();
    return result.image;
  }
  /// Commands until it is taken.
  testing::AssertionResult turn(int port, double pan_deg, double tilt_deg) {
    RemotePanTiltUnit unit(find<avm::PanTiltPrx>(port, "PanTilt"));
    PortReply reply;
    if (!unit.start().ok()) return testing::AssertionFailure() << "does not start";
    const bool taken = eventually(
        [&] {
          reply = unit.command(
              {PanTiltCommand::Kind::kPosition, degToRad(pan_deg), degToRad(tilt_deg), 0.0, 0.0});
          return reply.ok();
        },
        kLong);
    return taken ? testing::AssertionSuccess() : testing::AssertionFailure() << reply.message;
  }

  static std::unique_ptr<Guest> guest;
  static Ice::InitializationData settings() {
    Ice::InitializationData data;
    data.properties = Ice::createProperties();
    data.properties->setProperty("Ice.MessageSizeMax", "16384");
    data.properties->setProperty("Ice.Default.InvocationTimeout", "5000");
    return data;
  }
  Ice::CommunicatorHolder ice_{settings()};
};

std::unique_ptr<Guest> HwKernel::guest;

// Tests of camera_server come last: its many libraries take the longest to load in the machine.
TEST_F(HwKernel, AMaestroTurnsAndReturnsAfterItWasPulledOut) {
  ASSERT_TRUE(turn(kMaestro, 30.0, -20.0));
  // 10 us a degree, in quarters.
  EXPECT_TRUE(eventually([&] { return state("maestro") == "7200 5200"; }, kLong)) << state("maestro");
  unplug("maestro");
  EXPECT_TRUE(says(kMaestro, "pantilt_server", "no Maestro is connected"));
  plugMaestro();
  ASSERT_TRUE(turn(kMaestro, -10.0, 0.0));
  EXPECT_TRUE(eventually([&] { return state("maestro") == "5600 6000"; }, kLong)) << state("maestro");
}

TEST_F(HwKernel, ABaseOnUsbSerialDrivesAndReturnsAfterItWasPulledOut) {
  const auto drives = [this] {
    RemoteMobileBase base(find<avm::BasePrx>(kBase, "Motors"), find<avm::OdometryPrx>(kBase, "Encoders"));
    static_cast<void>(base.start());
    StampUs newest_us = std::numeric_limits<StampUs>::min();
    return eventually(
        [&] {
          static_cast<void>(base.setVelocity(0.3, 0.0));
          const auto batch = base.samplesSince(newest_us, 200ms);
          if (batch.samples.empty()) return false;
          newest_us = batch.samples.back().stamp_us;
          return batch.samples.back().v_mps > 0.2;
        },
        kLong);
  };
  EXPECT_TRUE(drives()) << reason(kBase, "base_server");
  unplugSerial();
  EXPECT_TRUE(says(kBase, "base_server", "/dev/ttyACM0: no such device"));
  plugSerial();
  EXPECT_TRUE(drives()) << reason(kBase, "base_server");
}

TEST_F(HwKernel, ACameraTurns) {
  ASSERT_TRUE(turn(kTurning, 20.0, 10.0));
  // V4L2 counts to the right, in arc seconds.
  EXPECT_TRUE(eventually([&] { return state("camera") == "-72000 36000 0"; }, kLong)) << state("camera");
}

TEST_F(HwKernel, AnOrbitFindsItsZeroAndCounts) {
  device("orbit", "orbit 2 /mnt/orbit /mnt/picture.jpg");
  inside("for i in $(seq 100); do [ -c /dev/video3 ] && exit 0; sleep 0.1; done; ls /dev; exit 1");
  server("pantilt_server", kOrbit,
         "--PanTiltServer.PlainRemote=yes --PanTiltServer.Endpoints='tcp -h 0.0.0.0 -p 9979' "
         "--PanTiltServer.Driver=uvc "
         "--PanTiltServer.ResetTakes_s=1 "
         "--PanTiltServer.Device=/dev/video3");
  ASSERT_TRUE(turn(kOrbit, 20.0, 10.0));
  EXPECT_TRUE(eventually([&] { return state("orbit") == "-1280 640 2"; }, kLong)) << state("orbit");
}

TEST_F(HwKernel, ACameraOfTheKernelIsServed) {
  const auto began = std::chrono::steady_clock::now();
  const avm::Frame first = frame("vivid", "RGB8");
  ASSERT_FALSE(HasFailure());
  EXPECT_EQ(first.width, 640);
  EXPECT_EQ(first.height, 480);
  EXPECT_EQ(first.pixels.size(), 640U * 480U * 3U);
  avm::Frame last = first;
  int frames = 0;
  for (; frames < 10; ++frames) {
    const avm::Frame next = frame("vivid", "RGB8", last.seq);
    ASSERT_FALSE(HasFailure());
    EXPECT_GT(next.stampUs, last.stampUs);
    EXPECT_NE(next.pixels, last.pixels) << "vivid counts in its pictures";
    last = next;
  }
  const double period_s =
      static_cast<double>(last.stampUs - first.stampUs) * 1e-6 / static_cast<double>(last.seq - first.seq);
  EXPECT_NEAR(period_s, 0.1, 0.01) << "by the kernel's stamps";
  std::cout << "vivid: first frame "
            << std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()
            << " s after it was asked for; " << 1.0 / period_s << " Hz\n";
}

TEST_F(HwKernel, ACameraThatIsNotThereIsNamed) {
  EXPECT_TRUE(says(kCameras, "camera_server", "raw: /dev/video5: no such device"));
}

TEST_F(HwKernel, ACamerasJpegReachesTheClientByteForByte) {
  const avm::Frame captured = frame("usb", "JPEG");
  EXPECT_EQ(std::vector<std::uint8_t>(captured.pixels.begin(), captured.pixels.end()), picture());
  const avm::Frame pixels = frame("usb", "RGB8", captured.seq);
  EXPECT_EQ(pixels.pixels.size(), 160U * 120U * 3U);
}

TEST_F(HwKernel, ACameraReturnsAfterItsDriverLostIt) {
  const avm::Frame before = frame("vivid", "RGB8");
  inside("echo vivid.0 > /sys/bus/platform/drivers/vivid/unbind");
  EXPECT_TRUE(says(kCameras, "camera_server", "vivid: /dev/video0: no such device"));
  inside("echo vivid.0 > /sys/bus/platform/drivers/vivid/bind");
  const avm::Frame after = frame("vivid", "RGB8", before.seq);
  EXPECT_GT(after.seq, before.seq);
  EXPECT_GT(after.stampUs, before.stampUs);
  EXPECT_EQ(after.width, 640);
}

TEST_F(HwKernel, ACameraThatWasPulledOutReturnsAsCameraAndAsPanTilt) {
  const avm::Frame before = frame("usb", "JPEG");
  ASSERT_TRUE(turn(kTurning, 20.0, 10.0));
  unplug("camera");
  EXPECT_TRUE(says(kCameras, "camera_server", "usb: /dev/video1: no such device"));
  EXPECT_TRUE(says(kTurning, "pantilt_server", "/dev/video1: no such device"));
  plugCamera();
  const avm::Frame after = frame("usb", "JPEG", before.seq);
  EXPECT_GT(after.seq, before.seq);
  ASSERT_TRUE(turn(kTurning, -5.0, 0.0));
  EXPECT_TRUE(eventually([&] { return state("camera") == "18000 0 0"; }, kLong)) << state("camera");
}

TEST_F(HwKernel, ServersStopCleanly) {
  for (const int port : {kCameras, kMaestro, kTurning, kBase}) {
    inside("kill -TERM $(cat /run/" + std::to_string(port) +
           ".pid); for i in $(seq 100); do kill -0 $(cat /run/" + std::to_string(port) +
           ".pid) 2>/dev/null || exit 0; sleep 0.1; done; exit 1");
  }
}

}  // namespace
}  // namespace vismem
