#include "common/vision/light_estimator.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr std::size_t kOfImage = 10;  // longest edges of an image that count
constexpr std::size_t kWindow = 400;  // edges that count
constexpr std::size_t kLeast = 60;    // edges before a search
constexpr double kLeastLength_px = 12.0;
constexpr double kLongest_px = 100.0;                    // longer edges count as this long
constexpr std::array<double, 2> kDistance_px{1.5, 2.5};  // bright, dark side: see LabellerParams
constexpr int kPlaces = 9;                               // along an edge
constexpr double kTrim = 0.15;                           // share of the length left out at each end

// The neutral light ends when another one names twice as many edges, and the neutral one next to nothing or
// the other one changes its names. While these stay, the edges without a name may be texture, which a
// brighter light would name.
constexpr double kNextToNothing = 0.12;  // share of the edges
constexpr double kTimesNeutral = 2.0;    // that another light must name
constexpr double kNamed = 0.85;          // share of the edges with a neutral name that it must name, too
constexpr double kNamedAlike = 0.7;      // share of them that may keep their name
constexpr double kLeastShare = 0.2;      // that another light must name
constexpr double kFollows = 0.01;        // of the share, for a small change of a light that is not neutral
constexpr double kShareFell = 0.1;       // since the last search: searches at once

// Prior deviations of the unknowns, and the share that one of them costs.
const Eigen::Matrix<double, 5, 1> kPrior{0.7, 0.25, 0.35, 0.25, 0.5};
constexpr double kPriorCost = 0.01;
const Eigen::Matrix<double, 5, 1> kLimit{1.25, 0.6, 0.9, 0.5, 0.7};

/// Median of each channel along one side of an edge. @return empty with less than half of the places inside.
std::optional<std::array<std::uint8_t, 3>> colourBeside(const cv::Mat& image, const Segment2& px,
                                                        const Eigen::Vector2d& outwards) {
  std::array<std::array<std::uint8_t, kPlaces>, 3> values;
  int count = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double share = kTrim + (1.0 - 2.0 * kTrim) * (i + 0.5) / kPlaces;
    const Eigen::Vector2d place = px.a + share * (px.b - px.a) + outwards;
    const int x = static_cast<int>(std::lround(place.x()));
    const int y = static_cast<int>(std::lround(place.y()));
    if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) continue;
    const std::uint8_t* rgb = image.ptr<std::uint8_t>(y) + 3 * static_cast<std::ptrdiff_t>(x);
    for (int channel = 0; channel < 3; ++channel) values[channel][count] = rgb[channel];
    ++count;
  }
  if (2 * count <= kPlaces) return std::nullopt;
  std::array<std::uint8_t, 3> median;
  for (int channel = 0; channel < 3; ++channel) {
    auto* begin = values[channel].data();
    std::nth_element(begin, begin + count / 2, begin + count);
    median[channel] = begin[count / 2];
  }
  return median;
}

}  // namespace

LightEstimator::LightEstimator(std::shared_ptr<const Palette> palette)
    : palette_(std::move(palette)), patience_(kLeast) {
  const std::vector<Label> labels = palette_->labels();
  const int side = palette_->classCount() + 1;
  for (int a = 0; a < side; ++a) {
    for (int b = 0; b < side; ++b) {
      const Label& label = palette_->label(static_cast<ColorClass>(a), static_cast<ColorClass>(b));
      const auto at = std::find(labels.begin(), labels.end(), label);
      names_.push_back(at == labels.end() ? kNoName : static_cast<int>(at - labels.begin()));
    }
  }
  samples_.reserve(kWindow);
}

ImageLight LightEstimator::lightOf(const Unknowns& x) {
  ImageLight light;
  light.gain = {std::exp(x[0] + x[1]), std::exp(x[0]), std::exp(x[0] + x[2])};
  light.gamma = std::exp(x[3]);
  light.vignette = x[4];
  return light;
}

void LightEstimator::add(const cv::Mat& image, const Segment2& px) {
  if (px.length() < kLeastLength_px) return;
  const Eigen::Vector2d normal = leftNormal(px);
  const auto bright = colourBeside(image, px, kDistance_px[0] * normal);
  const auto dark = colourBeside(image, px, -kDistance_px[1] * normal);
  if (!bright || !dark) return;
  const Eigen::Vector2d middle(0.5 * (image.cols - 1), 0.5 * (image.rows - 1));
  const double r2 = (0.5 * (px.a + px.b) - middle).squaredNorm() / middle.squaredNorm();
  const auto ring = static_cast<std::uint8_t>(LightTable::ring(std::min(r2, 1.0)));
  Sample sample{{*bright, *dark}, ring, std::pow(std::min(px.length(), kLongest_px), 2), false};
  sample.named = nameUnder(table_, sample) != kNoName;
  if (samples_.size() < kWindow) {
    samples_.push_back(sample);
  } else {
    samples_[next_] = sample;
    next_ = (next_ + 1) % kWindow;
  }
  ++unsearched_;
}

int LightEstimator::nameUnder(const LightTable& table, const Sample& sample) const {
  const auto classOf = [&](int side) {
    const auto& rgb = sample.sides[side];
    return palette_->classOf(table.at(sample.ring, 0, rgb[0]), table.at(sample.ring, 1, rgb[1]),
                             table.at(sample.ring, 2, rgb[2]));
  };
  return names_[classOf(0) * (palette_->classCount() + 1) + classOf(1)];
}

