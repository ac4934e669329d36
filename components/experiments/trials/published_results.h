/// @file The chapter's published localization results, with which E5 and E6 compare ours. Pure. Implements
/// L11.
#pragma once

#include <optional>

#include "common/geometry/angles.h"
#include "experiments/trials/trial_score.h"

namespace vismem {

/// Mean errors and mean recovery time of the chapter.
struct PublishedResult {
  double position_error_m = 0.0;
  double heading_error_rad = 0.0;
  std::optional<double> recovery_s;  ///< empty: a run without kidnapping
};

/// Figure 20: a humanoid in a corridor.
inline constexpr PublishedResult kPublishedTravel{0.118, degToRad(2.1), std::nullopt};
/// Figure 21: symmetries and two kidnappings.
inline constexpr PublishedResult kPublishedKidnapping{0.149, degToRad(3.2), 29.6};

/// @return whether a summary has smaller mean errors and, where published, a shorter median recovery time.
bool isBetterThan(const PublishedResult& published, const TrialSummary& summary);

}  // namespace vismem
