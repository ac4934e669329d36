// Latency of an image over avm::Camera relative to as many plain bytes over Ice, the effect of a stalled
// client on others, and the growth of the server's memory. Output: tables, and one line of JSON at the end.
// The server is a process of its own. Kinds of request take turns, so that disturbances of the machine affect
// all alike.
#include <avm/camera.h>
#include <benchmark/benchmark.h>
#include <camera/plain.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/camera/server.h"
#include "bench/camera/server_process.h"
#include "bench/camera/v4l2.h"
#include "bench/percentile.h"
#include "common/process/child_process.h"
#include "common/tool/command_line_tool.h"
#include "untrusted_clients/attack.h"
#include "untrusted_clients/ice_wire.h"

namespace vismem {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

class Bench {
 public:
  Bench()
      : camera_(server_.proxy<avm::CameraPrx>("camera")),
        plain_(server_.proxy<bench::PlainPrx>("plain")),
        control_(server_.proxy<bench::ControlPrx>("control")) {}

  /// Medians of the round trips of requests of one size and format.
  json requests(int width, int height, const std::string& format, int rounds, double rate_hz) {
    const bool fresh = rate_hz <= 0.0;
    // One of this size at once: until the next is due, the newest is of another.
    control_->publish(width, height, 0.0);
    if (!fresh) control_->publish(width, height, rate_hz);
    std::size_t bytes = 0;
    for (int i = 0; i < 3; ++i) bytes = camera_->getNext(format, -1).image.pixels.size();
    const auto size = static_cast<int>(bytes);
    const std::vector<std::function<void()>> kinds = {
        [&] { benchmark::DoNotOptimize(plain_->get(size)); },
        [&] { benchmark::DoNotOptimize(camera_->getNext(format, -1)); },
        [&] { benchmark::DoNotOptimize(camera_->getImageData(format)); }};
    std::vector<std::vector<double>> us(kinds.size());
    for (int i = 0; i < rounds + kWarmUp; ++i) {
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        const std::size_t kind = (k + static_cast<std::size_t>(i)) % kinds.size();
        if (fresh) control_->publish(width, height, 0.0);
        const auto begin = Clock::now();
        kinds[kind]();
        const std::chrono::duration<double, std::micro> taken = Clock::now() - begin;
        if (i >= kWarmUp) us[kind].push_back(taken.count());
      }
    }
    const double plain = percentile(us[0], 0.5);
    const double next = percentile(us[1], 0.5);
    const double data = percentile(us[2], 0.5);
    std::printf("  %4dx%-4d %-5s %9zu %9.0f %9.0f %9.0f %10.2f %12.2f\n", width, height, format.c_str(),
                bytes, plain, next, data, next / plain, data / plain);
    std::fflush(stdout);
    return {{"width", width},
            {"height", height},
            {"format", format},
            {"bytes", bytes},
            {"plain_us", plain},
            {"getNext_us", next},
            {"getImageData_us", data},
            {"getNext_ratio", next / plain},
            {"getImageData_ratio", data / plain},
            {"new_frame_each", fresh}};
  }

  /// Ages of the frames that nine clients get while a tenth takes its frames too, or asks and never reads.
  json clients(bool stalled, double seconds) {
    control_->publish(320, 240, 30.0);
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    std::vector<std::vector<double>> ages_ms(kClients);
    {
      std::vector<std::jthread> threads;
      for (int i = 0; i < kClients - (stalled ? 1 : 0); ++i) {
        threads.emplace_back([&, i] {
          // A connection of its own.
          const auto camera = camera_->ice_connectionId("client" + std::to_string(i));
          Ice::Long last = -1;
          while (Clock::now() < end) {
            const auto result = camera->getNext("RGB8", last);
            if (result.state != avm::SourceState::Running) continue;
            last = result.image.seq;
            const auto now_us =
                std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
                    .count();
            ages_ms[static_cast<std::size_t>(i)].push_back(
                static_cast<double>(now_us - result.image.stampUs) / 1000.0);
          }
        });
      }
      if (stalled) threads.emplace_back([&] { stall(end); });
    }
    std::vector<double> nine;
    for (int i = 0; i < kClients - 1; ++i) nine.insert(nine.end(), ages_ms[i].begin(), ages_ms[i].end());
    const double p50 = percentile(nine, 0.5);
    const double p99 = percentile(nine, 0.99);
    const double most = percentile(nine, 1.0);
    const double rate_hz = static_cast<double>(nine.size()) / seconds / (kClients - 1);
    std::printf("  %-22s %8.2f %8.2f %8.2f %10.1f\n", stalled ? "tenth never reads" : "tenth reads", p50, p99,
                most, rate_hz);
    std::fflush(stdout);
    return {{"tenth_stalled", stalled},
            {"p50_ms", p50},
            {"p99_ms", p99},
            {"max_ms", most},
            {"frames_per_s", rate_hz}};
  }

