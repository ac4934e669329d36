/// @file Detection that the robot was moved by hand, from how the memory agrees with the images.
/// Pure. Implements M10.
#pragma once

#include <algorithm>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// Agreement of one image with the well-known elements: those seen lately and before much was driven, so that
/// odometry drift is not taken for a new place.
struct SceneAgreement {
  int matched = 0;   ///< expected and observed
  int absent = 0;    ///< expected, and their places are free
  int occluded = 0;  ///< expected, and their places are occluded: no evidence
  int fresh = 0;     ///< observed on the floor, and new or first seen since the suspicion began
};

/// Accumulates the evidence of images. *Single-threaded* (owner: the visual memory). An occlusion (no free
/// place), the removal of one object (others are matched) and drift (old elements do not count) are no
/// evidence of a kidnapping.
class KidnapDetector {
 public:
  struct Params {
    bool enabled = true;
    double duration_s = 1.0;         ///< of images that disagree
    double min_absent_share = 0.25;  ///< of the expected elements
    double max_matched_share = 0.2;
    double weight_per_absent = 0.5;  ///< of an image, for each absent element ..
    double max_weight = 2.0;         ///< .. at most this
    int min_fresh = 2;
    double agreeing_share = 0.4;    ///< matched share that takes evidence back
    double max_suspicion_s = 40.0;  ///< evidence that is neither confirmed nor taken back by then is dropped
    double max_image_gap_s = 0.25;  ///< an image is evidence for at most this long
  };

  explicit KidnapDetector(const Params& params) : params_(params) {}

  /// @return true once when the robot was moved.
  bool update(StampUs stamp_us, const SceneAgreement& scene) {
    const double dt = last_us_ && stamp_us > *last_us_ ? toSeconds(stamp_us - *last_us_) : 0.0;
    last_us_ = stamp_us;
    if (agreed_us_ && toSeconds(stamp_us - *agreed_us_) > params_.max_suspicion_s) {
      evidence_s_ = 0.0;
      agreed_us_.reset();
    }
    const int expected = scene.matched + scene.absent + scene.occluded;
    if (!params_.enabled || expected == 0) return false;
    const double seen_s = std::min(dt, params_.max_image_gap_s);
    const double matched_share = static_cast<double>(scene.matched) / expected;
    const double absent_share = static_cast<double>(scene.absent) / expected;
    // Behind a moving occluder one or two places look free now and then: the occluded ones must be fewer.
    if (absent_share >= params_.min_absent_share && matched_share <= params_.max_matched_share &&
        scene.absent > scene.occluded && scene.fresh >= params_.min_fresh) {
      evidence_s_ += std::min(params_.weight_per_absent * scene.absent, params_.max_weight) * seen_s;
    } else if (matched_share >= params_.agreeing_share) {
      evidence_s_ = std::max(0.0, evidence_s_ - seen_s);
      agreed_us_ = stamp_us;
    }
    if (evidence_s_ < params_.duration_s) return false;
    reset();
    return true;
  }

  /// The last agreement, while there is evidence of a kidnapping. Elements found since then may belong to
  /// another place, so a match with them does not confirm this one.
  std::optional<StampUs> suspectSince() const { return evidence_s_ > 0.0 ? agreed_us_ : std::nullopt; }

  void reset() {
    evidence_s_ = 0.0;
    last_us_.reset();
    agreed_us_.reset();
  }

 private:
  Params params_;
  double evidence_s_ = 0.0;
  std::optional<StampUs> last_us_;
  std::optional<StampUs> agreed_us_;
};

}  // namespace vismem
