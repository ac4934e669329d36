#include "experiments/app/experiments.h"

#include <nlohmann/json.hpp>

#include "experiments/app/e9_detectors.h"

namespace vismem {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{
      {"E9", "Canny+Hough beside Solis on the same images, and merging (figures 3 and 10)", compareDetectors},
  };
  return all;
}

}  // namespace vismem
