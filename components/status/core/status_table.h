/// @file What components told of themselves, as a table for people and as JSON for programs. Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/process/status.h"

namespace vismem {

/// One component, whether it answered or not.
struct ComponentRow {
  /// Folder of its setup: "sim".
  std::string setup;
  std::string name;
  /// Where it serves: "tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005"; empty if that is not known.
  std::string endpoints;
  std::optional<StatusReport> report;
  /// Why there is no report; empty if there is one.
  std::string failure;
  /// Nobody serves there (as opposed to one that serves and does not answer).
  bool absent = false;
};

/// "running", "waiting", "degraded", "starting", "stopping"; "absent" where nobody serves, "silent" where one
/// serves and does not answer (frozen, or busy beyond measure).
std::string stateName(const ComponentRow& row);

/// Whether there are components and every one of them is running.
bool isWhole(const std::vector<ComponentRow>& rows);

/// A heading, a line for each component, and below it what it knows: peers, rates, latencies, estimates, last errors.
/// @param colour  with the escape sequences of terminals.
std::string statusTable(const std::vector<ComponentRow>& rows, bool colour);

/// {"whole":true,"components":[{"setup":"sim","name":"simulator","endpoints":"tcp
/// ...","state":"running",...}]}.
nlohmann::json statusJson(const std::vector<ComponentRow>& rows);

}  // namespace vismem
