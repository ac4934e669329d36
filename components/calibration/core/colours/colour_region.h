/// @file Regions of hue, saturation and value around clusters of colours. Pure. See V3.
#pragma once

#include <string>
#include <vector>

#include "common/vision/palette.h"

namespace vismem {

/// What a cluster's colours fill. Hues are not wrapped here: `low` may be below 0, `high` above 360 degrees.
struct ColourRegion {
  ColorClassDefinition tight;       ///< without the rarest hundredth at each end
  bool is_grey = false;             ///< hue says nothing
  double hue_deg = 0.0;             ///< mean direction, weighted by saturation
  double saturation_percent = 0.0;  ///< median
  double value_percent = 0.0;       ///< median

  /// Of a box, for the order of classes: the smaller one comes first.
  double volume() const;
  /// "pale_orange", "dark_grey".
  std::string colourName() const;
};

/// @param colours at least one.
ColourRegion regionOf(const std::vector<ColorValues>& colours);

/// Regions widened by what light does to colours. Where two would overlap, both end in the middle of the gap
/// between their tight ranges, in the quantity with the clearest gap. Without a gap they overlap.
/// @return one for each, with hues in 0..360 degrees and whole numbers, as files have them.
std::vector<ColorClassDefinition> separateRegions(const std::vector<ColourRegion>& regions);

}  // namespace vismem
