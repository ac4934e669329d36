#include "common/vision/light.h"

#include <algorithm>
#include <cmath>

#include "common/config/text_format.h"

namespace vismem {

std::string describe(const ImageLight& light) {
  std::string text;
  const auto add = [&](const char* format, double value, double neutral) {
    if (std::abs(value - neutral) < 0.1) return;
    text += (text.empty() ? "images are " : ", ") + formatted(format, value);
  };
  // Green stands for the brightness; at half of the range, where gamma counts, too.
  const double half = light.gain[1] * std::pow(0.5, light.gamma);
  add("%.1f times as bright as the palette expects", 0.5 / half, 1.0);
  add("red %.1f times", light.gain[1] / light.gain[0], 1.0);
  add("blue %.1f times", light.gain[1] / light.gain[2], 1.0);
  add("darker in the corners by %.1f", light.vignette, 0.0);
  return text;
}

LightTable::LightTable(const ImageLight& light) : has_rings_(light.vignette != 0.0) {
  std::array<double, 256> power;
  for (int level = 0; level < 256; ++level) power[level] = 255.0 * std::pow(level / 255.0, light.gamma);
  const int rings = has_rings_ ? kRings : 1;
  for (int ring = 0; ring < rings; ++ring) {
    const double r2 = static_cast<double>(ring) / (kRings - 1);
    for (int channel = 0; channel < 3; ++channel) {
      const double gain = light.gain[channel] / (1.0 - light.vignette * r2);
      std::uint8_t* to = levels_.data() + (static_cast<std::size_t>(ring) * 3 + channel) * 256;
      for (int level = 0; level < 256; ++level) {
        to[level] = static_cast<std::uint8_t>(std::min(gain * power[level] + 0.5, 255.0));
      }
    }
  }
  for (int ring = rings; ring < kRings; ++ring) {
    std::copy_n(levels_.begin(), 3 * 256, levels_.begin() + static_cast<std::ptrdiff_t>(ring) * 3 * 256);
  }
}

void LightTable::correct(const cv::Mat& image, cv::Mat& corrected) const {
  if (image.type() != CV_8UC3) {
    corrected = image;
    return;
  }
  corrected.create(image.size(), image.type());
  const double middle_x = 0.5 * (image.cols - 1);
  const double middle_y = 0.5 * (image.rows - 1);
  const double per_corner2 = 1.0 / std::max(middle_x * middle_x + middle_y * middle_y, 1.0);
  for (int row = 0; row < image.rows; ++row) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(row);
    std::uint8_t* to = corrected.ptr<std::uint8_t>(row);
    const double y2 = (row - middle_y) * (row - middle_y);
    for (int column = 0; column < image.cols; ++column, from += 3, to += 3) {
      const double x = column - middle_x;
      const int here = has_rings_ ? ring((x * x + y2) * per_corner2) : 0;
      for (int channel = 0; channel < 3; ++channel) to[channel] = at(here, channel, from[channel]);
    }
  }
}

}  // namespace vismem
