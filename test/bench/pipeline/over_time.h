/// @file A long run, minute by minute: its table, file and figure.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace vismem {

/// One simulated minute.
struct Minute {
  double minutes = 0.0;  ///< of robot time, at its end
  double mean_ms = 0.0;  ///< CPU of one iteration
  double p99_ms = 0.0;
  double elements = 0.0;  ///< mean
  double resident_mb = 0.0;
};

/// Twelve lines at most.
void printTable(const std::vector<Minute>& minutes);

/// @throws std::runtime_error naming a file that cannot be written.
void writeCsv(const std::vector<Minute>& minutes, const std::filesystem::path& file);
void writeFigure(const std::vector<Minute>& minutes, const std::string& title,
                 const std::filesystem::path& file);

/// The minutes, and how much the last quarter differs from the second one (the first fills the memory):
/// `growth_ms`, `growth_mb`; only from four minutes on.
nlohmann::json toJson(const std::vector<Minute>& minutes);

}  // namespace vismem
