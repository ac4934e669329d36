#include "experiments/trials/published_results.h"

namespace vismem {

bool isBetterThan(const PublishedResult& published, const TrialSummary& summary) {
  if (!summary.position_error_m || !summary.heading_error_rad) return false;
  if (published.recovery_s && !(summary.median_s && summary.median_s->value < *published.recovery_s)) {
    return false;
  }
  return summary.position_error_m->value < published.position_error_m &&
         summary.heading_error_rad->value < published.heading_error_rad;
}

}  // namespace vismem
