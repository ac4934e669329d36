#include "recorder/app/map_markers.h"

#include <array>
#include <map>
#include <utility>

#include "common/recording/ros_messages.h"
#include "recorder/core/recorder_core.h"
#include "recorder/ice/sensor_messages.h"

namespace vismem {
namespace {

constexpr double kEdgeWidth_m = 0.02;

RosPoint point(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

RecordedMessage mapMarkers(const SegmentMap& map) {
  static constexpr std::array<std::array<float, 4>, 6> kColors{{{0.9F, 0.9F, 0.9F, 1.0F},
                                                                {0.6F, 0.8F, 1.0F, 1.0F},
                                                                {1.0F, 0.8F, 0.5F, 1.0F},
                                                                {0.7F, 1.0F, 0.7F, 1.0F},
                                                                {1.0F, 0.7F, 0.9F, 1.0F},
                                                                {0.8F, 0.8F, 0.4F, 1.0F}}};
  // One marker a label and width: a viewer draws all lines of a marker alike.
  std::map<std::pair<Label, double>, RosMarker> markers;
  for (const MapSegment& segment : map.segments) {
    const auto [item, added] = markers.try_emplace({segment.label, segment.width_m});
    RosMarker& marker = item->second;
    if (added) {
      marker.header.frame_id = kWorldFrame;
      marker.ns = segment.label;
      marker.scale.x = segment.width_m > 0.0 ? segment.width_m : kEdgeWidth_m;
    }
    marker.points.push_back(point(segment.world.a));
    marker.points.push_back(point(segment.world.b));
  }
  std::vector<RosMarker> list;
  for (auto& [key, marker] : markers) {
    marker.id = static_cast<std::int32_t>(list.size());
    marker.rgba = kColors[list.size() % kColors.size()];
    list.push_back(std::move(marker));
  }
  return {makeTopic("/map", kMarkersType, /*image=*/false, /*latched=*/true), 0,
          std::make_shared<const Bytes>(serialize(list))};
}

}  // namespace vismem
