/// @file Listens to all parts of a running robot and keeps what a run leaves behind; drives it in a
/// simulation.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/robot/control_ports.h"
#include "common/robot/ports.h"
#include "common/visual_memory/memory_snapshot.h"
#include "common/routes/route_follower.h"
#include "experiments/core/run_record.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// The ports of the robot; all must outlive the recorder, and each is used by one of its threads alone.
struct SessionPorts {
  FrameSource* camera = nullptr;
  MobileBase* base = nullptr;
  VisualMemorySource* memory = nullptr;
  LocalizationControl* localization = nullptr;
  SimulationControl* simulation = nullptr;  ///< null: no truth, nobody drives
};

/// What is known now, for the status line.
struct LiveState {
  std::optional<StampUs> first_us;  ///< of the robot's time: the truth's, else the images'
  StampUs now_us = 0;
  double camera_hz = 0.0;
  double memory_hz = 0.0;
  std::size_t memory_segments = 0;
  std::optional<PoseEstimate> estimate;  ///< the newest
  std::optional<PoseError> error;        ///< of that estimate; empty where the truth is not known
  std::string drive_failure;             ///< why the last drive command was refused; empty: it was not
  std::chrono::steady_clock::time_point last_news;  ///< when the robot's time last moved
  StampUs last_image_us = 0;                        ///< of the camera
  StampUs last_estimate_us = 0;

  double elapsed_s() const { return first_us ? toSeconds(now_us - *first_us) : 0.0; }
};

/// *Thread-safe* between start and stop.
class SessionRecorder {
 public:
  /// @param driver who drives; empty: nobody.
  /// @param judged images of a recording whose analyses are kept; pictures show no later one. Empty: none is.
  SessionRecorder(const SessionPorts& ports, std::optional<SimulatedOperator> driver,
                  std::optional<ImageRange> judged);
  ~SessionRecorder() { stop(); }

  void start();
  /// Stops the base and the listening; waits for the threads.
  void stop();
  LiveState live() const;
  /// What was recorded; after stop() only.
  RunRecord takeRecord();

 private:
  void followTruth(const std::stop_token& stop);
  void followOdometry(const std::stop_token& stop);
  void followCamera(const std::stop_token& stop);
  void followMemory(const std::stop_token& stop);
  void followLocalization(const std::stop_token& stop);
  void noteTimeLocked(StampUs stamp_us);
  void pairImageLocked();

  const SessionPorts ports_;
  std::optional<SimulatedOperator> driver_;  ///< of the truth's thread
  const std::optional<ImageRange> judged_;

  mutable std::mutex mutex_;
  RunRecord record_;
  LiveState live_;
  /// The newest images and analyses until they meet: the memory answers some images later.
  std::deque<Frame> images_;
  std::deque<std::shared_ptr<const ImageAnalysis>> waiting_analyses_;

  std::vector<std::jthread> threads_;
};

}  // namespace vismem
