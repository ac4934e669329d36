/// @file update_map: answers a list of changes and brings a map up to date.
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "mapper/app/map_updating.h"

int main(int argc, char** argv) {
  CLI::App app(
      "Answers what `map_from_drive --since MAP` found and brings the map up to date: NAME.csv with "
      "NAME.palette, NAME.svg, NAME.dxf, NAME.json (times seen and sessions of each row) and NAME.history. "
      "Rows that no accepted change names keep their coordinates. What is left open is offered again after "
      "the next drive, what is rejected is not. The last line is JSON (docs/map_sessions.md).");
  vismem::MapUpdateOptions options;
  app.add_option("MAP", options.map, "the earlier map, with NAME.palette and NAME.history beside it")
      ->required();
  app.add_option("CHANGES", options.changes, "NAME.changes of the drive, with NAME.history beside it")
      ->required();
  app.add_option("--accept", options.accept, "numbers of changes joined by ',', or all that are open");
  app.add_option("--reject", options.reject, "the same");
  app.add_option("--out", options.out, "folder for all that is written")->required();
  app.add_option("--name", options.name, "of the map's files")->capture_default_str();
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    std::cout << vismem::updateMapFiles(options).dump() << std::endl;
    return 0;
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "update_map: " << error.what() << "\n";
    return 1;
  }
}
