/// @file Has somebody moved the robot? From how the memory agrees with the images. Pure. SPEC M10.
#pragma once

#include <algorithm>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// How one image met what was well remembered: elements seen lately, before much was driven, so that drift of
/// the odometry does not look like a new place.
struct SceneAgreement {
  int matched = 0;  ///< expected and observed
  int absent = 0;   ///< expected, and their places are bare
  int covered = 0;  ///< expected, and something else is seen there: an occlusion says nothing
  int fresh = 0;    ///< observed on the floor, and not known, or only since a few seconds or doubts began
};

/// Gathers evidence over images. *Single-threaded* (owner: the visual memory). An occlusion (covered, nothing
/// bare), the removal of one object (others are still there) and drift (old elements do not count) are no
/// kidnapping.
class KidnapDetector {
 public:
  struct Params {
    bool enabled = true;
    double duration_s = 1.0;         ///< of images that disagree
    double min_absent_share = 0.25;  ///< of what was expected
    double max_matched_share = 0.2;
    double single_weight = 0.5;  ///< of an image in which one element only is absent
    int min_fresh = 2;
    double agreeing_share = 0.4;    ///< matched share that takes evidence back
    double max_doubt_s = 40.0;      ///< doubts that were neither settled nor grew enough by then are dropped
    double max_image_gap_s = 0.25;  ///< an image speaks for at most this long
  };

  explicit KidnapDetector(const Params& params) : params_(params) {}

  /// @return true once when the robot seems to have been moved.
  bool update(StampUs stamp_us, const SceneAgreement& scene) {
    const double dt = last_us_ && stamp_us > *last_us_ ? toSeconds(stamp_us - *last_us_) : 0.0;
    last_us_ = stamp_us;
    if (agreed_us_ && toSeconds(stamp_us - *agreed_us_) > params_.max_doubt_s) {
      evidence_s_ = 0.0;
      agreed_us_.reset();
    }
    const int expected = scene.matched + scene.absent + scene.covered;
    if (!params_.enabled || expected == 0) return false;
    const double seen_s = std::min(dt, params_.max_image_gap_s);
    const double matched_share = static_cast<double>(scene.matched) / expected;
    const double absent_share = static_cast<double>(scene.absent) / expected;
    // Behind something that drives along a place or two look bare now and then: what is covered must be the
    // smaller part.
    if (absent_share >= params_.min_absent_share && matched_share <= params_.max_matched_share &&
        scene.absent > scene.covered && scene.fresh >= params_.min_fresh) {
      evidence_s_ += (scene.absent > 1 ? 1.0 : params_.single_weight) * seen_s;
    } else if (matched_share >= params_.agreeing_share) {
      evidence_s_ = std::max(0.0, evidence_s_ - seen_s);
      agreed_us_ = stamp_us;
    }
    if (evidence_s_ < params_.duration_s) return false;
    reset();
    return true;
  }

  /// While the robot may have been moved: when the scene agreed last. What was found since then may belong to
  /// another place: that it is seen again tells nothing of this one.
  std::optional<StampUs> doubtSince() const { return evidence_s_ > 0.0 ? agreed_us_ : std::nullopt; }

  void reset() {
    evidence_s_ = 0.0;
    last_us_.reset();
    agreed_us_.reset();
  }
  double evidence_s() const { return evidence_s_; }

 private:
  Params params_;
  double evidence_s_ = 0.0;
  std::optional<StampUs> last_us_;
  std::optional<StampUs> agreed_us_;
};

}  // namespace vismem
