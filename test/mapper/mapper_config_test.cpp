// The mapper's configuration: the shipped files, and what is wrong with others. Tests B6, C2.
#include <gmock/gmock.h>

#include <filesystem>

#include "common/config/config_error.h"
#include "common/config/properties.h"
#include "mapper/app/config.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

MapperConfig read(const Properties& properties) {
  ConfigReader config(properties);
  ConfigReader reader = config.group("Mapper");
  for (const char* key : {"Endpoints", "WebEndpoints", "LogLevel"}) reader.known(key);
  MapperConfig result = readMapperConfig(reader);
  config.finish();
  return result;
}

std::vector<std::string> problemsOf(const std::string& more) {
  const std::string sim = VISMEM_SOURCE_DIR "/cfg/sim/";
  try {
    read(
        Properties::parse("Mapper.VisualMemory.Proxy = VisualMemory:tcp -p 1\n"
                          "Mapper.MemoryConfiguration = " +
                              sim +
                              "active_visual_memory.cfg\n"
                              "Mapper.LocalizationConfiguration = " +
                              sim + "localization.cfg\n" + more,
                          "mapper.cfg"));
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(MapperConfig, EveryShippedFileIsRead) {
  int files = 0;
  for (const auto& setup : fs::directory_iterator(VISMEM_SOURCE_DIR "/cfg")) {
    const fs::path file = setup.path() / "mapper.cfg";
    if (!fs::exists(file)) continue;
    ++files;
    const MapperConfig config = read(Properties::load(file));
    EXPECT_EQ(config.files.name, "map") << file;
    EXPECT_TRUE(fs::exists(config.blank.palette_file)) << file;
    EXPECT_GT(config.loop.range_m, 1.0) << file;
    EXPECT_FALSE(config.blank.params.closing.localizer.map.opaque_labels.empty()) << file;
  }
  EXPECT_EQ(files, 2) << "robot, sim";
}

TEST(MapperConfig, KnowsWhatTheMemoryKnowsOfItsRobot) {
  const MapperConfig wheels = read(Properties::load(VISMEM_SOURCE_DIR "/cfg/sim/mapper.cfg"));
  const Properties walking = Properties::parse(
      "Mapper.VisualMemory.Proxy = VisualMemory:tcp -p 1\nMapper.Camera.Proxy = cameraA:tcp -p 2\n"
      "Mapper.MemoryConfiguration = " VISMEM_SOURCE_DIR
      "/cfg/humanoid/active_visual_memory.cfg\n"
      "Mapper.LocalizationConfiguration = " VISMEM_SOURCE_DIR "/cfg/humanoid/localization.cfg\n",
      "mapper.cfg");
  EXPECT_EQ(wheels.blank.params.graph.lever_m, 0.0);
  EXPECT_GT(read(walking).blank.params.graph.lever_m, 0.0);
}

TEST(MapperConfig, NamesEachWrongValueWithItsRule) {
  EXPECT_THAT(problemsOf(""), Contains(HasSubstr("Mapper.Camera.Proxy")));
  const std::string camera = "Mapper.Camera.Proxy = cameraA:tcp -p 2\n";
  EXPECT_THAT(problemsOf(camera + "Mapper.Name = ../map\n"), Contains(HasSubstr("Mapper.Name = ../map")));
  EXPECT_THAT(problemsOf(camera + "Mapper.Since = nowhere.csv\n"), Contains(HasSubstr("nowhere.csv")));
  EXPECT_THAT(problemsOf(camera + "Mapper.Folders = here\n"), Contains(HasSubstr("Mapper.Folder")));
  EXPECT_THAT(problemsOf(camera + "Mapper.Palette = nowhere.palette\n"),
              Contains(HasSubstr("nowhere.palette")));
}

}  // namespace
}  // namespace vismem
