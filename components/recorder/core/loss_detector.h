/// @file When a robot that knew where it was has lost itself. Pure.
#pragma once

namespace vismem {

/// Fires once when the reliability, having been at least `sure`, falls under `lost`. *Single-threaded.*
class LossDetector {
 public:
  /// @param lost, sure of PoseEstimate::reliability, 0 <= lost < sure <= 1.
  LossDetector(double lost, double sure) : lost_(lost), sure_(sure) {}

  /// @param reliability 0 while there is no pose. @return whether it has just been lost.
  bool update(double reliability) {
    if (reliability >= sure_) was_sure_ = true;
    if (!was_sure_ || reliability >= lost_) return false;
    was_sure_ = false;
    return true;
  }

 private:
  const double lost_;
  const double sure_;
  bool was_sure_ = false;
};

}  // namespace vismem
