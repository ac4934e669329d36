/// @file Reads parameters that declare their keys themselves. Pure. See C2.
#pragma once

#include <vector>

#include "common/config/config_reader.h"
#include "common/config/parameter_visitor.h"

namespace vismem {

/// Sets parameters from a configuration and describes their keys to its reader. A parameter without a key
/// keeps its value, which is the default. *Single-threaded value.*
class ParameterReader final : public ParameterVisitor {
 public:
  explicit ParameterReader(ConfigReader reader) : groups_{std::move(reader)} {}

  void real(const Key& key, double& value, double minimum, double maximum) override;
  void angle(const Key& key, double& value_rad, double minimum_deg, double maximum_deg) override;
  void integer(const Key& key, int& value, int minimum, int maximum) override;
  void flag(const Key& key, bool& value) override;
  void words(const Key& key, std::vector<std::string>& value) override;
  void require(std::string_view name, bool holds, std::string_view relation,
               std::string_view other_name) override;
  void alias(std::string_view old_name, std::string_view new_name) override;

 private:
  void oneOf(const Key& key, std::size_t& index, const std::vector<std::string>& names) override;
  void enter(std::string_view name) override { groups_.push_back(groups_.back().group(name)); }
  void leave() override { groups_.pop_back(); }

  std::vector<ConfigReader> groups_;  ///< the innermost last
};

}  // namespace vismem
