#include "common/kinematics/calibrated_ports.h"

#include <limits>

namespace vismem {
namespace {

/// A reader's "everything" stays that, whatever the delay.
StampUs laterBy(StampUs delay_us, StampUs stamp_us) {
  if (stamp_us <= std::numeric_limits<StampUs>::min() + kSecondUs * 10) return stamp_us;
  return stamp_us + delay_us;
}

}  // namespace

JointCorrection inverse(const JointCorrection& correction) {
  return {1.0 / correction.pan_scale, 1.0 / correction.tilt_scale, -correction.delay_us};
}

PanTiltLimits CalibratedPanTilt::limits() const {
  PanTiltLimits limits = unit_.limits();
  limits.min_pan_rad *= correction_.pan_scale;
  limits.max_pan_rad *= correction_.pan_scale;
  limits.max_pan_rate_radps *= correction_.pan_scale;
  limits.min_tilt_rad *= correction_.tilt_scale;
  limits.max_tilt_rad *= correction_.tilt_scale;
  limits.max_tilt_rate_radps *= correction_.tilt_scale;
  return limits;
}

PortReply CalibratedPanTilt::command(const PanTiltCommand& command) {
  PanTiltCommand reported = command;
  reported.pan_rad /= correction_.pan_scale;
  reported.pan_rate_radps /= correction_.pan_scale;
  reported.tilt_rad /= correction_.tilt_scale;
  reported.tilt_rate_radps /= correction_.tilt_scale;
  return unit_.command(reported);
}

SampleBatch<PanTiltSample> CalibratedPanTilt::samplesSince(StampUs after_us,
                                                           std::chrono::milliseconds timeout) {
  auto batch = unit_.samplesSince(laterBy(correction_.delay_us, after_us), timeout);
  for (PanTiltSample& sample : batch.samples) {
    sample.stamp_us -= correction_.delay_us;
    sample.pan_rad *= correction_.pan_scale;
    sample.tilt_rad *= correction_.tilt_scale;
  }
  return batch;
}

SampleBatch<OdometrySample> CalibratedBase::samplesSince(StampUs after_us,
                                                         std::chrono::milliseconds timeout) {
  auto batch = base_.samplesSince(laterBy(delay_us_, after_us), timeout);
  const std::lock_guard lock(mutex_);
  for (OdometrySample& sample : batch.samples) sample = correction_.corrected(sample);
  return batch;
}

}  // namespace vismem
