#include "calibration/core/colours/colour_region.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace vismem {
namespace {

constexpr double kTail = 0.01;
constexpr double kGrey_percent = 12.0;   // of less saturation, hue is noise
constexpr double kDark_percent = 8.0;    // of less value, too
constexpr double kPale_percent = 45.0;   // for names alone
constexpr double kHueMargin_deg = 10.0;  // light of another colour, and noise
constexpr double kSaturationMargin_percent = 15.0;
constexpr double kValueFactor = 1.35;  // light and shade beyond what the images show
// Differences that are equally clear.
constexpr double kHueUnit_deg = 25.0;
constexpr double kUnit_percent = 20.0;

double at(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
}

double wrapped(double hue_deg) {
  const double rest = std::fmod(hue_deg, 360.0);
  return rest < 0.0 ? rest + 360.0 : rest;
}

ColorClassDefinition widened(const ColourRegion& region) {
  ColorClassDefinition wide = region.tight;
  if (!region.is_grey) {
    wide.hue_deg.low -= kHueMargin_deg;
    wide.hue_deg.high += kHueMargin_deg;
  }
  wide.saturation_percent.low = std::max(0.0, wide.saturation_percent.low - kSaturationMargin_percent);
  wide.saturation_percent.high = std::min(100.0, wide.saturation_percent.high + kSaturationMargin_percent);
  wide.value_percent.low /= kValueFactor;
  wide.value_percent.high = std::min(100.0, wide.value_percent.high * kValueFactor);
  return wide;
}

/// Between two ranges; b is moved by `shift` to be comparable with a.
struct Gap {
  double size = 0.0;  ///< in units that are equally clear; 0: the ranges overlap
  double middle = 0.0;
  double shift = 0.0;
  bool first_is_low = true;
};

Gap gapBetween(const ColorRange& a, const ColorRange& b, double unit, double shift = 0.0) {
  const double low = b.low + shift;
  const double high = b.high + shift;
  if (low > a.high) return {(low - a.high) / unit, 0.5 * (low + a.high), shift, true};
  if (a.low > high) return {(a.low - high) / unit, 0.5 * (a.low + high), shift, false};
  return {};
}

void endAt(const Gap& gap, ColorRange& a, ColorRange& b) {
  if (gap.first_is_low) {
    a.high = std::min(a.high, gap.middle);
    b.low = std::max(b.low, gap.middle - gap.shift);
  } else {
    a.low = std::max(a.low, gap.middle);
    b.high = std::min(b.high, gap.middle - gap.shift);
  }
}

void separate(const ColourRegion& a, const ColourRegion& b, ColorClassDefinition& wide_a,
              ColorClassDefinition& wide_b) {
  const double turn = 360.0 * std::round((a.hue_deg - b.hue_deg) / 360.0);
  const bool have_hues = !a.is_grey && !b.is_grey;
  const Gap hue = have_hues ? gapBetween(a.tight.hue_deg, b.tight.hue_deg, kHueUnit_deg, turn) : Gap{};
  const Gap saturation = gapBetween(a.tight.saturation_percent, b.tight.saturation_percent, kUnit_percent);
  const Gap value = gapBetween(a.tight.value_percent, b.tight.value_percent, kUnit_percent);
  const double clearest = std::max({hue.size, saturation.size, value.size});
  if (clearest == 0.0) return;
  if (clearest == hue.size) {
    endAt(hue, wide_a.hue_deg, wide_b.hue_deg);
  } else if (clearest == saturation.size) {
    endAt(saturation, wide_a.saturation_percent, wide_b.saturation_percent);
  } else {
    endAt(value, wide_a.value_percent, wide_b.value_percent);
  }
}

ColorClassDefinition asInFiles(ColorClassDefinition region) {
  const auto whole = [](ColorRange& range) { range = {std::floor(range.low), std::ceil(range.high)}; };
  whole(region.hue_deg);
  whole(region.saturation_percent);
  whole(region.value_percent);
  if (region.hue_deg.high - region.hue_deg.low >= 359.0) {
    region.hue_deg = {0.0, 360.0};
  } else {
    region.hue_deg = {wrapped(region.hue_deg.low), wrapped(region.hue_deg.high)};
  }
  return region;
}

}  // namespace

double ColourRegion::volume() const {
  const auto width = [](const ColorRange& range) { return range.high - range.low + 2.0; };
  return (is_grey ? 360.0 : width(tight.hue_deg)) * width(tight.saturation_percent) *
         width(tight.value_percent);
}

std::string ColourRegion::colourName() const {
  if (is_grey)
    return value_percent < 15.0   ? "black"
           : value_percent < 40.0 ? "dark_grey"
           : value_percent < 75.0 ? "grey"
                                  : "white";
  static const std::array<std::pair<double, const char*>, 9> kNames{{{15.0, "red"},
                                                                     {45.0, "orange"},
                                                                     {70.0, "yellow"},
                                                                     {165.0, "green"},
                                                                     {195.0, "cyan"},
                                                                     {260.0, "blue"},
                                                                     {290.0, "violet"},
                                                                     {340.0, "pink"},
                                                                     {360.0, "red"}}};
  const double hue = wrapped(hue_deg);
  const auto* name =
      std::find_if(kNames.begin(), kNames.end() - 1, [&](const auto& one) { return hue < one.first; });
  const std::string shade = value_percent < 30.0                 ? "dark_"
                            : saturation_percent < kPale_percent ? "pale_"
                                                                 : "";
  return shade + name->second;
}

ColourRegion regionOf(const std::vector<ColorValues>& colours) {
  std::vector<double> saturation;
  std::vector<double> value;
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  constexpr double kRadians = std::numbers::pi / 180.0;
  for (const ColorValues& one : colours) {
    saturation.push_back(one.saturation_percent);
    value.push_back(one.value_percent);
    direction += one.saturation_percent *
                 Eigen::Vector2d(std::cos(one.hue_deg * kRadians), std::sin(one.hue_deg * kRadians));
  }
  std::sort(saturation.begin(), saturation.end());
  std::sort(value.begin(), value.end());
  ColourRegion region;
  region.tight.saturation_percent = {at(saturation, kTail), at(saturation, 1.0 - kTail)};
  region.tight.value_percent = {at(value, kTail), at(value, 1.0 - kTail)};
  region.saturation_percent = at(saturation, 0.5);
  region.value_percent = at(value, 0.5);
  region.is_grey = region.saturation_percent < kGrey_percent || at(saturation, 0.1) < 0.5 * kGrey_percent ||
                   region.value_percent < kDark_percent;
  region.hue_deg = std::atan2(direction.y(), direction.x()) / kRadians;
  if (region.is_grey) return region;
  std::vector<double> hue;
  for (const ColorValues& one : colours) hue.push_back(std::remainder(one.hue_deg - region.hue_deg, 360.0));
  std::sort(hue.begin(), hue.end());
  region.tight.hue_deg = {region.hue_deg + at(hue, kTail), region.hue_deg + at(hue, 1.0 - kTail)};
  return region;
}

std::vector<ColorClassDefinition> separateRegions(const std::vector<ColourRegion>& regions) {
  std::vector<ColorClassDefinition> wide;
  for (const ColourRegion& region : regions) wide.push_back(widened(region));
  for (std::size_t a = 0; a < regions.size(); ++a) {
    for (std::size_t b = a + 1; b < regions.size(); ++b) separate(regions[a], regions[b], wide[a], wide[b]);
  }
  std::transform(wide.begin(), wide.end(), wide.begin(), asInFiles);
  return wide;
}

}  // namespace vismem
