#include "camera_server/app/camera_health.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace vismem {

CameraHealth::CameraHealth(StatusBoard& status, std::string camera, double rate_hz)
    : status_(status),
      camera_(std::move(camera)),
      patience_s_(rate_hz > 0.0 ? std::max(2.0, 5.0 / rate_hz) : 2.0) {}

void CameraHealth::heard(const FrameResult& result, const std::string& lens_problem, SteadyTime now,
                         StampUs host_us) {
  if (last_ == SteadyTime{}) last_ = now;
  if (result.frame) {
    last_ = now;
    status_.count(camera_);
    if (!result.message.empty()) status_.error(camera_ + ": " + result.message);
    // Stamps of the images' own time line belong to another clock: they give no age.
    const double age_s = toSeconds(host_us - result.frame->stamp_us);
    if (age_s >= 0.0 && age_s < 10.0) status_.latency(camera_ + " age", age_s);
    if (lens_problem.empty()) {
      status_.healthy(camera_);
    } else {
      status_.fault(camera_, lens_problem);
    }
    return;
  }
  if (!result.message.empty()) {
    status_.fault(camera_, result.message);
  } else if (std::chrono::duration<double>(now - last_).count() > patience_s_) {
    status_.fault(camera_, "no picture for over " + std::to_string(static_cast<int>(patience_s_)) + " s");
  }
}

}  // namespace vismem
