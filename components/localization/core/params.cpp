#include "localization/core/params.h"

namespace vismem {

LocalizerParams localizerPreset(LocalizationMode mode) {
  LocalizerParams params;
  params.mode = mode;
  if (mode == LocalizationMode::kDefault) {
    // Health is the explained fraction here: with half of the segments false the true place has about 0.5.
    params.races.create_health = 0.3;
    params.races.delete_health = 0.3;
    params.explorers.list_health = 0.15;
    params.explorers.count_lost = 500;
    params.explorers.count_reliable = 60;
  }
  return params;
}

}  // namespace vismem
