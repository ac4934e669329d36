/// @file Contract tests of every camera (common/robot/ports.h). A test program lists
/// frame_source_contract.cpp and its own files, which contain
///
///   INSTANTIATE_TEST_SUITE_P(MyCamera, FrameSourceContract,
///                            testing::Values(FrameSourceCase{"name", [](Supply supply) {
///                              return std::make_unique<MyRig>(supply); }}), nameOfCase);
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "common/robot/ports.h"

namespace vismem {

/// Supply of images to a tested camera.
enum class Supply {
  kSteady,  ///< at 20..100 Hz
  kOne,     ///< one at the start, then none for a minute or more (after hush())
};

/// One camera with its source of images: files, a world, a server. Not configured, not started.
class FrameSourceRig {
 public:
  virtual ~FrameSourceRig() = default;
  virtual FrameSource& source() = 0;

  /// Called before each wait for a frame: a simulation in lock-step makes its step here.
  virtual void provoke() {}
  /// Of Supply::kOne, once the one frame was taken: no more frames from now on.
  virtual void hush() {}

  /// next() waits for a frame; false where time stands still meanwhile (lock-step).
  virtual bool waits() const { return true; }
  /// Seconds between frames of Supply::kSteady, at most.
  virtual double period_s() const { return 0.05; }
};

struct FrameSourceCase {
  std::string name;
  std::function<std::unique_ptr<FrameSourceRig>(Supply)> make;
};

inline void PrintTo(const FrameSourceCase& which, std::ostream* out) {
  *out << which.name;
}
inline std::string nameOfCase(const testing::TestParamInfo<FrameSourceCase>& info) {
  return info.param.name;
}

class FrameSourceContract : public testing::TestWithParam<FrameSourceCase> {
 protected:
  void open(Supply supply = Supply::kSteady) { rig_ = GetParam().make(supply); }
  FrameSource& source() { return rig_->source(); }
  /// Waits for the next frame, with a timeout for a busy machine.
  Frame take();

  std::unique_ptr<FrameSourceRig> rig_;
};

}  // namespace vismem
