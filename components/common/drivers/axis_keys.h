/// @file Meanings of the keys that drivers of pan-tilt units share.
#pragma once

#include "common/config/config_reader.h"

namespace vismem {

/// @param axis the group Pan or Tilt.
inline void describeAxis(ConfigReader axis) {
  axis.describe({basic("Minimum_deg", "limit; those of the unit count, too"),
                 basic("Maximum_deg", "as Minimum_deg"), basic("Rate_degps", "highest speed"),
                 basic("Inverted", "the device turns the other way")});
}

}  // namespace vismem
