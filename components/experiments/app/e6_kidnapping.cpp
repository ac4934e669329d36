#include "experiments/app/e6_kidnapping.h"

#include <nlohmann/json.hpp>

#include "experiments/app/e6_gaze.h"
#include "experiments/app/trial_variants.h"

namespace vismem {

nlohmann::json kidnapping(const ExperimentOptions& options) {
  return options.gaze.empty() ? runTrialVariants("E6", "", options) : compareGaze(options);
}

}  // namespace vismem
