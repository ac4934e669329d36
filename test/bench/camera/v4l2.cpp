#include "bench/camera/v4l2.h"

#include <Ice/Ice.h>
#include <avm/camera.h>
#include <benchmark/benchmark.h>
#include <camera/plain.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "bench/camera/server_process.h"
#include "bench/percentile.h"
#include "common/drivers/host_clock.h"
#include "common/process/child_process.h"
#include "common/process/ice_setup.h"
#include "common/process/ready_line.h"
#include "common/v4l2/v4l2_device.h"
#include "drivers/camera_v4l2/frame_buffers.h"
#include "drivers/camera_v4l2/negotiation.h"
#include "support/build_paths.h"
#include "support/emulated_camera.h"

namespace vismem {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

/// Processor time of a process so far [s].
double processorTime_s(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  std::getline(file, line);
  // The name in brackets may hold blanks.
  std::istringstream rest(line.substr(line.rfind(')') + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) rest >> skipped;
  double user = 0.0;
  double system = 0.0;
  rest >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double ms(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

struct Run {
  const char* captured;  ///< four characters of V4L2
  int width, height;
  const char* served;  ///< empty: no client
};

struct Ages {
  std::vector<double> stamped_ms;   ///< since the kernel's stamp
  std::vector<double> dequeued_ms;  ///< since the camera gave the picture to the server
  std::vector<double> plain_ms;     ///< round trips of as many plain bytes, one after each picture
};

/// Delay of the emulation itself, which a kernel does not have: from its answer to the return of the request,
/// measured without a server. Median [ms].
double handingOver_ms() {
  EmulatedCamera::Description description;
  description.modes = {{"YUYV", 320, 240, {30}}};
  EmulatedCamera camera(description);
  V4l2Device device;
  std::string why = device.open(camera.path());
  if (why.empty()) why = v4l2::negotiate(device, {}, nullptr).away;
  v4l2::FrameBuffers buffers(device);
  if (why.empty()) why = buffers.begin();
  std::vector<double> taken_ms;
  while (why.empty() && taken_ms.size() < 90) {
    v4l2::FrameBuffers::Filled filled;
    const auto taken = buffers.take(filled, why);
    const auto returned = Clock::now();
    if (taken == v4l2::FrameBuffers::Taken::kFrame) {
      taken_ms.push_back(ms(returned - camera.lastGivenAt()));
      why = buffers.giveBack(filled);
    } else if (taken == v4l2::FrameBuffers::Taken::kNone) {
      // As the driver after a poll() without an image.
      device.pauseUntil(Clock::now() + std::chrono::milliseconds(2));
    }
  }
  if (!why.empty()) throw std::runtime_error(why);
  return percentile(taken_ms, 0.5);
}

json measure(const Run& run, double seconds, bench::PlainPrx& plain, double handing_over_ms) {
  EmulatedCamera::Description description;
  description.modes = {{run.captured, run.width, run.height, {30}}};
  EmulatedCamera camera(description);
  const std::string prefix = "--CameraServer.Camera.cameraA.";
  ChildProcess server({VISMEM_BIN_DIR "/camera_server", "--CameraServer.Endpoints=tcp -h 127.0.0.1 -p 0",
                       prefix + "Driver=v4l2", prefix + "Device=" + camera.path(),
                       prefix + "Width_px=" + std::to_string(run.width),
                       prefix + "Height_px=" + std::to_string(run.height)});
  const auto line = server.waitForLine("camera_server ready: ", std::chrono::seconds(20));
  if (!line) throw std::runtime_error("camera_server does not start: " + server.error());
  Logger log("bench", LogLevel::kWarning);
  const Ice::CommunicatorHolder ice(makeCommunicator(Properties{}, log));
  const auto proxy =
      Ice::uncheckedCast<avm::CameraPrx>(ice->stringToProxy("cameraA:" + readyEndpoints(*line).value_or("")));

  // A client that is there already, and has its first frame.
  Ice::Long last = -1;
  const std::string served = run.served;
  Ages ages;
  const auto take = [&] {
    const auto result = proxy->getNext(served.empty() ? "YUY2" : served, last);
    const auto arrived = Clock::now();
    const auto now_us = hostClock_us();
    if (result.state != avm::SourceState::Running || result.image.seq == last) return false;
    last = result.image.seq;
    ages.stamped_ms.push_back(static_cast<double>(now_us - result.image.stampUs) / 1000.0);
    // At 30 Hz this picture is still the last that was given.
    ages.dequeued_ms.push_back(ms(arrived - camera.lastGivenAt()));
    // Half-way to the next, so that both find a server that has slept.
    std::this_thread::sleep_until(arrived + std::chrono::milliseconds(14));
    const auto asked = Clock::now();
    benchmark::DoNotOptimize(plain.get(static_cast<int>(result.image.pixels.size())));
    ages.plain_ms.push_back(ms(Clock::now() - asked));
    return true;
  };
  while (!take()) continue;
  ages = {};
  const double before_s = processorTime_s(server.pid());
  const auto began = Clock::now();
  const auto end =
      began + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (Clock::now() < end) {
    if (served.empty()) {
      std::this_thread::sleep_until(end);
    } else {
      take();
    }
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - began).count();
  const double share = (processorTime_s(server.pid()) - before_s) / took_s;
  server.signal(SIGTERM);
  server.waitForExit(std::chrono::seconds(10));
  const double rate_hz = static_cast<double>(ages.stamped_ms.size()) / took_s;
  const double dequeued = served.empty() ? 0.0 : percentile(ages.dequeued_ms, 0.5) - handing_over_ms;
  const double bytes = percentile(ages.plain_ms, 0.5);
  const double ratio = bytes > 0.0 ? dequeued / bytes : 0.0;
  std::printf("  %-5s %4dx%-4d %-7s %9.1f %10.1f %9.2f %9.2f %10.2f %10.2f %8.2f\n", run.captured, run.width,
              run.height, served.empty() ? "nobody" : run.served, 100.0 * share, rate_hz,
              percentile(ages.stamped_ms, 0.5), percentile(ages.stamped_ms, 0.99), dequeued, bytes, ratio);
  std::fflush(stdout);
  return {{"captured", run.captured},
          {"width", run.width},
          {"height", run.height},
          {"served", served},
          {"processor_percent", 100.0 * share},
          {"frames_per_s", rate_hz},
          {"age_p50_ms", percentile(ages.stamped_ms, 0.5)},
          {"age_p99_ms", percentile(ages.stamped_ms, 0.99)},
          {"dequeued_to_client_p50_ms", dequeued},
          {"plain_p50_ms", bytes},
          {"dequeued_to_plain_ratio", ratio}};
}

}  // namespace

int benchV4l2(double seconds) {
  const double handing_over = handingOver_ms();
  std::printf(
      "camera_server with a camera of V4L2 on umockdev, 30 Hz: its share of one core [%%], frames at a "
      "client [1/s], their age\n"
      "there since the kernel's stamp and since the server took them from the kernel (less the %.2f ms that "
      "the emulation takes to hand\nthem over), and a round trip of as many plain bytes [ms]:\n  %-5s %-9s "
      "%-7s %9s %10s %9s %9s %10s %10s %8s\n",
      handing_over, "takes", "size", "client", "core %", "frames/s", "age p50", "age p99", "taken p50",
      "plain p50", "ratio");
  const ServerProcess other;
  const auto plain = other.proxy<bench::PlainPrx>("plain");
  json runs = json::array();
  for (const Run& run :
       {Run{"YUYV", 320, 240, "RGB8"}, Run{"YUYV", 320, 240, "YUY2"}, Run{"YUYV", 1280, 720, ""},
        Run{"YUYV", 1280, 720, "YUY2"}, Run{"YUYV", 1280, 720, "RGB8"}, Run{"MJPG", 1280, 720, "JPEG"}}) {
    runs.push_back(measure(run, seconds, *plain, handing_over));
  }
  std::cout << json({{"benchmark", "camera_v4l2"}, {"emulation_p50_ms", handing_over}, {"runs", runs}}).dump()
            << std::endl;
  return 0;
}

}  // namespace vismem
