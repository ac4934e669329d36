/// @file Configuration of mapper: every key, checked once at start. Pure except for reading files.
#pragma once

#include <filesystem>
#include <string>

#include "common/config/config_reader.h"
#include "mapper/app/map_files.h"
#include "mapper/app/mapping_loop.h"

namespace vismem {

/// See C2. All keys begin with "Mapper."; the table is in the component's README.
struct MapperConfig {
  std::string visual_memory_proxy;
  std::string camera_proxy;
  MapFilesOptions files;
  MappingLoop::Params loop;  ///< by the configuration of the memory
  RecordedDrive blank;       ///< palette and parameters of each drive, without its record
};

/// Reads and checks every key of the component but the process's own, and the configurations of memory and
/// localization that they name. Problems are collected in `reader`; the caller finishes it.
/// @param reader at the prefix "Mapper".
/// @throws ConfigError with every problem of one of those configurations, or of the palette.
MapperConfig readMapperConfig(ConfigReader& reader);

}  // namespace vismem
