/// @file Where the time of an iteration goes, told from inside. Pure: the clock is the listener's.
#pragma once

namespace vismem {

/// Hears which stage of an iteration begins; what runs until the next call belongs to it.
class StageProbe {
 public:
  virtual ~StageProbe() = default;
  /// @param stage a string literal.
  virtual void enter(const char* stage) = 0;
};

/// Nobody may be listening.
inline void enterStage(StageProbe* probe, const char* stage) {
  if (probe != nullptr) probe->enter(stage);
}

}  // namespace vismem
