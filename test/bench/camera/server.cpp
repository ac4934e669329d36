#include "bench/camera/server.h"

#include <camera/plain.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <iostream>
#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <thread>

#include "common/process/ice_setup.h"
#include "common/process/ready_line.h"
#include "common/robot_ice/camera_ice.h"

namespace vismem {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nowUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

/// A picture that JPEG has some work with: gradients, edges and a little noise.
cv::Mat picture(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  cv::RNG noise(1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int square = ((x / 24 + y / 24) % 2) * 90;
      for (int c = 0; c < 3; ++c) {
        image.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<uchar>(40 + square + x * 60 / width + 20 * c + noise.uniform(-6, 7));
      }
    }
  }
  return image;
}

/// Publishes pictures at a rate, each a buffer of its own as from a camera.
class Producer {
 public:
  explicit Producer(FrameBroadcaster& frames)
      : frames_(frames), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void publish(int width, int height, double rate_hz) {
    const std::lock_guard lock(mutex_);
    cv::Mat& known = pictures_[{width, height}];
    if (known.empty()) known = picture(width, height);
    picture_ = known;
    rate_hz_ = rate_hz;
    if (rate_hz <= 0.0) publishLocked();
    changed_.notify_all();
  }

 private:
  void publishLocked() {
    Frame frame;
    frame.image = picture_.clone();
    frame.image.at<cv::Vec3b>(0, 0)[0] = static_cast<uchar>(seq_);
    frame.seq = ++seq_;
    frame.stamp_us = nowUs();
    frame.intrinsics = intrinsicsFromFieldOfView(picture_.cols, picture_.rows, 1.0);
    frames_.publish(std::move(frame));
  }

  void run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    auto next = Clock::now();
    while (!stop.stop_requested()) {
      if (rate_hz_ <= 0.0) {
        changed_.wait(lock, stop, [this] { return rate_hz_ > 0.0; });
        next = Clock::now();
        continue;
      }
      next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_hz_));
      changed_.wait_until(lock, stop, next, [this, rate = rate_hz_] { return rate_hz_ != rate; });
      if (!stop.stop_requested() && rate_hz_ > 0.0) publishLocked();
    }
  }

  FrameBroadcaster& frames_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<std::pair<int, int>, cv::Mat> pictures_;
  cv::Mat picture_;
  double rate_hz_ = 0.0;
  std::uint64_t seq_ = 0;
  std::jthread thread_;
};

class ControlServant : public bench::Control {
 public:
  explicit ControlServant(Producer& producer) : producer_(producer) {}
  void publish(int width, int height, double rate_hz, const Ice::Current&) override {
    producer_.publish(width, height, rate_hz);
  }
  Ice::Long nowUs(const Ice::Current&) override { return vismem::nowUs(); }

 private:
  Producer& producer_;
};

class PlainServant : public bench::Plain {
 public:
  bench::Bytes get(int size, const Ice::Current&) override {
    const std::lock_guard lock(mutex_);
    bench::Bytes& bytes = bytes_[size];
    if (bytes.empty()) bytes.assign(static_cast<std::size_t>(size), Ice::Byte{7});
    return bytes;
  }

 private:
  std::mutex mutex_;
  std::map<int, bench::Bytes> bytes_;
};

}  // namespace

[[noreturn]] void runBenchServer() {
  Logger log("bench_server", LogLevel::kWarning);
  const Ice::CommunicatorHolder communicator(makeCommunicator(Properties{}, log));
  const auto adapter = communicator->createObjectAdapterWithEndpoints("Bench", "tcp -h 127.0.0.1 -p 0");
  FrameBroadcaster frames;
  Producer producer(frames);
  adapter->add(std::make_shared<CameraServant>(frames, "camera"), Ice::stringToIdentity("camera"));
  adapter->add(std::make_shared<PlainServant>(), Ice::stringToIdentity("plain"));
  adapter->add(std::make_shared<ControlServant>(producer), Ice::stringToIdentity("control"));
  adapter->activate();
  std::cout << readyLine("bench_server", "Bench", publishedEndpoints(*adapter)) << std::endl;
  // The parent ends it with SIGTERM; nothing here has to be put in order.
  for (;;) pause();
}

}  // namespace vismem
