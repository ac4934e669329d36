/// @file The compared detectors: the default detector and published ones behind one interface.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// *Single-threaded*.
class MeasuredDetector {
 public:
  virtual ~MeasuredDetector() = default;
  /// The timed part: from a gray image to the detector's own list of segments.
  virtual void run(const cv::Mat& gray) = 0;
  /// Of the last run; converted outside the timing.
  virtual std::vector<Segment2> segments() const = 0;
};

struct DetectorEntry {
  std::string name;
  std::string settings;
  bool ours = false;  ///< the default detector, which the others are compared with
  bool slow = false;  ///< timed fewer times, and not at 1920x1080
  std::function<std::unique_ptr<MeasuredDetector>()> make;
};

/// Names in tables and JSON, fixed.
inline const std::string kOurs = "solis";
inline const std::string kTunedEdLines = "edlines_tuned";
inline const std::string kLsd = "lsd";

/// The default detector is the first.
std::vector<DetectorEntry> measuredDetectors();

}  // namespace vismem