template <typename IsNamed>
double LightEstimator::shareOf(const IsNamed& is_named) const {
  double named = 0.0;
  double all = 0.0;
  for (const Sample& sample : samples_) {
    all += sample.weight;
    if (std::invoke(is_named, sample)) named += sample.weight;
  }
  return all > 0.0 ? named / all : 1.0;
}

double LightEstimator::shareUnder(const ImageLight& light) const {
  const LightTable table(light);
  return shareOf([&](const Sample& sample) { return nameUnder(table, sample) != kNoName; });
}

bool LightEstimator::renames(const ImageLight& light) const {
  const LightTable table(light);
  const LightTable neutral(ImageLight{});
  double named = 0.0;
  double both = 0.0;
  double alike = 0.0;
  for (const Sample& sample : samples_) {
    const int before = nameUnder(neutral, sample);
    if (before == kNoName) continue;
    const int after = nameUnder(table, sample);
    named += sample.weight;
    if (after != kNoName) both += sample.weight;
    if (after == before) alike += sample.weight;
  }
  return both >= kNamed * named && alike <= kNamedAlike * named;
}

bool LightEstimator::endsNeutral(const ImageLight& light, double neutral, double other) const {
  return other >= kTimesNeutral * neutral && (neutral <= kNextToNothing || renames(light));
}

double LightEstimator::merit(const Unknowns& x) const {
  return shareUnder(lightOf(x)) - kPriorCost * x.cwiseQuotient(kPrior).squaredNorm();
}

/// The best of a grid of brightnesses and colour temperatures (2700 to 10000 K: logarithms of red and blue
/// against green lie on a straight line).
LightEstimator::Unknowns LightEstimator::coarsest() const {
  Unknowns best = Unknowns::Zero();
  double most = merit(best);
  for (int gain = -7; gain <= 7; ++gain) {
    for (int red = -4; red <= 1; ++red) {
      const Unknowns x{0.15 * gain, 0.07 * red, -1.82 * 0.07 * red, 0.0, 0.0};
      const double here = merit(x);
      if (here <= most) continue;
      most = here;
      best = x;
    }
  }
  return best;
}

/// Coordinate ascent with ever smaller steps.
LightEstimator::Unknowns LightEstimator::climbed(Unknowns x) const {
  double most = merit(x);
  for (const double step : {0.2, 0.1, 0.05}) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int i = 0; i < x.size(); ++i) {
        for (const double by : {-step, step}) {
          Unknowns to = x;
          to[i] = std::clamp(to[i] + by, i == 4 ? 0.0 : -kLimit[i], kLimit[i]);
          const double here = merit(to);
          if (here <= most + 1e-9) continue;
          most = here;
          x = to;
          moved = true;
        }
      }
    }
  }
  return x;
}

/// The share has a flat top: moves gain and colours to its middle, where it bears most change of light.
LightEstimator::Unknowns LightEstimator::centred(Unknowns x) const {
  constexpr double kStep = 0.05;
  constexpr int kSteps = 8;
  const double enough = 0.95 * shareUnder(lightOf(x));
  for (int i = 0; i < 3; ++i) {
    const auto reach = [&](double step) {
      Unknowns to = x;
      double reached = 0.0;
      for (int n = 0; n < kSteps; ++n) {
        to[i] += step;
        if (shareUnder(lightOf(to)) < enough) break;
        reached += step;
      }
      return reached;
    };
    x[i] += 0.5 * (reach(kStep) + reach(-kStep));
  }
  return x;
}

bool LightEstimator::search() {
  const double neutral = merit(Unknowns::Zero());
  const double now = merit(x_);
  const Unknowns found = centred(climbed(shareUnder(light_) < 0.5 ? coarsest() : x_));
  const double best = merit(found);
  Unknowns next = x_;
  const bool better = light_.isNeutral() ? endsNeutral(lightOf(found), now, best) : best >= now + kFollows;
  if (best >= kLeastShare && better) next = found;
  if (neutral >= merit(next)) next = Unknowns::Zero();
  unsearched_ = 0;
  if (next == x_) {
    patience_ = std::min(2 * patience_, 8 * kWindow);
    return false;
  }
  patience_ = kWindow / 4;
  x_ = next;
  light_ = x_.isZero() ? ImageLight{} : lightOf(x_);
  table_ = LightTable(light_);
  for (Sample& sample : samples_) sample.named = nameUnder(table_, sample) != kNoName;
  return true;
}

bool LightEstimator::update(const cv::Mat& image, const std::vector<RawSegment>& segments) {
  if (image.type() != CV_8UC3) return false;
  longest_.clear();
  for (const RawSegment& segment : segments) longest_.push_back(segment.px_raw);
  const std::size_t most = std::min(kOfImage, longest_.size());
  std::partial_sort(longest_.begin(), longest_.begin() + static_cast<std::ptrdiff_t>(most), longest_.end(),
                    [](const Segment2& a, const Segment2& b) { return a.length() > b.length(); });
  for (std::size_t i = 0; i < most; ++i) add(image, longest_[i]);
  if (samples_.empty()) return false;
  named_share_ = shareOf(&Sample::named);
  const bool fell = unsearched_ >= kLeast && named_share_ < searched_share_ - kShareFell;
  if (samples_.size() < kLeast || (unsearched_ < patience_ && !fell)) return false;
  const bool changed = search();
  named_share_ = shareOf(&Sample::named);
  searched_share_ = named_share_;
  return changed;
}

}  // namespace vismem
