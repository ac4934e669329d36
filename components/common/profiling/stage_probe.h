/// @file Profiling hook for the stages of an iteration. Pure: the listener has the clock.
#pragma once

namespace vismem {

/// Listener for the begin of each stage; a stage lasts until the next call.
class StageProbe {
 public:
  virtual ~StageProbe() = default;
  /// @param stage a string literal.
  virtual void enter(const char* stage) = 0;
};

/// The probe may be null.
inline void enterStage(StageProbe* probe, const char* stage) {
  if (probe != nullptr) probe->enter(stage);
}

}  // namespace vismem
