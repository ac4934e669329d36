/// @file Finds the components of a setup and their endpoints: from the ready lines of scripts/start, else
/// from their configuration.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "status/core/status_table.h"

namespace vismem {

/// The running setups of scripts/start: the folders of out/ with a list of processes.
std::vector<std::string> startedSetups(const std::filesystem::path& root);

/// The rows of a setup, without reports yet. A running setup of scripts/start is read from out/SETUP/ (list
/// of processes, ready lines with the actual endpoints), any other from its folder of configurations.
/// @param configurations  the folder of setups: cfg/, or /etc/vismem of an installation.
/// @param setup           name of a folder of out/ or of `configurations`.
/// @param port_offset     added to the ports of a setup read from `configurations`.
/// @throw ConfigError if neither folder exists.
std::vector<ComponentRow> rowsOfSetup(const std::filesystem::path& root,
                                      const std::filesystem::path& configurations, const std::string& setup,
                                      int port_offset);

/// The proxy of a component's status, at its first endpoint only: an absent one needs a single request.
std::string statusProxyOf(const ComponentRow& row);

}  // namespace vismem
