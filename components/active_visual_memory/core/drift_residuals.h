/// @file In what an observed segment differs from the remembered line it belongs to. Pure. SPEC M6.
#pragma once

#include <vector>

#include "active_visual_memory/core/drift_alignment.h"
#include "active_visual_memory/core/floor_line.h"
#include "active_visual_memory/core/ground_projector.h"

namespace vismem {

/// Adds what both ends tell across the line, and along it where a true end of the line was observed.
/// @param view that showed the piece. @param slack_m sigma for what the covariances do not model. @param
/// noise factor of all variances.
/// @param end_doubt factor of the sigmas of ends. @param max_end_shift_m ends further apart are not one end.
void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, const LeaningView& view,
                       double slack_m, double noise, double end_doubt, double max_end_shift_m,
                       std::vector<DriftResidual>& residuals);

}  // namespace vismem
