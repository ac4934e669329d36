#include "mapper/app/config.h"

#include "active_visual_memory/app/config.h"
#include "common/config/file_name.h"
#include "common/config/properties.h"
#include "common/process/process_keys.h"
#include "common/vision/palette.h"
#include "localization/app/config.h"

namespace vismem {
namespace {

/// The whole configuration of another component. @throws ConfigError with its problems.
template <typename Read>
auto readOther(const std::filesystem::path& file, const char* prefix, Read read) {
  const Properties properties = Properties::load(file);
  ConfigReader config(properties);
  ConfigReader reader = config.group(prefix);
  knowProcessKeys(config, prefix);
  auto result = read(reader);
  config.finish();
  return result;
}

}  // namespace

MapperConfig readMapperConfig(ConfigReader& reader) {
  MapperConfig config;
  reader.describe(basic("VisualMemory.Proxy", "the visual memory, required"));
  config.visual_memory_proxy = reader.requiredText(
      "VisualMemory.Proxy", "the proxy of a visual memory, such as VisualMemory:tcp -h 127.0.0.1 -p 9970");
  reader.describe(basic("Camera.Proxy", "the camera of that memory, required"));
  config.camera_proxy =
      reader.requiredText("Camera.Proxy", "the proxy of an avm::Camera, such as cameraA:tcp -p 9999");
  reader.describe(basic("MemoryConfiguration", "the memory's own file: camera, tilt, odometry, palette"));
  const auto memory_file = reader.requireFile("MemoryConfiguration", "the file of active_visual_memory");
  reader.describe(basic("LocalizationConfiguration", "localization's file: how places are found again"));
  const auto localization_file = reader.requireFile("LocalizationConfiguration", "the file of localization");
  reader.describe(basic("Palette", "colours and labels; default: that of the memory's configuration"));
  config.blank.palette_file = reader.existingFile("Palette", "a palette, such as cfg/maps/corridor.palette");
  reader.describe(basic("Folder", "where maps are written"));
  config.files.out = reader.outputPath("Folder", "out/maps");
  reader.describe(basic("Name", "of a map's files"));
  config.files.name = reader.text("Name", "map");
  if (const std::string wrong = checkFileName(config.files.name); !wrong.empty())
    reader.problem("Name", wrong);
  reader.describe(basic("Since", "an earlier map of the place: what changed is listed beside each map"));
  config.files.since = reader.existingFile("Since", "a map, such as out/maps/map.csv");
  config.files.source = "live";
  if (!reader.good()) return config;

  std::filesystem::path& palette = config.blank.palette_file;
  if (!palette.empty()) config.blank.stripes = loadPalette(palette).stripes();
  const ActiveVisualMemoryConfig memory =
      readOther(memory_file, "ActiveVisualMemory", [&](ConfigReader& other) {
        auto read = readActiveVisualMemoryConfig(other);
        if (!palette.empty() || read.palette.empty() || !other.good()) return read;
        palette = read.palette;
        config.blank.stripes = other.loading([&] { return loadPalette(palette); }).stripes();
        return read;
      });
  const LocalizerParams localizer = readOther(localization_file, "Localization", [](ConfigReader& other) {
    readGazePlannerParams(other);
    // A setup without a map yet has this component before localization.
    for (const char* key :
         {"VisualMemory.Proxy", "Map", "Palette", "Seed", "Start.*", "Pose3D.*", "Gaze.Proxy"})
      other.known(key);
    return readLocalizerParams(other);
  });
  config.loop.keyframes = KeyframeParams::of(memory.pipeline.memory);
  config.blank.params = DriveMapperParams::of(memory.pipeline.memory, localizer);
  config.loop.range_m = localizer.robust.observation.range_m;
  if (palette.empty()) reader.problem("Palette", "is required: " + memory_file.string() + " has none either");
  return config;
}

}  // namespace vismem
