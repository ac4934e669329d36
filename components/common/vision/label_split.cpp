#include "common/vision/label_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace vismem {
namespace {

constexpr double kStep_px = 2.0;   // between samples, and between the windows that are labelled
constexpr int kWindowSamples = 3;  // of a window: they give a majority
constexpr double kWindow_px = kWindowSamples * kStep_px;

/// Rows beside the segment in which the border between two labels is located [px]. The border need not be
/// perpendicular to the segment: the side of a door is upright in the image for any direction of its foot.
constexpr std::array<double, 5> kRows_px{1.5, 2.25, 3.0, 3.75, 4.5};
constexpr double kReach_px = 8.0;    // length of a row to both sides of a cut
constexpr double kPlateau_px = 3.0;  // outer parts of a row: the colours of both labels
constexpr double kPitch_px = 0.5;
constexpr double kLeastContrast = 20.0;  // least difference of these colours [grey levels]
constexpr double kContrastShare = 0.5;   // and least share of the best row's difference
constexpr double kMostOff_px = 4.0;      // largest distance of the border from a cut
constexpr double kMostSlope = 2.5;       // along the segment per pixel away from it
constexpr double kMostScatter_px = 0.7;  // of the rows about a straight border

/// Bilinear colour; empty outside the image.
std::optional<Eigen::Vector3f> colourAt(const cv::Mat& image, const Eigen::Vector2d& px) {
  const int x = static_cast<int>(std::floor(px.x()));
  const int y = static_cast<int>(std::floor(px.y()));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return std::nullopt;
  const auto fx = static_cast<float>(px.x() - x);
  const auto fy = static_cast<float>(px.y() - y);
  const auto at = [&](int row, int column) {
    const std::uint8_t* rgb = image.ptr<std::uint8_t>(row) + 3 * static_cast<std::ptrdiff_t>(column);
    return Eigen::Vector3f(rgb[0], rgb[1], rgb[2]);
  };
  return Eigen::Vector3f((1 - fy) * ((1 - fx) * at(y, x) + fx * at(y, x + 1)) +
                         fy * ((1 - fx) * at(y + 1, x) + fx * at(y + 1, x + 1)));
}

struct Border {
  double off_px = 0.0;  ///< along the row, from its middle
  double contrast = 0.0;
};

/// Position of the colour change in a row.
/// @param middle of the row.
/// @return empty for a difference below kLeastContrast.
std::optional<Border> borderInRow(const cv::Mat& image, const Eigen::Vector2d& middle,
                                  const Eigen::Vector2d& along) {
  constexpr auto kSamples = static_cast<int>(2.0 * kReach_px / kPitch_px);
  constexpr auto kOuter = static_cast<int>(kPlateau_px / kPitch_px);
  std::array<Eigen::Vector3f, kSamples> colours;
  Eigen::Vector3f before = Eigen::Vector3f::Zero();
  Eigen::Vector3f after = Eigen::Vector3f::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const auto colour = colourAt(image, middle + ((i + 0.5) * kPitch_px - kReach_px) * along);
    if (!colour) return std::nullopt;
    colours[static_cast<std::size_t>(i)] = *colour;
    if (i < kOuter) before += *colour / kOuter;
    if (i >= kSamples - kOuter) after += *colour / kOuter;
  }
  const Eigen::Vector3f change = after - before;
  const double contrast = change.norm();
  if (contrast < kLeastContrast) return std::nullopt;
  // Length of the first colour in the row, by interpolation without a threshold: subpixel.
  double length = 0.0;
  for (const Eigen::Vector3f& colour : colours) {
    const double share = (colour - before).dot(change) / (contrast * contrast);
    length += kPitch_px * (1.0 - std::clamp(share, 0.0, 1.0));
  }
  return Border{length - kReach_px, contrast};
}

/// Intersection of the border near `cut` with the segment.
/// @return empty without a straight border.
std::optional<double> borderAt(const cv::Mat& image, const Eigen::Vector2d& cut,
                               const Eigen::Vector2d& along) {
  const Eigen::Vector2d left(along.y(), -along.x());
  std::optional<double> best;
  double best_contrast = 0.0;
  for (const double side : {1.0, -1.0}) {
    std::array<std::optional<Border>, kRows_px.size()> rows;
    double strongest = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = borderInRow(image, cut + side * kRows_px[i] * left, along);
      if (rows[i]) strongest = std::max(strongest, rows[i]->contrast);
    }
    if (strongest <= best_contrast) continue;
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!rows[i] || rows[i]->contrast < kContrastShare * strongest) continue;
      const double d = kRows_px[i];
      const double off = rows[i]->off_px;
      n += 1.0;
      x += d;
      y += off;
      xx += d * d;
      xy += d * off;
      yy += off * off;
    }
    if (n < 3.0) continue;
    const double slope = (n * xy - x * y) / (n * xx - x * x);
    const double off = (y - slope * x) / n;
    const double scatter2 = (yy - off * y - slope * xy) / n;
    if (std::abs(slope) > kMostSlope || std::abs(off) > kMostOff_px ||
        scatter2 > kMostScatter_px * kMostScatter_px) {
      continue;
    }
    best = off;
    best_contrast = strongest;
  }
  return best;
}

}  // namespace

LabelSplitter::LabelSplitter(const Palette& palette, LabellerParams params)
    : samples_(palette, std::move(params)) {}

void LabelSplitter::findRuns(const cv::Mat& image, const Segment2& px, double minimum_px) {
  runs_.clear();
  const double length = px.length();
  if (length < std::max(2.0 * minimum_px, kWindow_px)) return;
  const int windows = 1 + static_cast<int>((length - kWindow_px) / kStep_px);
  samples_.take(image, px, 0.5 * kStep_px, kStep_px, windows + kWindowSamples - 1);
  const Label* label = nullptr;
  for (int i = 0; i < windows; ++i) {
    const double at = 0.5 * kWindow_px + i * kStep_px;
    if (i == 0 || !samples_.asBefore(i, kWindowSamples)) label = &samples_.label(i, kWindowSamples);
    if (*label == kUnknownLabel) continue;  // uninformative: neither ends nor begins a run
    if (!runs_.empty() && *runs_.back().label == *label) {
      runs_.back().to_px = at;
    } else {
      runs_.push_back({label, at, at});
    }
  }
  std::erase_if(runs_, [&](const Run& run) { return run.to_px - run.from_px + kWindow_px < minimum_px; });
  std::size_t joined = 0;
  for (const Run& run : runs_) {
    if (joined > 0 && *runs_[joined - 1].label == *run.label) {
      runs_[joined - 1].to_px = run.to_px;
    } else {
      runs_[joined++] = run;
    }
  }
  runs_.resize(joined);
}

std::span<const LabelledPiece> LabelSplitter::split(const cv::Mat& image, const Segment2& px,
                                                    double minimum_px) {
  findRuns(image, px, minimum_px);
  pieces_.clear();
  if (runs_.size() < 2) {
    pieces_.push_back({px, &samples_.labelOfWhole(image, px)});
    return pieces_;
  }
  const double length = px.length();
  const Eigen::Vector2d along = (px.b - px.a) / length;
  double begin = 0.0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const bool last = i + 1 == runs_.size();
    double end = length;
    if (!last) {
      end = 0.5 * (runs_[i].to_px + runs_[i + 1].from_px);
      end += borderAt(image, px.a + end * along, along).value_or(0.0);
      end = std::clamp(end, begin, length);
    }
    pieces_.push_back({{px.a + begin * along, px.a + end * along}, runs_[i].label});
    begin = end;
  }
  return pieces_;
}

}  // namespace vismem
