/// @file The folder of `calibrate body`: what was recorded, so that it can be estimated again, and the
/// report.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "calibration/core/body/body_estimator.h"

namespace vismem {

/// JSON of a record; numbers keep all their digits.
nlohmann::json toJson(const BodyRecord& record);
/// @param file for messages. @throw ConfigError "FILE: KEY: what was found (RULE)".
BodyRecord bodyRecordFrom(const nlohmann::json& json, const std::string& file);

/// Reads FOLDER/body.json. @throw ConfigError for an unreadable or damaged file.
BodyRecord readBodyRecord(const std::filesystem::path& file);

/// The estimate for programs: values with units, null where not observable.
nlohmann::json reportOf(const BodyEstimate& estimate);
/// The estimate for people: a line a parameter.
std::string tableOf(const BodyEstimate& estimate);

}  // namespace vismem
