#include "common/segment_map/map_check.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "common/config/config_error.h"
#include "common/config/nearest_name.h"
#include "common/config/text_format.h"

namespace vismem {
namespace {

std::string listed(const std::set<std::string>& names) {
  return names.empty() ? "none" : joined(names, ", ");
}

std::string at(const std::string& file, const MapSegment& segment) {
  return segment.line == 0 ? file + ": " : file + ":" + std::to_string(segment.line) + ": ";
}

/// The same for a row and for the row with its ends exchanged.
auto rowKey(const MapSegment& segment) {
  std::array<double, 3> a{segment.world.a.x(), segment.world.a.y(), segment.world.a.z()};
  std::array<double, 3> b{segment.world.b.x(), segment.world.b.y(), segment.world.b.z()};
  if (b < a) std::swap(a, b);
  return std::tuple(a, b, segment.label, segment.width_m);
}

/// The label of what a camera sees of a row.
Label seenLabel(const MapSegment& segment, const PaletteLabels& labels) {
  if (segment.width_m <= 0.0) return segment.label;
  const auto stripe = labels.stripes.find(segment.label);
  return stripe == labels.stripes.end() ? segment.label : stripe->second;
}

void warnOfRepeatedRows(const SegmentMap& map, const std::string& name, std::vector<std::string>& warnings) {
  std::map<decltype(rowKey(map.segments.front())), const MapSegment*> rows;
  for (const MapSegment& segment : map.segments) {
    const auto [first, is_new] = rows.try_emplace(rowKey(segment), &segment);
    if (is_new) continue;
    warnings.push_back(at(name, segment) + "the segment of line " + std::to_string(first->second->line) +
                       " again (it counts twice)");
  }
}

/// Of labels of the palette that the map lacks. One warning for each that may be misspelt, one for all the
/// others.
void warnOfAbsentLabels(const std::set<Label>& of_map, const std::string& map_name,
                        const PaletteLabels& of_palette, const std::string& palette_name,
                        std::vector<std::string>& warnings) {
  if (of_map.contains(kAnyLabel)) return;
  std::vector<std::string> others;
  const auto warn = [&](const std::string& subject, const std::string& rest) {
    warnings.push_back(palette_name + ": " + subject + " in no row of " + map_name + rest + " match nothing");
  };
  for (const Label& label : of_palette.edges) {
    if (of_map.contains(label)) continue;
    const std::string quoted = "\"" + label + "\"";
    const std::string meant = suggestion(label, {of_map.begin(), of_map.end()});
    if (meant.empty()) {
      if (!of_palette.upright.contains(label)) others.push_back(quoted);
    } else {
      warn("label " + quoted + " stands", meant + ": its observations");
    }
  }
  if (others.size() == 1) warn("label " + others[0] + " stands", ": its observations");
  if (others.size() > 1) {
    std::string names = others[0];
    for (std::size_t i = 1; i < others.size(); ++i)
      names += (i + 1 < others.size() ? ", " : " and ") + others[i];
    warn("labels " + names + " stand", ": their observations");
  }
}

}  // namespace

std::vector<std::string> checkMap(const SegmentMap& map, const std::string& map_name,
                                  const PaletteLabels& labels, const std::string& palette_name) {
  std::vector<std::string> warnings;
  std::set<std::string> known(labels.edges.begin(), labels.edges.end());
  for (const auto& [name, edge] : labels.stripes) known.insert(name);
  std::set<Label> of_map;
  std::set<Label> reported;
  std::size_t usable = 0;
  for (const MapSegment& segment : map.segments) {
    const Label label = seenLabel(segment, labels);
    of_map.insert(label);
    if (label == kAnyLabel || labels.edges.contains(label)) {
      ++usable;
    } else if (reported.insert(segment.label).second) {
      warnings.push_back(at(map_name, segment) + "label \"" + segment.label + "\" is named by no pair of " +
                         palette_name + suggestion(segment.label, known) +
                         ": its segments are never observed");
    }
  }
  if (usable == 0) {
    throw ConfigError({map_name + ": no label of the map is named by a pair of " + palette_name +
                       " (map: " + listed({of_map.begin(), of_map.end()}) +
                       "; palette: " + listed({labels.edges.begin(), labels.edges.end()}) + ")"});
  }
  warnOfAbsentLabels(of_map, map_name, labels, palette_name, warnings);
  warnOfRepeatedRows(map, map_name, warnings);
  if (map.ends_inside_row && !map.segments.empty() && map.segments.back().line > 0) {
    warnings.push_back(at(map_name, map.segments.back()) +
                       "the file ends without a line break: this row may be cut off");
  }
  return warnings;
}

}  // namespace vismem
