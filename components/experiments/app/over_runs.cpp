#include "experiments/app/over_runs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

namespace vismem {
namespace {

nlohmann::json sumUp(const std::vector<const nlohmann::json*>& values) {
  if (values.front()->is_object()) {
    nlohmann::json all = nlohmann::json::object();
    nlohmann::json any = nlohmann::json::object();
    for (const nlohmann::json* value : values) any.update(*value);
    for (const auto& [key, unused] : any.items()) {
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
  std::vector<double> numbers;
  for (const nlohmann::json* value : values) {
    if (value->is_boolean()) numbers.push_back(value->get<bool>() ? 1.0 : 0.0);
    if (value->is_number()) numbers.push_back(value->get<double>());
  }
  if (numbers.empty()) return {};
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  const double total = std::accumulate(numbers.begin(), numbers.end(), 0.0);
  return {{"mean", total / static_cast<double>(numbers.size())},
          {"min", *least},
          {"max", *most},
          {"runs", numbers.size()}};
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
