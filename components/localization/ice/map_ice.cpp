#include "localization/ice/map_ice.h"

#include <cstdint>
#include <string_view>

#include "common/config/text_format.h"
#include "common/kinematics/random_stream.h"
#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

std::string_view bytesOf(const double& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

std::string mapId(const SegmentMap& map) {
  std::uint64_t hash = fnv1a("");
  for (const MapSegment& segment : map.segments) {
    for (const Eigen::Vector3d& end : {segment.world.a, segment.world.b}) {
      for (int i = 0; i < 3; ++i) hash = fnv1a(bytesOf(end[i]), hash);
    }
    hash = fnv1a(bytesOf(segment.width_m), hash);
    hash = fnv1a(segment.label, hash);
    hash = fnv1a(std::string_view("\0", 1), hash);  // the end of the label
  }
  return formatted("%016llx", static_cast<unsigned long long>(hash));
}

avm::MapContents toIce(const SegmentMap& map, const std::string& name) {
  avm::MapContents contents{mapId(map), name, {}};
  contents.segments.reserve(map.segments.size());
  for (const MapSegment& segment : map.segments) {
    contents.segments.push_back(
        {toIce(segment.world.a), toIce(segment.world.b), segment.label, segment.width_m});
  }
  return contents;
}

}  // namespace vismem
