#include "common/process/parameter_table.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/config/text_file.h"

namespace vismem {
namespace {

std::string rangeOf(const RuntimeParameter& parameter) {
  std::ostringstream text;
  text << parameter.minimum << ".." << parameter.maximum;
  if (parameter.whole) text << ", whole";
  if (!parameter.unit.empty()) text << " [" << parameter.unit << "]";
  return text.str();
}

bool fits(const RuntimeParameter& parameter, double value) {
  // A NaN fails both comparisons.
  return value >= parameter.minimum && value <= parameter.maximum &&
         (!parameter.whole || value == std::floor(value));
}

}  // namespace

void ParameterTable::add(RuntimeParameter parameter, Apply apply) {
  const std::scoped_lock lock(changes_, values_);
  if (!fits(parameter, parameter.configured))
    throw std::logic_error("parameter " + parameter.name + " is configured outside " + rangeOf(parameter));
  for (const Row& row : rows_) {
    if (row.entry.parameter.name == parameter.name)
      throw std::logic_error("parameter " + parameter.name + " is listed twice");
  }
  const double value = parameter.configured;
  rows_.push_back({{std::move(parameter), value}, std::move(apply)});
}

std::vector<ParameterTable::Entry> ParameterTable::list() const {
  const std::scoped_lock lock(values_);
  std::vector<Entry> entries;
  entries.reserve(rows_.size());
  for (const Row& row : rows_) entries.push_back(row.entry);
  return entries;
}

ParameterTable::Outcome ParameterTable::set(const std::string& name, double value) {
  const std::scoped_lock one_at_a_time(changes_);
  const auto row = std::find_if(rows_.begin(), rows_.end(),
                                [&](const Row& candidate) { return candidate.entry.parameter.name == name; });
  if (row == rows_.end())
    return {Outcome::Kind::kInvalid, "no parameter is called \"" + shown(name, 100) + "\""};
  if (!fits(row->entry.parameter, value)) {
    std::ostringstream reason;
    reason << name << " = " << value << " (must be " << rangeOf(row->entry.parameter) << ")";
    return {Outcome::Kind::kInvalid, reason.str()};
  }
  const std::string refusal = row->apply(value);
  if (!refusal.empty()) return {Outcome::Kind::kRefused, refusal};
  const std::scoped_lock lock(values_);
  row->entry.value = value;
  return {};
}

}  // namespace vismem
