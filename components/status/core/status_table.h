/// @file Status of components, as a table for people and as JSON for programs. Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/process/status.h"

namespace vismem {

/// One component, with or without an answer.
struct ComponentRow {
  /// Folder of its setup: "sim".
  std::string setup;
  std::string name;
  /// Its endpoints: "tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005"; empty if unknown.
  std::string endpoints;
  std::optional<StatusReport> report;
  /// Reason why there is no report; empty with a report.
  std::string failure;
  /// True if no server listens there, as opposed to a server without an answer.
  bool absent = false;
  /// True if the setup is whole without it: absent it is no row.
  bool may_be_left_out = false;
  /// Robot.Name of its configuration; empty without.
  std::string robot = {};
};

/// "running", "waiting", "degraded", "starting", "stopping"; "absent" without a server, "silent" for a server
/// without an answer (frozen or overloaded).
std::string stateName(const ComponentRow& row);

/// Whether there are components and every one of them is running.
bool isWhole(const std::vector<ComponentRow>& rows);

/// A heading, then a line for each component with its peers, rates, latencies, estimates and last errors
/// below.
/// @param colour use the escape sequences of terminals.
std::string statusTable(const std::vector<ComponentRow>& rows, bool colour);

/// {"whole":true,"components":[{"setup":"sim","name":"simulator","endpoints":"tcp
/// ...","state":"running",...}]}.
nlohmann::json statusJson(const std::vector<ComponentRow>& rows);

}  // namespace vismem
