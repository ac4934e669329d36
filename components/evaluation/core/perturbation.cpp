#include "evaluation/core/perturbation.h"

#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/config/nearest_name.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/image_codec/image_codec.h"

namespace vismem {
namespace {

struct Key {
  double least;
  double most;
  bool whole;
  void (*set)(Perturbation&, double);
};

const std::map<std::string, Key>& keys() {
  static const std::map<std::string, Key> all{
      {"height", {-1.0, 1.0, false, [](Perturbation& p, double v) { p.height_m = v; }}},
      {"tilt", {-45.0, 45.0, false, [](Perturbation& p, double v) { p.tilt_rad = degToRad(v); }}},
      {"focal", {0.5, 2.0, false, [](Perturbation& p, double v) { p.focal = v; }}},
      {"brightness", {0.0, 10.0, false, [](Perturbation& p, double v) { p.brightness = v; }}},
      {"white", {1000.0, 40000.0, false, [](Perturbation& p, double v) { p.white_K = v; }}},
      {"gamma", {0.1, 10.0, false, [](Perturbation& p, double v) { p.gamma = v; }}},
      {"vignette", {0.0, 1.0, false, [](Perturbation& p, double v) { p.vignette = v; }}},
      {"noise", {0.0, 100.0, false, [](Perturbation& p, double v) { p.noise = v; }}},
      {"scale", {0.1, 10.0, false, [](Perturbation& p, double v) { p.scale = v; }}},
      {"jpeg", {1.0, 100.0, true, [](Perturbation& p, double v) { p.jpeg_quality = static_cast<int>(v); }}},
      {"blur", {2.0, 100.0, true, [](Perturbation& p, double v) { p.blur_px = static_cast<int>(v); }}},
      {"late", {-1.0, 1.0, false, [](Perturbation& p, double v) { p.late_s = v; }}},
      {"every", {1.0, 1000.0, true, [](Perturbation& p, double v) { p.every = static_cast<int>(v); }}},
      {"way", {0.1, 10.0, false, [](Perturbation& p, double v) { p.way = v; }}},
      {"drift",
       {-3600.0, 3600.0, false, [](Perturbation& p, double v) { p.drift_radps = degToRad(v) / 60.0; }}},
  };
  return all;
}

/// @return what is wrong with `name=number`; empty if it was set.
std::string setOne(const std::string& item, std::set<std::string>& given, Perturbation& perturbation) {
  const auto equals = item.find('=');
  const std::string name = item.substr(0, equals);
  const auto key = keys().find(name);
  if (key == keys().end()) {
    std::set<std::string> names;
    for (const auto& [known, unused] : keys()) names.insert(known);
    return "\"" + name + "\"" + suggestion(name, names) + " (expected one of " + joined(names, ", ") + ")";
  }
  if (!given.insert(name).second) return name + " twice";
  const std::string number = equals == std::string::npos ? "" : item.substr(equals + 1);
  std::istringstream text(number);
  double value = 0.0;
  char rest = 0;
  const bool is_number = text >> value && !(text >> rest);
  const auto& [least, most, whole, set] = key->second;
  if (!is_number || !(value >= least && value <= most) || (whole && value != std::floor(value))) {
    std::ostringstream wrong;
    wrong << name << "=" << number << " (expected a " << (whole ? "whole " : "") << "number from " << least
          << " to " << most << ")";
    return wrong.str();
  }
  set(perturbation, value);
  return "";
}

/// States the intrinsics of an image that was resized.
void scaleTo(const cv::Mat& image, CameraIntrinsics& k) {
  const double x = static_cast<double>(image.cols) / k.width;
  const double y = static_cast<double>(image.rows) / k.height;
  k.width = image.cols;
  k.height = image.rows;
  k.fx *= x;
  k.fy *= y;
  k.cx = (k.cx + 0.5) * x - 0.5;
  k.cy = (k.cy + 0.5) * y - 0.5;
}

/// Light and encoding: what happens to each value alone, but for the place in the image.
cv::Mat relit(const Perturbation& p, const cv::Mat& image) {
  const Eigen::Vector3d white = whiteBalanceFactors(p.white_K);
  const Eigen::Vector2d centre(0.5 * (image.cols - 1), 0.5 * (image.rows - 1));
  const double corner2 = centre.squaredNorm();
  cv::Mat lit(image.size(), image.type());
  const int channels = image.channels();
  for (int row = 0; row < image.rows; ++row) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(row);
    std::uint8_t* to = lit.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column) {
      const double off2 = (Eigen::Vector2d(column, row) - centre).squaredNorm();
      const double here = p.brightness * (1.0 - p.vignette * off2 / corner2);
      for (int c = 0; c < channels; ++c, ++from, ++to) {
        const double value = here * (channels == 3 ? white[c] : 1.0) * *from;
        *to = cv::saturate_cast<std::uint8_t>(255.0 * std::pow(value / 255.0, p.gamma));
      }
    }
  }
  return lit;
}

