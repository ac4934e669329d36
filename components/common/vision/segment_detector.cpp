#include "common/vision/segment_detector.h"

#include "common/config/config_error.h"

namespace vismem {

const std::vector<std::string>& segmentDetectorNames() {
  static const std::vector<std::string> kNames{"solis", "chapter", "hough"};
  return kNames;
}

std::unique_ptr<SegmentDetector> makeSegmentDetector(std::string_view name) {
  if (name == "solis") return makeSolisDetector();
  if (name == "chapter") return makeChapterDetector();
  if (name == "hough") return makeHoughDetector();
  throw ConfigError(
      {"unknown segment detector \"" + std::string(name) + "\" (known: solis, chapter, hough)"});
}

}  // namespace vismem
