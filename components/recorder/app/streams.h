/// @file Follows everything that the components publish and hands it to the recorder's service.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/process/component.h"
#include "recorder/app/config.h"
#include "recorder/app/recorder_service.h"
#include "recorder/app/session_folder.h"

namespace vismem {

/// One thread a stream, each over its own peer: one that is away delays no other. *Thread-safe.*
class Streams {
 public:
  Streams(const RecorderConfig& config, RecorderService& service, SessionFolder& session)
      : config_(config), service_(service), session_(session) {}
  ~Streams() { stop(); }

  void start(ComponentHost& host);
  void stop();

 private:
  void run(ComponentHost& host, std::function<void(const std::stop_token&)> follow);
  void followCamera(ComponentHost& host, const RecorderConfig::CameraStream& camera,
                    const std::stop_token& stop);
  void followOdometry(ComponentHost& host, const std::stop_token& stop);
  void followPanTilt(ComponentHost& host, const std::stop_token& stop);
  void followMemory(ComponentHost& host, const std::stop_token& stop);
  void followGaze(ComponentHost& host, const std::stop_token& stop);
  void followLocalization(ComponentHost& host, const std::stop_token& stop);
  void followTruth(ComponentHost& host, const std::stop_token& stop);
  void followComponent(ComponentHost& host, const std::string& proxy, const std::stop_token& stop);
  /// Ends early on stop().
  void pause(std::chrono::milliseconds duration, const std::stop_token& stop);
  Emit emitter();

  template <typename Prx, typename Convert>
  void followSamples(ComponentHost& host, const std::string& name, const std::string& proxy,
                     const std::stop_token& stop, Convert convert);

  const RecorderConfig& config_;
  RecorderService& service_;
  SessionFolder& session_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::vector<std::jthread> threads_;
};

}  // namespace vismem