cv::Mat withNoise(const cv::Mat& image, double sigma, std::uint64_t seed) {
  cv::RNG random(seed + 1);  // 0 is no seed
  cv::Mat noise(image.size(), CV_16SC(image.channels()));
  random.fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  cv::Mat noisy;
  cv::add(image, noise, noisy, cv::noArray(), image.type());
  return noisy;
}

}  // namespace

ParsedPerturbation parsePerturbation(const std::string& text) {
  ParsedPerturbation parsed;
  std::set<std::string> given;
  std::istringstream items(text);
  for (std::string item; parsed.error.empty() && std::getline(items, item, ',');) {
    parsed.error = setOne(item, given, parsed.perturbation);
  }
  return parsed;
}

bool arrives(const Perturbation& perturbation, const Frame& frame) {
  return frame.seq % static_cast<std::uint64_t>(perturbation.every) == 0;
}

Eigen::Vector3d whiteBalanceFactors(double temperature_K) {
  constexpr double kSecondRadiation_mK = 1.438777e-2;
  constexpr double kBalance_K = 6500.0;
  constexpr double kEncoding = 1.0 / 2.2;
  const Eigen::Array3d wavelength_m(611e-9, 549e-9, 464e-9);
  const auto radiance = [&](double K) {
    return Eigen::Array3d(1.0 / ((kSecondRadiation_mK / K / wavelength_m).exp() - 1.0));
  };
  const Eigen::Array3d ratio = radiance(temperature_K) / radiance(kBalance_K);
  return (ratio / ratio[1]).pow(kEncoding).matrix();
}

// Optics, light, sensor and encoding, in this order.
cv::Mat perturbedImage(const Perturbation& p, const cv::Mat& image, std::uint64_t seq) {
  cv::Mat pixels = image;
  if (p.scale != 1.0) {
    cv::Mat scaled;
    cv::resize(pixels, scaled, {}, p.scale, p.scale, p.scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
    pixels = scaled;
  }
  if (p.blur_px > 0) {
    cv::Mat blurred;
    cv::blur(pixels, blurred, cv::Size(p.blur_px, 1));
    pixels = blurred;
  }
  if (p.changesLight()) pixels = relit(p, pixels);
  if (p.noise > 0.0) pixels = withNoise(pixels, p.noise, seq);
  if (p.jpeg_quality > 0) {
    const DecodedImage decoded = decodeImageFile(encodeJpeg(pixels, p.jpeg_quality));
    if (!decoded.error.empty()) throw std::runtime_error("a perturbed image " + decoded.error);
    pixels = decoded.image;
  }
  return pixels;
}

Frame perturbed(const Perturbation& p, Frame frame) {
  if (p.changesPose()) {
    if (!frame.T_robot_camera) {
      throw std::invalid_argument(
          "a height or tilt of the camera needs frames with its pose on the robot (transforms in the "
          "recording)");
    }
    // The optical frame has x to the right: a positive turn about it looks up.
    *frame.T_robot_camera =
        *frame.T_robot_camera * Pose3(Eigen::AngleAxisd(p.tilt_rad, Eigen::Vector3d::UnitX()));
    frame.T_robot_camera->translation().z() += p.height_m;
  }
  frame.intrinsics.fx *= p.focal;
  frame.intrinsics.fy *= p.focal;
  frame.stamp_us += toStampUs(p.late_s);
  frame.image = perturbedImage(p, frame.image, frame.seq);
  if (p.scale != 1.0) scaleTo(frame.image, frame.intrinsics);
  frame.native.reset();
  return frame;
}

OdometrySample PerturbedOdometry::next(const OdometrySample& sample) {
  OdometrySample result = sample;
  if (last_) {
    Pose2 moved = inverse(last_->T_odom_robot) * sample.T_odom_robot;
    moved.x *= perturbation_.way;
    moved.y *= perturbation_.way;
    moved.theta += perturbation_.drift_radps * toSeconds(sample.stamp_us - last_->stamp_us);
    T_odom_robot_ = T_odom_robot_ * moved;
  } else {
    T_odom_robot_ = sample.T_odom_robot;
  }
  last_ = sample;
  result.T_odom_robot = T_odom_robot_;
  result.v_mps *= perturbation_.way;
  result.w_radps += perturbation_.drift_radps;
  return result;
}

}  // namespace vismem
