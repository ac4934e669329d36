#include "experiments/app/over_runs.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace vismem {
namespace {

nlohmann::json sumUp(const std::vector<const nlohmann::json*>& values) {
  if (values.front()->is_object()) {
    nlohmann::json all = nlohmann::json::object();
    std::vector<std::string> keys;
    for (const nlohmann::json* value : values) {
      for (const auto& [key, unused] : value->items()) {
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
      }
    }
    for (const std::string& key : keys) {
      std::vector<const nlohmann::json*> inner;
      for (const nlohmann::json* value : values) {
        if (value->contains(key) && !value->at(key).is_null()) inner.push_back(&value->at(key));
      }
      if (inner.empty()) continue;
      nlohmann::json sum = sumUp(inner);
      if (!sum.is_null()) all[key] = std::move(sum);
    }
    return all.empty() ? nlohmann::json() : all;
  }
  double total = 0.0;
  double least = 0.0;
  double most = 0.0;
  int count = 0;
  for (const nlohmann::json* value : values) {
    if (!value->is_number() && !value->is_boolean()) continue;
    const double number = value->is_boolean() ? (value->get<bool>() ? 1.0 : 0.0) : value->get<double>();
    least = count == 0 ? number : std::min(least, number);
    most = count == 0 ? number : std::max(most, number);
    total += number;
    ++count;
  }
  if (count == 0) return {};
  return {{"mean", total / count}, {"min", least}, {"max", most}, {"runs", count}};
}

}  // namespace

nlohmann::json overRuns(const std::vector<nlohmann::json>& runs) {
  if (runs.empty()) return nlohmann::json::object();
  std::vector<nlohmann::json> kept = runs;
  std::vector<const nlohmann::json*> all;
  for (nlohmann::json& run : kept) {
    run.erase("seed");
    all.push_back(&run);
  }
  return sumUp(all);
}

}  // namespace vismem
