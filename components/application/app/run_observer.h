/// @file Watches a running robot for the figures of its report; in a simulation it also drives the robot.
/// Nothing of it is a recording: bags are written by the process `recorder`.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/robot/control_ports.h"
#include "common/robot/ports.h"
#include "common/routes/route_follower.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/report/run_files.h"
#include "evaluation/report/run_record.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// The ports of the robot. All must outlive the observer; each is used by one of its threads only.
struct RunPorts {
  FrameSource* camera = nullptr;
  MobileBase* base = nullptr;
  VisualMemorySource* memory = nullptr;
  LocalizationControl* localization = nullptr;
  SimulationControl* simulation = nullptr;  ///< null: no truth and no driver
  bool truth_in_map = true;  ///< false: the truth drives, and is written to its file, but judges nothing
};

/// The present state, for the status line.
struct LiveState {
  std::optional<StampUs> first_us;  ///< of the robot's time: the truth's, else the images'
  StampUs now_us = 0;               ///< goes back with a seek or a reset
  bool is_paused = false;           ///< the simulation or the replay, by command
  double camera_hz = 0.0;
  double memory_hz = 0.0;
  std::size_t memory_segments = 0;
  std::optional<PoseEstimate> estimate;  ///< the newest
  std::optional<PoseError> error;        ///< of that estimate; empty without a known truth
  bool is_twin = false;       ///< the error is that to a symmetric twin of the true place, which is nearer
  std::string drive_failure;  ///< reason of the last rejected drive command; empty: accepted
  std::string recording_failure;  ///< why the recording has ended early; empty: it has not
  std::chrono::steady_clock::time_point last_advance;  ///< when the robot's time last changed
  StampUs last_image_us = 0;                           ///< of the camera
  StampUs last_estimate_us = 0;

  double elapsed_s() const { return first_us ? toSeconds(now_us - *first_us) : 0.0; }
};

/// Error of an estimate to the true place or to that of its twins which is nearest; 1 rad counts as 1 m.
struct TwinError {
  PoseError error;
  bool is_twin = false;
};
/// @param estimate with a pose.
TwinError errorToNearestTwin(const PoseEstimate& estimate, const Pose2& truth,
                             const std::vector<Pose2>& symmetries);

/// Keeps poses, and of memory and images the last. *Thread-safe* between start and stop.
class RunObserver {
 public:
  /// @param driver drives the robot; empty: none.
  /// @param files trajectories are written there as they come; must outlive the observer.
  /// @param judged images of a recording whose analyses are kept; pictures show none after them. Empty: keeps
  /// none.
  /// @param symmetries of the map (symmetriesOf): the live error counts against the nearest twin.
  RunObserver(const RunPorts& ports, RunFiles& files, std::optional<SimulatedOperator> driver,
              std::optional<ImageRange> judged, std::vector<Pose2> symmetries);
  ~RunObserver() { stop(); }

  void start();
  /// Stops the base and joins the threads.
  void stop();
  LiveState live() const;
  /// The record; after stop() only.
  RunRecord takeRecord();

 private:
  void followTruth(const std::stop_token& stop);
  void followOdometry(const std::stop_token& stop);
  void followCamera(const std::stop_token& stop);
  void followMemory(const std::stop_token& stop);
  void followLocalization(const std::stop_token& stop);
  void noteTimeLocked(StampUs stamp_us);
  void pairImageLocked();

  const RunPorts ports_;
  std::optional<SimulatedOperator> driver_;  ///< of the truth's thread
  const std::optional<ImageRange> judged_;
  const std::vector<Pose2> symmetries_;

  mutable std::mutex mutex_;
  RunFiles& files_;
  RunRecorder recorder_;
  RunRecord& record_ = recorder_.record();
  LiveState live_;
  /// The newest unmatched images and analyses: an analysis arrives some images after its image.
  std::deque<Frame> images_;
  std::deque<std::shared_ptr<const ImageAnalysis>> waiting_analyses_;

  std::vector<std::jthread> threads_;
};

}  // namespace vismem
