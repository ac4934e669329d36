#include "localization/core/hypotheses/tracking.h"

#include <algorithm>

namespace vismem {
namespace {

/// An inconsistent image after so many consistent ones may be a jump of the robot.
constexpr int kConsistentPeriod = 15;
/// A suspicion ends when images and races agreed with the winner for so many iterations: a wrong winner keeps
/// nearly all belief for a second.
constexpr int kSuspicionEnds = 5;
constexpr StampUs kLongestSuspicion_us = 3 * kSecondUs;
/// Tracking begins after so many unambiguous iterations, although many observed segments may be missing in
/// the map, which keeps reliability low.
constexpr int kTrackingAfter = 15;

}  // namespace

bool isSuspect(const TrackingState& state, StampUs now_us) {
  return state.suspect_since_us && now_us < *state.suspect_since_us + kLongestSuspicion_us;
}

TrackingState nextTracking(TrackingState state, const TrackingEvidence& evidence) {
  if (evidence.is_inconsistent && state.consistent_iterations >= kConsistentPeriod) {
    state.suspect_since_us = evidence.stamp_us;
    state.unambiguous_iterations = 0;
  }
  state.consistent_iterations = evidence.is_inconsistent ? 0 : state.consistent_iterations + 1;
  state.unambiguous_iterations = evidence.is_unambiguous ? state.unambiguous_iterations + 1 : 0;
  const bool agree = std::min(state.consistent_iterations, state.unambiguous_iterations) >= kSuspicionEnds;
  if (agree || !isSuspect(state, evidence.stamp_us)) state.suspect_since_us.reset();
  if (!evidence.has_winner) {
    state.mode = Tracking::kLost;
  } else if (!state.suspect_since_us && state.unambiguous_iterations >= kTrackingAfter) {
    state.mode = Tracking::kTracking;
  } else {
    state.mode = Tracking::kAmbiguous;
  }
  return state;
}

TrackingState restartedTracking(TrackingState state, bool has_winner) {
  state.mode = has_winner ? Tracking::kAmbiguous : Tracking::kLost;
  state.unambiguous_iterations = 0;
  state.suspect_since_us.reset();
  return state;
}

}  // namespace vismem
