#include "common/config/parameter_reader.h"

#include <sstream>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"

namespace vismem {

void ParameterReader::real(const Key& key, double& value, double minimum, double maximum) {
  value = groups_.back().describe(key).real(key.name, value, minimum, maximum);
}

void ParameterReader::angle(const Key& key, double& value_rad, double minimum_deg, double maximum_deg) {
  value_rad = groups_.back().describe(key).angleDeg(key.name, radToDeg(value_rad), minimum_deg, maximum_deg);
}

void ParameterReader::integer(const Key& key, int& value, int minimum, int maximum) {
  value = static_cast<int>(groups_.back().describe(key).integer(key.name, value, minimum, maximum));
}

void ParameterReader::flag(const Key& key, bool& value) {
  value = groups_.back().describe(key).boolean(key.name, value);
}

void ParameterReader::words(const Key& key, std::vector<std::string>& value) {
  std::istringstream text(groups_.back().describe(key).text(key.name, joined(value, " ")));
  value.clear();
  for (std::string word; text >> word;) value.push_back(word);
}

void ParameterReader::oneOf(const Key& key, std::size_t& index, const std::vector<std::string>& names) {
  std::vector<std::pair<std::string, std::size_t>> choices;
  for (const std::string& name : names) choices.emplace_back(name, choices.size());
  index = groups_.back().describe(key).choice(key.name, index, choices);
}

void ParameterReader::require(std::string_view name, bool holds, std::string_view relation,
                              std::string_view other_name) {
  ConfigReader& group = groups_.back();
  if (!holds) group.problem(name, std::string(relation) + " " + group.key(other_name));
}

void ParameterReader::alias(std::string_view old_name, std::string_view new_name) {
  groups_.back().alias(old_name, new_name);
}

}  // namespace vismem