  /// The server's memory while ten clients, one of them stalled, take frames for a while.
  json memory(double seconds) {
    clients(true, 2.0);
    const double before = test::residentMb(server_.pid());
    clients(true, seconds);
    const double after = test::residentMb(server_.pid());
    std::printf("  server: %.1f MB before, %.1f MB after %.0f s more\n", before, after, seconds);
    return {{"before_mb", before}, {"after_mb", after}, {"seconds", seconds}};
  }

 private:
  static constexpr int kWarmUp = 20;
  static constexpr int kClients = 10;

  /// Asks for every frame and reads none.
  void stall(Clock::time_point end) {
    test::RawConnection connection(server_.port());
    connection.receive();
    for (int id = 1; Clock::now() < end; ++id) {
      test::WireBytes parameters;
      parameters.text("RGB8").number(Ice::Long{-1});
      if (connection.open() && id <= 100) {
        connection.send(test::request({id, "camera", "", "", "getNext", true, parameters.take()}));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  ServerProcess server_;
  std::shared_ptr<avm::CameraPrx> camera_;
  std::shared_ptr<bench::PlainPrx> plain_;
  std::shared_ptr<bench::ControlPrx> control_;
};

/// In a process of its own, because umockdev is to be there from the beginning.
json v4l2(double seconds) {
  json result;
  ChildProcess::Options options;
  options.on_line = [&result](const ChildProcess::Line& line) {
    if (line.text.starts_with("{")) {
      result = json::parse(line.text, nullptr, false);
    } else {
      std::cout << line.text << std::endl;
    }
  };
  const std::string seconds_text = std::to_string(seconds);
  ChildProcess part({"umockdev-wrapper", std::filesystem::read_symlink("/proc/self/exe").string(), "--v4l2",
                     "--seconds", seconds_text},
                    options);
  const auto patience = std::chrono::seconds(60 + static_cast<int>(10.0 * seconds));
  if (part.waitForExit(patience) != 0) throw std::runtime_error("the part of V4L2 failed: " + part.error());
  return result;
}

int run(double seconds, int rounds) {
  Bench bench;
  json result = {{"benchmark", "camera"}, {"requests", json::array()}};
  const auto table = [&](double rate_hz) {
    std::printf("  %-9s %-5s %9s %9s %9s %9s %10s %12s\n", "size", "form", "bytes", "plain us", "getNext",
                "getImage", "getNext/p", "getImage/p");
    for (const auto& [width, height] : {std::pair{320, 240}, {640, 480}, {1280, 720}}) {
      for (const char* format : {"RGB8", "GRAY8", "JPEG"}) {
        result["requests"].push_back(
            bench.requests(width, height, format, width > 1000 ? rounds / 3 : rounds, rate_hz));
      }
    }
  };
  std::printf("Medians of round trips; the camera gives 30 new frames a second:\n");
  table(30.0);
  std::printf("The same, with a frame so new that nobody asked for it before:\n");
  table(0.0);
  std::printf("Age of frames at nine of ten clients, 320x240 RGB8 at 30 Hz [ms]:\n  %-22s %8s %8s %8s %10s\n",
              "", "p50", "p99", "max", "frames/s");
  result["clients"] = {bench.clients(false, seconds), bench.clients(true, seconds)};
  std::printf("Memory, ten clients, one of them stalled:\n");
  result["memory"] = bench.memory(4.0 * seconds);
  result["v4l2"] = v4l2(seconds);
  std::cout << result.dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace vismem

int main(int argc, char** argv) {
  CLI::App app("Pictures over avm::Camera beside plain bytes over Ice");
  bool serve = false;
  bool v4l2 = false;
  double seconds = 5.0;
  int rounds = 600;
  app.add_flag("--serve", serve, "be the server (used by the benchmark itself)");
  app.add_flag("--v4l2", v4l2, "only what a camera of V4L2 costs; behind umockdev-wrapper");
  app.add_option("--seconds", seconds, "of each run with ten clients, or with a camera of V4L2")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--rounds", rounds, "requests of each kind; a third of it for 1280x720")
      ->check(CLI::Range(30, 1'000'000));
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    if (serve) vismem::runBenchServer();
    if (v4l2) return vismem::benchV4l2(seconds);
    return vismem::run(seconds, rounds);
  } catch (const std::exception& error) {
    std::cerr << "camera: " << error.what() << std::endl;
    return 1;
  }
}
