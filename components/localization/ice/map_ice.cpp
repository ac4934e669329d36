#include "localization/ice/map_ice.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

class Fnv1a {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  }
  void add(double value) {
    std::array<char, sizeof value> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    add(std::string_view(bytes.data(), bytes.size()));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::string mapId(const SegmentMap& map) {
  Fnv1a hash;
  for (const MapSegment& segment : map.segments) {
    for (const Eigen::Vector3d& end : {segment.world.a, segment.world.b}) {
      for (int i = 0; i < 3; ++i) hash.add(end[i]);
    }
    hash.add(segment.width_m);
    hash.add(segment.label);
    hash.add(std::string_view("\0", 1));  // the end of the label
  }
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash.value()));
  return digits.data();
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
