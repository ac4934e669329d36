// make_map WORLD.world|DRAWING.svg --palette FILE -o MAP.csv: the segment map of a simulated world or of a
// drawing of the floor.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/tool/command_line_tool.h"
#include "simulator/app/model_paths.h"
#include "simulator/core/map_builder.h"
#include "simulator/core/svg_map.h"

namespace {

bool isDrawing(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".svg";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Derives the segment map of a world, or of a drawing of the floor: its edges between colour pairs of "
      "the palette."};
  std::string input;
  std::string palette_file;
  std::string out;
  std::vector<std::string> model_paths;
  vismem::MapBuilderParams params;
  vismem::SvgMapParams drawing;
  double metres_per_unit = 0.0;
  std::vector<double> origin;
  app.add_option("world", input, "World file (SDF), or a drawing (.svg)")->required();
  app.add_option("--palette", palette_file, "Colour classes and the pairs that make an edge")->required();
  app.add_option("-o,--out", out, "Map to write (CSV)")->required();
  app.add_option("--models", model_paths,
                 "Folders in which model:// names are searched, before those of GAZEBO_MODEL_PATH and "
                 "GZ_SIM_RESOURCE_PATH");
  app.add_option("--eye-height", params.eye_height_m, "Height of the camera [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  auto* unit =
      app.add_option("--metres-per-unit", metres_per_unit,
                     "Drawing: size of its user unit [m]; default: from its width and height in mm, cm or in")
          ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--scale", drawing.drawing.scale, "Drawing on paper: 50 for a scale of 1:50")
      ->check(CLI::Range(1e-3, 1e6))
      ->excludes(unit)
      ->capture_default_str();
  app.add_option(
         "--origin", origin,
         "Drawing: X,Y of the world's (0, 0) in its user units (y down); default: its lower left corner")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--ground", drawing.ground, "Drawing: colour class of the unpainted ground; default: none");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    const vismem::Palette palette = vismem::loadPalette(palette_file);
    vismem::SegmentMap map;
    std::vector<std::string> warnings;
    if (isDrawing(input)) {
      if (metres_per_unit > 0.0) drawing.drawing.metres_per_unit = metres_per_unit;
      if (!origin.empty()) drawing.drawing.origin = Eigen::Vector2d(origin[0], origin[1]);
      auto made =
          vismem::buildSvgMap(vismem::readTextFile(input, "a drawing in SVG"), input, palette, drawing);
      map = std::move(made.map);
      warnings = std::move(made.warnings);
    } else {
      auto loaded = vismem::loadWorld(input, vismem::modelPaths(model_paths));
      map = vismem::buildSegmentMap(loaded.world, palette, params);
      warnings = std::move(loaded.warnings);
    }
    for (const auto& warning : warnings) std::cerr << "warning: " << warning << "\n";
    if (map.segments.empty()) {
      throw vismem::ConfigError({input + ": no edge lies between two colour classes that " + palette_file +
                                 " pairs" +
                                 (isDrawing(input) && drawing.ground.empty()
                                      ? " (--ground sets the colour class of the unpainted ground)"
                                      : "")});
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
