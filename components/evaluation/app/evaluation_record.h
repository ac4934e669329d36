/// @file What the frames of an evaluation add up to: its files, figures and summary.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "evaluation/app/evaluation.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/core/lockstep.h"
#include "evaluation/report/run_files.h"
#include "evaluation/report/run_record.h"

namespace vismem {

/// Files are written frame by frame, figures by finish(). *Single-threaded*; the arguments must outlive it.
class EvaluationRecord {
 public:
  /// Makes the output folder and its files.
  /// @throws std::runtime_error naming what cannot be written.
  EvaluationRecord(const EvaluationOptions& options, const EvaluationParams& params);

  void addTruth(const StampedPose& T_world_robot);
  /// @param judge the map's projection is measured in this image.
  void add(const LockstepFrame& frame, bool judge);

  /// Writes the figures and the last memory.
  /// @param input the recording or world, for messages.
  /// @return the summary; `problems` in it lists what makes the run a failure: files that could not be
  /// written, no labels, no races.
  /// @throws std::runtime_error when no frame was used.
  nlohmann::json finish(const Lockstep& run, const MemoryPipeline& memory, const std::string& input);

 private:
  nlohmann::json summarise(const Lockstep& run, const MemoryPipeline& memory,
                           const RunSummary& summary) const;
  std::vector<std::string> failures() const;

  const EvaluationOptions& options_;
  const EvaluationParams& params_;
  RunFiles files_;
  RunRecorder recorder_;
  GazeStatus gaze_;
  std::uint64_t estimates_ = 0;
  std::uint64_t judged_ = 0;
  std::uint64_t segments_ = 0;  ///< observed in all images
  std::uint64_t labelled_ = 0;  ///< those of them that the palette names
  bool race_lived_ = false;
};

}  // namespace vismem
