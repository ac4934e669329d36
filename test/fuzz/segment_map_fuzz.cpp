// Maps of any bytes: segments that are finite and have a length, or an error that names lines.
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/config/config_error.h"
#include "common/segment_map/segment_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  try {
    const SegmentMap map = parseSegmentMap({reinterpret_cast<const char*>(data), size}, "fuzz.csv");
    if (map.segments.empty()) throw std::logic_error("a map without segments");
    for (const auto& segment : expandStripes(map, {}).segments) {
      if (!segment.world.a.allFinite() || !segment.world.b.allFinite() || !(segment.world.length() > 0.0)) {
        throw std::logic_error("an impossible segment");
      }
    }
  } catch (const ConfigError& error) {
    if (error.problems().empty()) throw std::logic_error("an error without a problem");
  }
  return 0;
}
