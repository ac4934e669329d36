/// @file Finds the components of a setup and where they serve: as they said when scripts/start started them,
/// else as their configuration says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "status/core/status_table.h"

namespace vismem {

/// The setups that scripts/start keeps running: the folders of out/ that have a list of processes.
std::vector<std::string> startedSetups(const std::filesystem::path& root);

/// The rows of a setup, without reports yet. A setup that scripts/start runs is read from out/SETUP/ (the
/// list of processes, and their ready lines with the real endpoints); any other from cfg/SETUP/.
/// @param setup        name of a folder of out/ or cfg/.
/// @param port_offset  added to the ports of a setup read from cfg/.
/// @throw ConfigError if there is neither.
std::vector<ComponentRow> rowsOfSetup(const std::filesystem::path& root, const std::string& setup,
                                      int port_offset);

/// The proxy of a component's status, at its first endpoint: one that is away is asked once.
std::string statusProxyOf(const ComponentRow& row);

}  // namespace vismem
