#include "experiments/app/e5_travel.h"

#include <nlohmann/json.hpp>

#include "experiments/app/trial_variants.h"

namespace vismem {

nlohmann::json travel(const ExperimentOptions& options) {
  return runTrialVariants("E5", "travel_", options);
}

}  // namespace vismem
