#include "common/vision/segment_labeller.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr std::size_t kMaximumDistances = 16;
constexpr std::int16_t kOutside = -1;

/// Colour classes at the distances of one side.
using Side = std::array<ColorClass, kMaximumDistances>;

/// The class of the nearest distance with one.
ColorClass firstOf(const Side& side, std::size_t distances) {
  const auto* end = side.data() + distances;
  const auto* found = std::find_if(side.data(), end, [](ColorClass c) { return c != kNoColorClass; });
  return found == end ? kNoColorClass : *found;
}

void checkDistances(const std::vector<double>& distances_px) {
  if (distances_px.size() > kMaximumDistances) {
    throw std::invalid_argument(std::to_string(distances_px.size()) +
                                " distances on a side of a segment (at most " +
                                std::to_string(kMaximumDistances) + ")");
  }
}

}  // namespace

/// Both sides, and the label of the nearest pair of distances that has a name, or kUnknownLabel.
struct SideSamples::Found {
  Side bright{};
  Side dark{};
  ColorClass bright_class = kNoColorClass;
  ColorClass dark_class = kNoColorClass;
  const Label* label = &kUnknownLabel;
};

SideSamples::SideSamples(const Palette& palette, LabellerParams params)
    : palette_(&palette), params_(std::move(params)) {
  checkDistances(params_.bright_distances_px);
  checkDistances(params_.dark_distances_px);
}

void SideSamples::takeWhole(const cv::Mat& image, const Segment2& px) {
  const double length = px.length();
  const double step_px = (1.0 - 2.0 * params_.trim) / params_.samples * length;
  take(image, px, params_.trim * length + 0.5 * step_px, step_px, params_.samples);
}

void SideSamples::take(const cv::Mat& image, const Segment2& px, double first_px, double step_px, int count) {
  const double length = px.length();
  const bool visible = image.type() == CV_8UC3 && length > 0.0;
  count_ = visible ? count : 0;
  classes_.resize((params_.bright_distances_px.size() + params_.dark_distances_px.size()) *
                  static_cast<std::size_t>(count_));
  colours_.resize(classes_.size());
  if (!visible) return;
  std::size_t at = 0;
  const Eigen::Vector2d along = (px.b - px.a) / length;
  const Eigen::Vector2d first = px.a + first_px * along;
  const Eigen::Vector2d normal = leftNormal(px);
  const auto sampleAt = [&](double aside_px) {
    sample(image, first + aside_px * normal, step_px * along, count, at);
    at += static_cast<std::size_t>(count);
  };
  for (const double d : params_.bright_distances_px) sampleAt(d);
  for (const double d : params_.dark_distances_px) sampleAt(-d);
}

void SideSamples::sample(const cv::Mat& image, const Eigen::Vector2d& first, const Eigen::Vector2d& step,
                         int count, std::size_t at) {
  const auto place = [&](int i) {
    return Eigen::Vector2d(first.x() + i * step.x(), first.y() + i * step.y());
  };
  const auto isInside = [&](const Eigen::Vector2d& p) {
    return nearestPixel(p.x(), image.cols) >= 0 && nearestPixel(p.y(), image.rows) >= 0;
  };
  const bool all_inside = isInside(place(0)) && isInside(place(count - 1));
  const std::uint8_t* const pixels = image.data;
  const std::size_t row_bytes = image.step[0];
  const int last_x = image.cols - 1;
  const int last_y = image.rows - 1;
  std::int16_t* const classes = classes_.data() + at;
  auto* const colours = colours_.data() + at;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d p = place(i);
    classes[i] = all_inside || isInside(p) ? kNoColorClass : kOutside;
    if (classes[i] == kOutside) continue;
    const int x = std::min(static_cast<int>(p.x() + 0.5), last_x);
    const int y = std::min(static_cast<int>(p.y() + 0.5), last_y);
    const std::uint8_t* rgb = pixels + y * row_bytes + 3 * static_cast<std::size_t>(x);
    colours[i] = {rgb[0], rgb[1], rgb[2]};
  }
  // Apart from the pixels, so that their waits for memory overlap.
  for (int i = 0; i < count; ++i) {
    if (classes[i] == kOutside) continue;
    classes[i] = palette_->classOf(colours[i][0], colours[i][1], colours[i][2]);
  }
}

