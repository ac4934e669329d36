#include "bench/camera/v4l2.h"

#include <Ice/Ice.h>
#include <avm/camera.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/drivers/host_clock.h"
#include "common/process/child_process.h"
#include "common/process/ice_setup.h"
#include "common/process/ready_line.h"
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

struct Run {
  const char* captured;  ///< four characters of V4L2
  int width, height;
  const char* served;  ///< empty: nobody asks
};

json measure(const Run& run, double seconds) {
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
  std::vector<double> ages_ms;
  const auto take = [&] {
    const auto result = proxy->getNext(served.empty() ? "YUY2" : served, last);
    if (result.state != avm::SourceState::Running || result.image.seq == last) return false;
    last = result.image.seq;
    ages_ms.push_back(static_cast<double>(hostClock_us() - result.image.stampUs) / 1000.0);
    return true;
  };
  while (!take()) continue;
  ages_ms.clear();
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
  std::sort(ages_ms.begin(), ages_ms.end());
  const auto percentile = [&](double p) {
    return ages_ms.empty() ? 0.0
                           : ages_ms[static_cast<std::size_t>(p * static_cast<double>(ages_ms.size() - 1))];
  };
  server.signal(SIGTERM);
  server.waitForExit(std::chrono::seconds(10));
  const double rate_hz = static_cast<double>(ages_ms.size()) / took_s;
  std::printf("  %-5s %4dx%-4d %-7s %9.1f %10.1f %9.2f %9.2f\n", run.captured, run.width, run.height,
              served.empty() ? "nobody" : run.served, 100.0 * share, rate_hz, percentile(0.5),
              percentile(0.99));
  std::fflush(stdout);
  return {{"captured", run.captured},
          {"width", run.width},
          {"height", run.height},
          {"served", served},
          {"processor_percent", 100.0 * share},
          {"frames_per_s", rate_hz},
          {"age_p50_ms", percentile(0.5)},
          {"age_p99_ms", percentile(0.99)}};
}

}  // namespace

int benchV4l2(double seconds) {
  std::printf(
      "camera_server with a camera of V4L2 on umockdev, 30 Hz: its share of one core [%%], frames at a "
      "client [1/s], and their\n"
      "age there [ms]:\n  %-5s %-9s %-7s %9s %10s %9s %9s\n",
      "takes", "size", "client", "core %", "frames/s", "age p50", "age p99");
  json runs = json::array();
  for (const Run& run :
       {Run{"YUYV", 320, 240, "RGB8"}, Run{"YUYV", 1280, 720, ""}, Run{"YUYV", 1280, 720, "YUY2"},
        Run{"YUYV", 1280, 720, "RGB8"}, Run{"MJPG", 1280, 720, "JPEG"}}) {
    runs.push_back(measure(run, seconds));
  }
  std::cout << json({{"benchmark", "camera_v4l2"}, {"runs", runs}}).dump() << std::endl;
  return 0;
}

}  // namespace vismem
