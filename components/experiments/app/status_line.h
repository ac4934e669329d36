/// @file The live status of a run: one line, rewritten in place on a terminal.
#pragma once

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>

#include "common/visual_memory/gaze.h"
#include "experiments/app/session_recorder.h"

namespace vismem {

/// "  12.3 s | camera 30.0 Hz | memory 15.0 Hz 42 segments | gaze track segment 17 at 1.20 0.40 | ...".
std::string statusText(const LiveState& live, const std::optional<GazeStatus>& gaze);

/// Writes to stderr's terminal five times a second, elsewhere a line a second. *Single-threaded.*
class StatusLine {
 public:
  StatusLine(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  /// @return whether it is time for the next text.
  bool due(std::chrono::steady_clock::time_point now);
  void show(const std::string& text);
  /// Ends the rewritten line, so that others may write.
  void end();

 private:
  std::ostream& out_;
  bool terminal_;
  bool open_ = false;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace vismem
