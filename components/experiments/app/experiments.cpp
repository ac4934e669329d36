#include "experiments/app/experiments.h"

#include <nlohmann/json.hpp>

#include "experiments/app/e1_look_around.h"
#include "experiments/app/e2_curve.h"
#include "experiments/app/e3_occlusion.h"
#include "experiments/app/e4_humanoid.h"
#include "experiments/app/e6_gaze.h"
#include "experiments/app/e7_health_maps.h"
#include "experiments/app/e9_detectors.h"
#include "experiments/app/mapping.h"
#include "experiments/app/primitives.h"
#include "experiments/app/trial_variants.h"

namespace vismem {
namespace {

nlohmann::json travel(const ExperimentOptions& options) {
  return runTrialVariants("E5", "travel_", options);
}

nlohmann::json kidnapping(const ExperimentOptions& options) {
  return options.gaze.empty() ? runTrialVariants("E6", "", options) : compareGaze(options);
}

}  // namespace

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{
      {"E1", "The robot turns in a room: one image against the memory (figure 13)", lookAround},
      {"E2", "A curve ahead: the memory holds what the image does not show (figures 14, 15)", followCurve},
      {"E3", "A second robot occludes the view: the memory bridges it (figures 16 to 18)", occlusion},
      {"E4", "A humanoid that walks and turns its neck, simulated and recorded (figure 19)", humanoid},
      {"E5", "A humanoid travels a corridor: error over time (figure 20)", travel},
      {"E6", "Symmetries and kidnappings, every method on the same observations (figure 21)", kidnapping},
      {"E7", "How well every place fits an image (figures 22 to 26)", healthFromImages},
      {"E8", "How well every place fits the memory (figure 27)", healthFromMemory},
      {"E9", "Canny+Hough beside Solis on the same images, and merging (figures 3 and 10)", compareDetectors},
      {"map", "A map from one drive against the true edges", mapping},
      {"primitives", "Shapes found on the floor, and completed behind an object on a corner (figure 7)",
       primitives},
  };
  return all;
}

}  // namespace vismem
