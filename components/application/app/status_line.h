/// @file The live status of a run: one line, rewritten in place on a terminal.
#pragma once

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>

#include "application/app/run_observer.h"
#include "common/visual_memory/gaze.h"

namespace vismem {

/// "  12.3 s | pose 1.25 -0.50 m 90 deg, reliability 0.75 | error ... | camera ... | memory ... | gaze tracks
/// segment". A pose that is not reliable is called "not sure, best guess"; an old one has its age.
std::string statusText(const LiveState& live, const std::optional<GazeStatus>& gaze);

/// Shows texts five times a second on a terminal, elsewhere one line a second. *Single-threaded.*
class StatusLine {
 public:
  StatusLine(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  ~StatusLine() { end(); }
  /// @return whether it is time for the next text.
  bool due(std::chrono::steady_clock::time_point now);
  void show(const std::string& text);
  /// Ends the rewritten line, before other output.
  void end();

 private:
  std::ostream& out_;
  bool terminal_;
  bool open_ = false;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace vismem
