/// @file Perturbations of a robot: what a badly measured mounting, bad light, a bad lens, a slow clock or a
/// lossy link does to its frames, and what wrong wheels do to its odometry. Pure. A mechanism is judged on
/// data that did not tune it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "common/robot/samples.h"

namespace vismem {

struct Perturbation {
  double height_m = 0.0;     ///< added to the stated height of the camera above the floor
  double tilt_rad = 0.0;     ///< added to the stated tilt of the camera; > 0 looks up
  double focal = 1.0;        ///< factor of the stated focal lengths
  double brightness = 1.0;   ///< factor of all pixels, saturating
  double white_K = 6500.0;   ///< colour temperature of the light; the camera is balanced for 6500 K
  double gamma = 1.0;        ///< exponent of all pixels, full brightness stays
  double vignette = 0.0;     ///< share of the brightness that the corners lose
  double noise = 0.0;        ///< standard deviation of each value [grey levels]
  double scale = 1.0;        ///< factor of the image's width and height
  int jpeg_quality = 0;      ///< 1..100: encoded as JPEG and decoded; 0: as it is
  int blur_px = 0;           ///< length of a horizontal motion blur; 0: none
  double late_s = 0.0;       ///< added to the stamps of images
  int every = 1;             ///< one image of so many arrives
  double way = 1.0;          ///< factor of the way that the odometry states
  double drift_radps = 0.0;  ///< turn that the odometry adds in each second

  bool changesLight() const {
    return brightness != 1.0 || white_K != 6500.0 || gamma != 1.0 || vignette != 0.0;
  }
  bool changesPose() const { return height_m != 0.0 || tilt_rad != 0.0; }
};

struct ParsedPerturbation {
  Perturbation perturbation;
  std::string error;  ///< what was found and what was expected; empty if nothing is wrong
};

/// Reads
/// "height=0.02,tilt=1,focal=1.02,brightness=0.5,white=3000,gamma=1.4,vignette=0.5,noise=10,scale=2,jpeg=50,
/// blur=3,late=0.05,every=2,way=1.1,drift=10": m, degrees, factors, K, an exponent, a share, grey levels, a
/// factor, a quality, px, s, images, a factor and degrees per minute; each at most once.
ParsedPerturbation parsePerturbation(const std::string& text);

/// Whether the frame arrives: the first of each `every` does, by its number.
bool arrives(const Perturbation& perturbation, const Frame& frame);

/// Factors of red, green and blue pixels (of encoded values, exponent 2.2) under a black body's light, for a
/// camera that is balanced for 6500 K; that of green is 1. Planck's law at 611, 549 and 464 nm.
Eigen::Vector3d whiteBalanceFactors(double temperature_K);

/// The image as a perturbed camera gives it. Noise depends on `seq` alone.
/// @param image is not changed.
cv::Mat perturbedImage(const Perturbation& perturbation, const cv::Mat& image, std::uint64_t seq);

/// The frame as a perturbed camera reports it. Pixels are copied before they change.
/// @throws std::invalid_argument when the pose of the camera shall change and the frame lacks it.
Frame perturbed(const Perturbation& perturbation, Frame frame);

/// Odometry as perturbed wheels state it, sample by sample. *Single-threaded value.*
class PerturbedOdometry {
 public:
  explicit PerturbedOdometry(const Perturbation& perturbation) : perturbation_(perturbation) {}
  /// @param sample later than the one before.
  OdometrySample next(const OdometrySample& sample);

 private:
  Perturbation perturbation_;
  std::optional<OdometrySample> last_;
  Pose2 T_odom_robot_;
};

}  // namespace vismem
