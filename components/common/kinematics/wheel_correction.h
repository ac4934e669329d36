/// @file Odometry of wheels whose size and distance differ from what the base assumes. Pure.
#pragma once

#include <optional>

#include "common/kinematics/odometry.h"
#include "common/robot/samples.h"

namespace vismem {

/// Scales of both wheels' travel as the base reports it, and the true distance of the wheels.
struct WheelModel {
  double left_scale = 1.0;
  double right_scale = 1.0;
  double base_m = 0.33;

  bool operator==(const WheelModel&) const = default;
};

/// Travel of both wheels between two reported poses, which lie on one arc.
/// @param base_m that the odometry assumes.
WheelTravel travelBetween(const Pose2& from, const Pose2& to, double base_m);

/// What is known better than the base itself does.
struct WheelCorrectionParams {
  WheelModel model;
  double reported_base_m = 0.33;  ///< with which the model was fitted; the base's own, or any other
  StampUs delay_us = 0;           ///< stamps of the odometry are late by this

  /// Whether the wheels are as the base assumes: poses then stay as reported, also sideways steps of legs.
  bool hasReportedWheels() const { return model == WheelModel{1.0, 1.0, reported_base_m}; }
};

/// Turns true odometry into that which `correction` corrects: for simulated robots.
WheelCorrectionParams inverse(const WheelCorrectionParams& correction);

/// Turns odometry samples in their order into those of the corrected wheels. Numbers are kept; after a
/// restart of the odometry (numbers go back) it begins anew at the reported pose. *Single-threaded.*
class WheelCorrection {
 public:
  explicit WheelCorrection(const WheelCorrectionParams& params) : params_(params) {}

  OdometrySample corrected(const OdometrySample& reported);

 private:
  WheelCorrectionParams params_;
  std::optional<OdometrySample> reported_;  ///< the sample before
  Pose2 pose_;
};

}  // namespace vismem
