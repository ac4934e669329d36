#include "localization/app/config.h"

#include <vector>

#include "common/config/config_error.h"
#include "common/config/parameter_reader.h"
#include "common/geometry/angles.h"
#include "common/segment_map/map_check.h"
#include "common/vision/palette.h"
#include "localization/app/retired_keys.h"

namespace vismem {

LocalizerParams readLocalizerParams(ConfigReader& reader) {
  const Key key = basic("Mode", "default, or chapter as published");
  const auto mode = reader.describe(key).choice(
      key.name, LocalizationMode::kDefault,
      {{"default", LocalizationMode::kDefault}, {"chapter", LocalizationMode::kChapter}});
  LocalizerParams params = localizerPreset(mode);
  ParameterReader parameters(reader);
  params.visit(parameters);
  acceptRetiredLocalizationKeys(reader);
  return params;
}

GazePlannerParams readGazePlannerParams(ConfigReader& reader) {
  GazePlannerParams params;
  ParameterReader parameters(reader);
  parameters.group("Gaze", params);
  return params;
}

LocalizationConfig readLocalizationConfig(ConfigReader& reader) {
  constexpr double kFar = 1e4;
  LocalizationConfig config;
  reader.describe(basic("VisualMemory.Proxy", "the visual memory, required"));
  config.visual_memory_proxy = reader.requiredText(
      "VisualMemory.Proxy", "the proxy of a visual memory, such as VisualMemory:tcp -h 127.0.0.1 -p 9970");
  reader.describe(basic("Map", "map of labelled segments, required"));
  config.map = reader.requireFile("Map", "a map of labelled segments, such as cfg/maps/corridor.csv");
  reader.describe(basic("Palette", "names the edges of the map's stripes; needed where rows have a width"));
  config.palette = reader.existingFile("Palette", "a palette, such as cfg/maps/corridor.palette");
  reader.describe(basic("Seed", "seed of all random numbers"));
  config.seed = static_cast<std::uint64_t>(reader.integer("Seed", 1, 0, 2'000'000'000));
  reader.describe(expert("Start.Position_m", "a known start; without it the start is unknown"));
  reader.describe(expert("Start.Heading_deg", "its heading"));
  if (reader.isSet("Start.Position_m") || reader.isSet("Start.Heading_deg")) {
    const std::vector<double> position = reader.reals("Start.Position_m", {0.0, 0.0}, -kFar, kFar);
    config.start = Pose2{position[0], position[1], reader.angleDeg("Start.Heading_deg", 0.0, -360.0, 360.0)};
  }
  reader.known("Start.Position_m");
  reader.known("Start.Heading_deg");
  reader.describe(expert("Pose3D.MillimetreScale", "JdeRobot's positions in millimetres"));
  config.pose3d_scale = reader.boolean("Pose3D.MillimetreScale", false) ? 1000.0 : 1.0;
  reader.describe(
      basic("Gaze.Proxy", "the gaze that is requested while the pose is uncertain; empty: no requests"));
  config.gaze_proxy = reader.text("Gaze.Proxy", "");
  config.gaze = readGazePlannerParams(reader);
  config.params = readLocalizerParams(reader);
  return config;
}

LoadedMap loadMapEdges(const std::filesystem::path& map, const std::filesystem::path& palette) {
  SegmentMap rows;
  PaletteLabels labels;
  std::vector<std::string> warnings;
  std::vector<std::string> problems;
  const auto collect = [&problems](auto&& step) {
    try {
      step();
    } catch (const ConfigError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  };
  collect([&] { rows = loadSegmentMap(map); });
  collect([&] {
    if (palette.empty()) return;
    const Palette colours = loadPalette(palette);
    const std::vector<Label> edges = colours.labels();
    labels = {{edges.begin(), edges.end()},
              colours.stripes(),
              colours.labelsOffFloor().value_or(std::set<Label>())};
    warnings = colours.warnings();
  });
  if (!problems.empty()) throw ConfigError(problems);
  LoadedMap loaded{rows, expandStripes(rows, labels.stripes), std::move(warnings)};
  if (palette.empty()) return loaded;
  for (auto& warning : checkMap(rows, map.string(), labels, palette.string()))
    loaded.warnings.push_back(std::move(warning));
  return loaded;
}

}  // namespace vismem
