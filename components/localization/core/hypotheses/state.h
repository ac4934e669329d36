/// @file Tracking state of the winner: consistent with the images, unambiguous among the races, or suspect.
/// Pure. See L6, L12.
#pragma once

#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// Counts iterations without contradiction, by images and by rival races. A value; one per Localizer.
class TrackingState {
 public:
  /// Counts one observation.
  /// @param is_inconsistent the winner explains it much worse than its reliability predicts.
  /// @return true if a suspicion begins: the first inconsistent observation after a consistent period.
  bool addObservation(bool is_inconsistent, StampUs stamp_us);
  /// Counts one selection of the winner.
  /// @param is_unambiguous the winner stayed the same and has nearly all belief.
  void addSelection(bool is_unambiguous);
  /// Forgets suspicion and unambiguous iterations, for a new epoch or a pose given from outside.
  void reset();

  /// True for `suspect_time_s` from the start of a suspicion, until images and races have agreed with the
  /// winner for some iterations.
  bool isSuspect(StampUs now_us, double suspect_time_s) const;
  /// True if the winner was unambiguous for so long that the search for other places may idle, even with
  /// low reliability.
  bool isIdle() const;
  /// True if the last selection was unambiguous.
  bool isUnambiguous() const { return unambiguous_iterations_ > 0; }

 private:
  int consistent_iterations_ = 0;
  int unambiguous_iterations_ = 0;
  std::optional<StampUs> suspect_since_us_;
};

}  // namespace vismem
