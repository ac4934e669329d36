#include "simulator/core/image_errors.h"

#include <algorithm>
#include <cmath>

#include "common/kinematics/random_stream.h"

namespace vismem {
namespace {

constexpr std::size_t kTable = 1 << 18;
constexpr int kNormalOne = 4096;
constexpr int kSigmaOne = 256;
/// Larger gains give black or white images.
constexpr double kMaxLogGain = 2.0;

}  // namespace

ImageErrors::ImageErrors(const ImageErrorParams& params, std::uint64_t seed)
    : params_(params), seed_(seed), exposure_(subStream(seed, "exposure")) {
  for (int level = 0; level < 256; ++level) {
    const double variance = params.gaussian * params.gaussian + params.shot * params.shot * level / 255.0;
    sigma_[level] = static_cast<int>(std::lround(kSigmaOne * std::sqrt(variance)));
  }
  if (sigma_.back() == 0) return;
  std::mt19937_64 engine(subStream(seed, "noise"));
  std::normal_distribution<double> normal(0.0, kNormalOne);
  normal_.resize(kTable);
  for (auto& value : normal_)
    value = static_cast<std::int16_t>(std::clamp(normal(engine), -32767.0, 32767.0));
}

double ImageErrors::gainAt(StampUs stamp_us) {
  if (params_.exposure_sigma <= 0.0) return 1.0;
  std::normal_distribution<double> normal(0.0, 1.0);
  const double kept =
      started_ ? std::exp(-toSeconds(stamp_us - gain_us_) / std::max(1e-3, params_.exposure_time_s)) : 0.0;
  log_gain_ = kept * log_gain_ + params_.exposure_sigma * std::sqrt(1.0 - kept * kept) * normal(exposure_);
  gain_us_ = stamp_us;
  started_ = true;
  return std::exp(std::clamp(log_gain_, -kMaxLogGain, kMaxLogGain));
}

void ImageErrors::apply(cv::Mat& image, std::uint64_t seq, double gain) const {
  if (gain != 1.0) image.convertTo(image, -1, gain);
  if (!normal_.empty()) addNoise(image, seq);
}

void ImageErrors::addNoise(cv::Mat& image, std::uint64_t seq) const {
  const std::size_t width = image.cols * image.elemSize();
  constexpr int kScale = kNormalOne * kSigmaOne;
  for (int row = 0; row < image.rows; ++row) {
    const std::uint64_t start =
        subStream(seed_ ^ (seq << 20) ^ static_cast<std::uint64_t>(row), "row") % kTable;
    std::size_t at = start;
    std::uint8_t* p = image.ptr(row);
    for (std::size_t done = 0; done < width;) {
      const std::size_t run = std::min(width - done, kTable - at);
      for (std::size_t i = 0; i < run; ++i) {
        const int noise = normal_[at + i] * sigma_[p[i]];
        p[i] = static_cast<std::uint8_t>(
            std::clamp(p[i] + (noise + (noise >= 0 ? kScale / 2 : -kScale / 2)) / kScale, 0, 255));
      }
      p += run;
      done += run;
      at = 0;
    }
  }
}

}  // namespace vismem
