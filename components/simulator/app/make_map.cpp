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
#include "common/tool/progress_line.h"
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

struct Arguments {
  std::string input;
  std::string palette_file;
  std::string out;
  std::vector<std::filesystem::path> model_paths;
  bool allow_partial = false;
  vismem::MapBuilderParams params;
  vismem::SvgMapParams drawing;
  double metres_per_unit = 0.0;
  std::vector<double> origin;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("world", a.input, "World file (SDF), or a drawing (.svg)")->required();
  app.add_option("--palette", a.palette_file, "Colour classes and the pairs that make an edge")->required();
  app.add_option("-o,--out", a.out, "Map to write (CSV)")->required();
  app.add_option("--models", a.model_paths,
                 "Folders in which model:// names are searched, before those of GAZEBO_MODEL_PATH and "
                 "GZ_SIM_RESOURCE_PATH");
  app.add_flag("--allow-partial", a.allow_partial,
               "World: make a map also when a visual had to be left out (otherwise exit code 1, no map)");
  app.add_option("--eye-height", a.params.eye_height_m, "Height of the camera [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  auto* unit =
      app.add_option("--metres-per-unit", a.metres_per_unit,
                     "Drawing: size of its user unit [m]; default: from its width and height in mm, cm or in")
          ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--scale", a.drawing.drawing.scale, "Drawing on paper: 50 for a scale of 1:50")
      ->check(CLI::Range(1e-3, 1e6))
      ->excludes(unit)
      ->capture_default_str();
  app.add_option(
         "--origin", a.origin,
         "Drawing: X,Y of the world's (0, 0) in its user units (y down); default: its lower left corner")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--ground", a.drawing.ground,
                 "Drawing: colour class of the unpainted ground; default: none");
}

struct Made {
  vismem::SegmentMap map;
  std::vector<std::string> warnings;
  std::string visuals;   ///< of a world: "116 of 116 visuals"
  bool is_whole = true;  ///< false: some of them are left out
};

vismem::LoadedWorld loadShowingProgress(const std::string& file,
                                        const std::vector<std::filesystem::path>& folders) {
  vismem::ProgressLine line("models of " + file);
  return vismem::loadWorld(file, vismem::modelPaths(folders),
                           [&](std::size_t done, std::size_t all) { line.show(done, all); });
}

Made mapOfWorld(const Arguments& a, const vismem::Palette& palette) {
  Made made;
  auto loaded = loadShowingProgress(a.input, a.model_paths);
  made.warnings = std::move(loaded.warnings);
  made.visuals = loaded.summary();
  made.is_whole = loaded.isWhole();
  if (!made.is_whole && !a.allow_partial) return made;
  vismem::ProgressLine line("edges of " + a.input);
  made.map = vismem::buildSegmentMap(loaded.world, palette, a.params,
                                     [&](std::size_t done, std::size_t all) { line.show(done, all); });
  return made;
}

Made mapOfDrawing(Arguments a, const vismem::Palette& palette) {
  if (a.metres_per_unit > 0.0) a.drawing.drawing.metres_per_unit = a.metres_per_unit;
  if (!a.origin.empty()) a.drawing.drawing.origin = Eigen::Vector2d(a.origin[0], a.origin[1]);
  auto drawn =
      vismem::buildSvgMap(vismem::readTextFile(a.input, "a drawing in SVG"), a.input, palette, a.drawing);
  return {std::move(drawn.map), std::move(drawn.warnings), "", true};
}

/// @return the exit code.
int makeMap(const Arguments& a) {
  const vismem::Palette palette = vismem::loadPalette(a.palette_file);
  const bool is_drawing = isDrawing(a.input);
  const Made made = is_drawing ? mapOfDrawing(a, palette) : mapOfWorld(a, palette);
  for (const auto& warning : palette.warnings()) std::cerr << "warning: " << warning << "\n";
  for (const auto& warning : made.warnings) std::cerr << "warning: " << warning << "\n";
  if (!made.is_whole) {
    std::cerr << a.input << ": " << made.visuals << ", the rest is left out"
              << (a.allow_partial ? "\n" : " (--allow-partial makes a map of what there is)\n");
    if (!a.allow_partial) return 1;
  }
  if (made.map.segments.empty()) {
    throw vismem::ConfigError(
        {a.input + ": no edge lies between two colour classes that " + a.palette_file + " pairs" +
         (is_drawing && a.drawing.ground.empty() ? " (--ground sets the colour class of the unpainted ground)"
                                                 : "")});
  }
  vismem::saveSegmentMap(made.map, a.out);
  std::map<std::string, int> labels;
  for (const auto& segment : made.map.segments) ++labels[segment.label];
  nlohmann::json summary{{"file", a.out}, {"segments", made.map.segments.size()}, {"labels", labels}};
  if (!is_drawing) summary["visuals"] = made.visuals;
  std::cout << summary.dump() << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Derives the segment map of a world, or of a drawing of the floor: its edges between colour pairs of "
      "the palette."};
  Arguments arguments;
  declare(app, arguments);
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    return makeMap(arguments);
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "make_map: " << error.what() << "\n";
    return 1;
  }
}
