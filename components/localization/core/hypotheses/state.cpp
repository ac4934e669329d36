#include "localization/core/hypotheses/state.h"

#include <algorithm>

namespace vismem {
namespace {

/// An inconsistent observation after so many consistent ones may be a jump of the robot.
constexpr int kConsistentPeriod = 15;
/// A suspicion ends when images and races agreed with the winner for so many iterations: a wrong winner keeps
/// nearly all belief for a second.
constexpr int kSuspicionEnds = 5;
/// The search idles after so many unambiguous iterations, although many observed segments may be missing in
/// the map, which keeps reliability low.
constexpr int kIdleAfter = 15;

}  // namespace

bool TrackingState::addObservation(bool is_inconsistent, StampUs stamp_us) {
  const bool begins = is_inconsistent && consistent_iterations_ >= kConsistentPeriod;
  if (begins) {
    suspect_since_us_ = stamp_us;
    unambiguous_iterations_ = 0;
  }
  consistent_iterations_ = is_inconsistent ? 0 : consistent_iterations_ + 1;
  return begins;
}

void TrackingState::addSelection(bool is_unambiguous) {
  unambiguous_iterations_ = is_unambiguous ? unambiguous_iterations_ + 1 : 0;
}

void TrackingState::reset() {
  unambiguous_iterations_ = 0;
  suspect_since_us_.reset();
}

bool TrackingState::isSuspect(StampUs now_us, double suspect_time_s) const {
  return suspect_since_us_ && std::min(unambiguous_iterations_, consistent_iterations_) < kSuspicionEnds &&
         now_us < *suspect_since_us_ + static_cast<StampUs>(suspect_time_s * kSecondUs);
}

bool TrackingState::isIdle() const {
  return unambiguous_iterations_ >= kIdleAfter;
}

}  // namespace vismem
