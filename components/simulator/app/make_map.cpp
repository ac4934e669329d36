// make_map WORLD.world --palette FILE -o MAP.csv: the segment map of a simulated world (DESIGN 11, 14).
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "simulator/app/model_paths.h"
#include "simulator/core/map_builder.h"

int main(int argc, char** argv) {
  CLI::App app{"Derives the segment map of a world: its edges between colours that the palette names."};
  std::string world_file;
  std::string palette_file;
  std::string out;
  std::vector<std::string> model_paths;
  vismem::MapBuilderParams params;
  app.add_option("world", world_file, "World file (SDF)")->required();
  app.add_option("--palette", palette_file, "Colour classes and the pairs that make an edge")->required();
  app.add_option("-o,--out", out, "Map to write (CSV)")->required();
  app.add_option("--models", model_paths,
                 "Folders in which model:// names are searched, before those of GAZEBO_MODEL_PATH and "
                 "GZ_SIM_RESOURCE_PATH");
  app.add_option("--eye-height", params.eye_height_m, "Height of the camera [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    const vismem::Palette palette = vismem::loadPalette(palette_file);
    const auto loaded = vismem::loadWorld(world_file, vismem::modelPaths(model_paths));
    for (const auto& warning : loaded.warnings) std::cerr << "warning: " << warning << "\n";
    const auto map = vismem::buildSegmentMap(loaded.world, palette, params);
    if (map.segments.empty()) {
      throw vismem::ConfigError(
          {world_file + ": no edge lies between two colour classes that " + palette_file + " pairs"});
    }
    vismem::saveSegmentMap(map, out);
    std::map<std::string, int> labels;
    for (const auto& segment : map.segments) ++labels[segment.label];
    std::cout << nlohmann::json{{"file", out}, {"segments", map.segments.size()}, {"labels", labels}}.dump()
              << std::endl;
    return 0;
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "make_map: " << error.what() << "\n";
    return 1;
  }
}
