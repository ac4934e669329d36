/// @file State machine of the winner: lost, ambiguous, tracking. Pure. See L6, L12.
#pragma once

namespace vismem {

enum class Tracking {
  kLost,       ///< no race is chosen
  kAmbiguous,  ///< a race is chosen, but a rival or an image contradicts it, or did a moment ago
  kTracking,   ///< one race has had nearly all belief for some iterations: the search for others idles
};

/// What one iteration says of the winner.
struct TrackingEvidence {
  bool has_winner = false;
  /// The image supports the winner much less than its reliability predicts.
  bool is_inconsistent = false;
  /// The winner stayed the same and has nearly all belief.
  bool is_unambiguous = false;
};

/// A value; one per Localizer.
struct TrackingState {
  Tracking mode = Tracking::kLost;
  int consistent_iterations = 0;   ///< since an image contradicted
  int unambiguous_iterations = 0;  ///< since there was a rival, or an image contradicted a consistent period
};

/// The transition function. An inconsistent image after a consistent period may be a jump of the robot:
/// tracking begins anew.
TrackingState nextTracking(TrackingState state, const TrackingEvidence& evidence);

/// The state in a new epoch, or after a pose from outside: rivals are forgotten.
TrackingState restartedTracking(TrackingState state, bool has_winner);

}  // namespace vismem
