/// @file Perturbations of a camera: what a badly measured mounting, bad light, a bad lens, a slow clock or a
/// lossy link does to its frames. Pure. A mechanism is judged on data that did not tune it.
#pragma once

#include <string>

#include "common/robot/samples.h"

namespace vismem {

struct Perturbation {
  double height_m = 0.0;    ///< added to the stated height of the camera above the floor
  double tilt_rad = 0.0;    ///< added to the stated tilt of the camera; > 0 looks up
  double focal = 1.0;       ///< factor of the stated focal lengths
  double brightness = 1.0;  ///< factor of all pixels, saturating
  int jpeg_quality = 0;     ///< 1..100: encoded as JPEG and decoded; 0: as it is
  int blur_px = 0;          ///< length of a horizontal motion blur; 0: none
  double late_s = 0.0;      ///< added to the stamps of images
  int every = 1;            ///< one image of so many arrives

  bool changesPose() const { return height_m != 0.0 || tilt_rad != 0.0; }
};

struct ParsedPerturbation {
  Perturbation perturbation;
  std::string error;  ///< what was found and what was expected; empty if nothing is wrong
};

/// Reads "height=0.02,tilt=1,focal=1.02,brightness=0.5,jpeg=50,blur=3,late=0.05,every=2": m, degrees,
/// factors, a quality, px, s and images; each at most once.
ParsedPerturbation parsePerturbation(const std::string& text);

/// Whether the frame arrives: the first of each `every` does, by its number.
bool arrives(const Perturbation& perturbation, const Frame& frame);

/// The frame as a perturbed camera reports it. Pixels are copied before they change.
/// @throws std::invalid_argument when the pose of the camera shall change and the frame lacks it.
Frame perturbed(const Perturbation& perturbation, Frame frame);

}  // namespace vismem
