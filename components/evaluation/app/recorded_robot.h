/// @file A stepped robot whose frames and samples also go into a recording. See C1.
#pragma once

#include <filesystem>
#include <memory>

#include "common/robot/control_ports.h"
#include "common/robot/ports.h"

namespace vismem {

/// Records what its consumer takes from the ports, no more and no less: a replay in lock-step gives the same.
/// *Single-threaded*; the robot must outlive it.
class RecordedRobot : public SteppedRobot {
 public:
  /// @param folder of the recording; must not be there yet. @throws RecordingError.
  RecordedRobot(SteppedRobot& robot, const std::filesystem::path& folder);
  ~RecordedRobot() override;

  bool advanceToNextFrame() override;
  FrameSource& camera() override;
  PanTiltUnit& panTilt() override;
  MobileBase& base() override;

  void addTruth(const TruthSample& truth);
  /// Writes the index. @throws RecordingError.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
