/// @file The files of a map that is brought up to date by a list of answered changes. See B6.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace vismem {

struct MapUpdateOptions {
  std::filesystem::path map;
  std::filesystem::path changes;
  std::string accept;  ///< decide()
  std::string reject;
  std::filesystem::path out;
  std::string name = "map";
};

/// Writes NAME.csv, .palette, .svg, .dxf, .json and .history.
/// @return the summary.
/// @throws ConfigError, std::runtime_error naming the wrong input.
nlohmann::json updateMapFiles(const MapUpdateOptions& options);

}  // namespace vismem
