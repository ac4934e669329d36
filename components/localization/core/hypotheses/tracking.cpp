#include "localization/core/hypotheses/tracking.h"

namespace vismem {
namespace {

/// An inconsistent image after so many consistent ones may be a jump of the robot.
constexpr int kConsistentPeriod = 15;
/// Tracking begins after so many unambiguous iterations, although many observed segments may be missing in
/// the map, which keeps reliability low.
constexpr int kTrackingAfter = 15;

}  // namespace

TrackingState nextTracking(TrackingState state, const TrackingEvidence& evidence) {
  const bool may_be_jump = evidence.is_inconsistent && state.consistent_iterations >= kConsistentPeriod;
  state.consistent_iterations = evidence.is_inconsistent ? 0 : state.consistent_iterations + 1;
  state.unambiguous_iterations =
      evidence.is_unambiguous && !may_be_jump ? state.unambiguous_iterations + 1 : 0;
  if (!evidence.has_winner) {
    state.mode = Tracking::kLost;
  } else {
    state.mode = state.unambiguous_iterations >= kTrackingAfter ? Tracking::kTracking : Tracking::kAmbiguous;
  }
  return state;
}

TrackingState restartedTracking(TrackingState state, bool has_winner) {
  state.mode = has_winner ? Tracking::kAmbiguous : Tracking::kLost;
  state.unambiguous_iterations = 0;
  return state;
}

}  // namespace vismem
