#include "application/app/status_line.h"

#include <ostream>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/geometry/rounding.h"

namespace vismem {
namespace {

/// Reliability from which the page says that the robot knows where it is.
constexpr double kSure = 0.7;
/// Age above which a pose is no longer the present one.
constexpr StampUs kOld_us = kSecondUs;

const char* nameOf(GazeState state) {
  switch (state) {
    case GazeState::kSelect:
      return "selects";
    case GazeState::kSaccade:
      return "moves to";
    case GazeState::kAnalyse:
      return "analyses";
    case GazeState::kTrack:
      return "tracks";
  }
  return "?";
}

const char* nameOf(AttentionKind kind) {
  switch (kind) {
    case AttentionKind::kSegment:
      return "segment";
    case AttentionKind::kPrimitive:
      return "primitive";
    case AttentionKind::kScanning:
      return "scanning point";
    case AttentionKind::kHypothesis:
      return "hypothesis";
    case AttentionKind::kClient:
      return "client's request";
  }
  return "?";
}

std::string gazeText(const GazeStatus& gaze) {
  if (gaze.mode == GazeMode::kOff) return "gaze off";
  const std::string text = std::string("gaze ") + nameOf(gaze.state);
  return gaze.target ? text + " " + nameOf(gaze.target->kind) : text;
}

}  // namespace

std::string statusText(const LiveState& live, const std::optional<GazeStatus>& gaze) {
  // A narrow terminal shows the beginning.
  std::string text = formatted("%6.1f s", live.elapsed_s());
  if (live.is_paused) text += ", paused";
  if (!live.recording_failure.empty()) text += " | recording failed: " + live.recording_failure;
  if (!live.drive_failure.empty()) text += " | cannot drive: " + live.drive_failure;
  if (live.estimate && live.estimate->T_world_robot) {
    const Pose2& pose = *live.estimate->T_world_robot;
    const bool is_sure = live.estimate->reliability >= kSure;
    text += formatted(" | %s %.2f %.2f m %.0f deg, reliability %.2f",
                      is_sure ? "pose" : "not sure, best guess", rounded(pose.x, 100), rounded(pose.y, 100),
                      rounded(radToDeg(pose.theta), 1), live.estimate->reliability);
    const StampUs age_us = live.now_us - live.estimate->stamp_us;
    if (age_us > kOld_us) text += formatted(" %.0f s ago", toSeconds(age_us));
  } else {
    text += " | no pose";
  }
  if (live.error) {
    text +=
        formatted(" | error %.2f m %.1f deg", *live.error->position_m, radToDeg(*live.error->heading_rad));
    if (live.is_twin) text += " of the twin place, from which the map looks the same";
  }
  text +=
      formatted(" | camera %4.1f Hz | memory %4.1f Hz, %zu segments", live.is_paused ? 0.0 : live.camera_hz,
                live.is_paused ? 0.0 : live.memory_hz, live.memory_segments);
  return text + " | " + (gaze ? gazeText(*gaze) : std::string("no gaze"));
}

bool StatusLine::due(std::chrono::steady_clock::time_point now) {
  const auto pause = terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(1000);
  if (last_ && now - *last_ < pause) return false;
  last_ = now;
  return true;
}

void StatusLine::show(const std::string& text) {
  if (terminal_) {
    // Without the terminal's wrapping: a wrapped line could not be rewritten in place.
    out_ << "\r\033[K\033[?7l" << text << "\033[?7h" << std::flush;
    open_ = true;
  } else {
    out_ << text << std::endl;
  }
}

void StatusLine::end() {
  if (open_) out_ << std::endl;
  open_ = false;
}

}  // namespace vismem