ColorClass SideSamples::classAt(std::size_t distance, int first, int count) const {
  const std::size_t at = distance * static_cast<std::size_t>(count_) + static_cast<std::size_t>(first);
  const std::int16_t* begin = classes_.data() + at;
  const std::int16_t* end = begin + count;
  if (*begin > kNoColorClass && std::all_of(begin + 1, end, [&](std::int16_t c) { return c == *begin; }))
    return static_cast<ColorClass>(*begin);
  const auto inside = static_cast<int>(count - std::count(begin, end, kOutside));
  if (inside == 0) return kNoColorClass;
  std::ptrdiff_t most = 0;
  std::int16_t best = kNoColorClass;
  for (const std::int16_t* one = begin; one != end; ++one) {
    if (*one <= kNoColorClass || *one == best) continue;
    const auto votes = std::count(begin, end, *one);
    if (votes < most || (votes == most && *one > best)) continue;
    most = votes;
    best = *one;
  }
  if (static_cast<double>(most) >= params_.minimum_majority * inside) return static_cast<ColorClass>(best);
  return meanClass(at, count, inside);
}

/// Noise scatters the samples of one surface over neighbouring classes; their mean has its colour.
ColorClass SideSamples::meanClass(std::size_t at, int count, int inside) const {
  std::array<int, 3> sum{};
  int squares = 0;
  for (std::size_t i = at; i < at + static_cast<std::size_t>(count); ++i) {
    if (classes_[i] == kOutside) continue;
    for (std::size_t c = 0; c < sum.size(); ++c) {
      sum[c] += colours_[i][c];
      squares += colours_[i][c] * colours_[i][c];
    }
  }
  const double of_means = (static_cast<double>(sum[0]) * sum[0] + static_cast<double>(sum[1]) * sum[1] +
                           static_cast<double>(sum[2]) * sum[2]) /
                          inside;
  const double variance = (squares - of_means) / (3.0 * inside);
  if (variance > params_.maximum_scatter * params_.maximum_scatter) return kNoColorClass;
  const auto mean = [&](std::size_t c) { return static_cast<std::uint8_t>((sum[c] + inside / 2) / inside); };
  return palette_->classOf(mean(0), mean(1), mean(2));
}

SideSamples::Found SideSamples::look(int first, int count) const {
  Found found;
  if (count_ == 0) return found;
  assert(first >= 0 && count > 0 && first + count <= count_);
  const std::vector<double>& bright_px = params_.bright_distances_px;
  const std::vector<double>& dark_px = params_.dark_distances_px;
  for (std::size_t i = 0; i < bright_px.size(); ++i) found.bright[i] = classAt(i, first, count);
  for (std::size_t j = 0; j < dark_px.size(); ++j) {
    found.dark[j] = classAt(bright_px.size() + j, first, count);
  }
  double nearest_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < bright_px.size(); ++i) {
    if (found.bright[i] == kNoColorClass) continue;
    for (std::size_t j = 0; j < dark_px.size(); ++j) {
      const double distance_px = bright_px[i] + dark_px[j];
      if (distance_px >= nearest_px || found.dark[j] == kNoColorClass) continue;
      const Label& label = palette_->label(found.bright[i], found.dark[j]);
      if (label == kUnknownLabel) continue;
      nearest_px = distance_px;
      found.bright_class = found.bright[i];
      found.dark_class = found.dark[j];
      found.label = &label;
    }
  }
  return found;
}

const Label& SideSamples::label(int first, int count) const {
  return *look(first, count).label;
}

bool SideSamples::asBefore(int first, int count) const {
  for (std::size_t i = static_cast<std::size_t>(first) - 1; i < classes_.size();
       i += static_cast<std::size_t>(count_)) {
    const std::int16_t* one = classes_.data() + i;
    if (*one == kNoColorClass ||
        std::any_of(one + 1, one + 1 + count, [&](std::int16_t c) { return c != *one; }))
      return false;
  }
  return true;
}

SegmentSides SideSamples::sides(int first, int count) const {
  const Found found = look(first, count);
  if (*found.label != kUnknownLabel) return {found.bright_class, found.dark_class, *found.label};
  return {firstOf(found.bright, params_.bright_distances_px.size()),
          firstOf(found.dark, params_.dark_distances_px.size()), kUnknownLabel};
}

}  // namespace vismem
