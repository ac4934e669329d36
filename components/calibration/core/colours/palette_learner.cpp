#include "calibration/core/colours/palette_learner.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr double kLeastEdge_px = 15.0;
constexpr double kPiece_px = 15.0;                             // a foot of a wall goes on as that of a door
constexpr std::array<double, 3> kDistances_px{2.5, 3.5, 4.5};  // beyond the blur of an edge
constexpr int kAlong = 9;
constexpr int kSurfaceStep_px = 8;
constexpr int kNeighbour_px = 2;
constexpr int kEven_levels = 10;   // a surface is even when its neighbours differ by no more
constexpr double kLowPart = 0.75;  // the lower part of an image begins here
constexpr int kMedian_px = 5;
constexpr int kFlood_levels = 3;
constexpr std::size_t kMostOfClick = 400;
constexpr double kOtherName = 0.05;  // share of a click's surface that counts as a contradiction

constexpr double kLeastClass = 0.004;  // of the length beside all edges
constexpr double kLeastPair = 0.004;   // of the length of all edges
constexpr std::size_t kLeastPairImages = 3;
constexpr double kPaintedOnFloor = 0.9;  // of the length of its edges
constexpr double kPaintedEdge = 3.5;     // shares: beside edges to surface
const std::string kFloor = "floor";
const std::string kIgnored = "ignored";

Rgb rgbAt(const cv::Mat& image, int x, int y) {
  const auto& c = image.at<cv::Vec3b>(y, x);
  return {c[0], c[1], c[2]};
}

bool isInside(const cv::Mat& image, int x, int y) {
  return x >= 0 && y >= 0 && x < image.cols && y < image.rows;
}

/// Median beside a segment, channel by channel; nothing when most of it lies outside the image.
std::optional<Rgb> colourBeside(const cv::Mat& image, const Segment2& px, const Eigen::Vector2d& outwards) {
  std::array<std::vector<std::uint8_t>, 3> channels;
  for (const double distance_px : kDistances_px) {
    for (int i = 0; i < kAlong; ++i) {
      const Eigen::Vector2d p =
          px.a + (0.1 + 0.8 * (i + 0.5) / kAlong) * (px.b - px.a) + distance_px * outwards;
      const int x = static_cast<int>(std::lround(p.x()));
      const int y = static_cast<int>(std::lround(p.y()));
      if (!isInside(image, x, y)) continue;
      const Rgb rgb = rgbAt(image, x, y);
      for (int k = 0; k < 3; ++k) channels[k].push_back(rgb[k]);
    }
  }
  if (channels[0].size() < kAlong) return std::nullopt;
  Rgb median{};
  for (int k = 0; k < 3; ++k) {
    const auto middle = channels[k].begin() + static_cast<std::ptrdiff_t>(channels[k].size() / 2);
    std::nth_element(channels[k].begin(), middle, channels[k].end());
    median[k] = *middle;
  }
  return median;
}

bool isEven(const cv::Mat& image, int x, int y) {
  const Rgb middle = rgbAt(image, x, y);
  for (const auto& [dx, dy] :
       {std::pair(-kNeighbour_px, 0), {kNeighbour_px, 0}, {0, -kNeighbour_px}, {0, kNeighbour_px}}) {
    const Rgb other = rgbAt(image, x + dx, y + dy);
    for (int k = 0; k < 3; ++k) {
      if (std::abs(other[k] - middle[k]) > kEven_levels) return false;
    }
  }
  return true;
}

std::string labelOf(const std::string& a, const std::string& b, const std::set<std::string>& painted) {
  if (a != kFloor && b != kFloor) return a + "_" + b;
  const std::string& other = a == kFloor ? b : a;
  return other + (painted.contains(other) ? "_edge" : "_foot");
}

}  // namespace

std::string LearntPalette::text() const {
  std::ostringstream out;
  out << "# Colours that learn_palette found in images. Names are guesses where nothing was clicked.\n";
  for (const LearntClass& one : classes) {
    const ColorClassDefinition& region = one.region;
    out << "class." << region.name << " =";
    if (region.hue_deg.low > 0.0 || region.hue_deg.high < 360.0)
      out << " hue " << region.hue_deg.low << ".." << region.hue_deg.high;
    out << " saturation " << region.saturation_percent.low << ".." << region.saturation_percent.high
        << " value " << region.value_percent.low << ".." << region.value_percent.high << "\n";
  }
  out << "\n";
  for (const LearntPair& pair : pairs)
    out << "pair." << pair.label << " = " << pair.a << " " << pair.b << "\n";
  return out.str();
}

std::size_t PaletteLearner::add(const Rgb& rgb, double weight, Kind kind) {
  colours_.push_back(rgb);
  weights_.push_back(weight);
  kinds_.push_back(kind);
  return colours_.size() - 1;
}

void PaletteLearner::addImage(const cv::Mat& image, const std::vector<RawSegment>& segments) {
  for (const RawSegment& segment : segments) {
    const Segment2& px = segment.px_raw;
    if (px.length() < kLeastEdge_px) continue;
    const Eigen::Vector2d normal = leftNormal(px);
    const int pieces = std::max(1, static_cast<int>(px.length() / kPiece_px));
    for (int i = 0; i < pieces; ++i) {
      const auto at = [&](int k) -> Eigen::Vector2d {
        return px.a + static_cast<double>(k) / pieces * (px.b - px.a);
      };
      const Segment2 piece{at(i), at(i + 1)};
      const auto bright = colourBeside(image, piece, normal);
      const auto dark = colourBeside(image, piece, -normal);
      if (!bright || !dark) continue;
      const double length_px = piece.length();
      edges_.push_back(
          {{add(*bright, length_px, Kind::kSide), add(*dark, length_px, Kind::kSide)}, length_px, images_});
    }
  }
  addSurfaces(image);
  ++images_;
}

void PaletteLearner::addSurfaces(const cv::Mat& image) {
  for (int y = kSurfaceStep_px; y + kSurfaceStep_px < image.rows; y += kSurfaceStep_px) {
    const Kind kind = y > kLowPart * image.rows ? Kind::kLowSurface : Kind::kSurface;
    for (int x = kSurfaceStep_px; x + kSurfaceStep_px < image.cols; x += kSurfaceStep_px) {
      // A pixel counts as much as a pixel of an edge's length.
      if (isEven(image, x, y)) add(rgbAt(image, x, y), 1.0, kind);
    }
  }
}

void PaletteLearner::addClick(const std::string& name, const cv::Mat& image, const Eigen::Vector2i& px) {
  cv::Mat mask = cv::Mat::zeros(image.rows + 2, image.cols + 2, CV_8UC1);
  cv::Mat smooth;  // noise would end the surface
  cv::medianBlur(image, smooth, kMedian_px);
  const cv::Scalar step = cv::Scalar::all(kFlood_levels);
  cv::floodFill(smooth, mask, {px.x(), px.y()}, {}, nullptr, step, step,
                4 | cv::FLOODFILL_MASK_ONLY | (1 << 8));
  std::vector<cv::Point> points;
  cv::findNonZero(mask(cv::Rect(1, 1, image.cols, image.rows)), points);
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kMostOfClick);
  for (std::size_t i = 0; i < points.size(); i += stride)
    clicks_[name].push_back(add(rgbAt(image, points[i].x, points[i].y), 1.0, Kind::kClick));
}

std::string PaletteLearner::nameByClicks(std::size_t cluster, const ColourClusters& clusters,
                                         std::vector<std::string>& notes) const {
  std::string best;
  double best_share = 0.0;
  std::string all;
  for (const auto& [name, colours] : clicks_) {
    const auto here = std::count_if(colours.begin(), colours.end(),
                                    [&](std::size_t i) { return clusters.cluster_of[i] == cluster; });
    const double share = static_cast<double>(here) / static_cast<double>(colours.size());
    if (share < kOtherName) continue;
    all += (all.empty() ? "" : " and ") + name;
    if (share > best_share) best = name, best_share = share;
  }
  if (all != best) notes.push_back("clicks of " + all + " have the same colours: they are " + best + " now");
  return best;
}

std::vector<PaletteLearner::Cluster> PaletteLearner::gather(const ColourClusters& clusters,
                                                            std::vector<std::string>& notes) const {
  std::vector<Cluster> all(clusters.count);
  double side_px = 0.0;
  for (std::size_t i = 0; i < colours_.size(); ++i) {
    Cluster& cluster = all[clusters.cluster_of[i]];
    cluster.colours.push_back(colours_[i]);
    if (kinds_[i] == Kind::kSide) cluster.side_px += weights_[i], side_px += weights_[i];
    if (kinds_[i] == Kind::kSurface || kinds_[i] == Kind::kLowSurface) cluster.surface += 1.0;
    if (kinds_[i] == Kind::kLowSurface) cluster.low_surface += 1.0;
  }
  for (std::size_t i = 0; i < all.size(); ++i) all[i].name = nameByClicks(i, clusters, notes);
  std::erase_if(all,
                [&](const Cluster& one) { return one.name.empty() && one.side_px < kLeastClass * side_px; });
  for (Cluster& cluster : all) {
    std::vector<ColorValues> values;
    for (const Rgb& c : cluster.colours) values.push_back(colorValues(c[0], c[1], c[2]));
    cluster.region = regionOf(values);
  }
  if (all.size() < 2) throw std::runtime_error("fewer than two colours beside edges: no pair can be named");
  return all;
}

std::vector<LearntPair> PaletteLearner::pairsUnder(const Palette& palette,
                                                   const std::vector<LearntClass>& classes) const {
  struct Border {
    double length_px = 0.0;
    std::set<std::size_t> images;
  };
  std::map<std::pair<std::string, std::string>, Border> borders;
  double all_px = 0.0;
  for (const Edge& edge : edges_) {
    all_px += edge.length_px;
    std::array<ColorClass, 2> classes{};
    for (std::size_t s = 0; s < 2; ++s) {
      const Rgb& c = colours_[edge.sides[s]];
      classes[s] = palette.classOf(c[0], c[1], c[2]);
    }
    if (classes[0] == kNoColorClass || classes[1] == kNoColorClass) continue;
    const auto& [a, b] = std::minmax(palette.className(classes[0]), palette.className(classes[1]));
    if (a == b) continue;
    Border& border = borders[{a, b}];
    border.length_px += edge.length_px;
    border.images.insert(edge.image);
  }
  // What borders on the floor alone, and has more edge than surface, is painted on it.
  std::map<std::string, std::pair<double, double>> on_floor;  // length with the floor, and with anything
  for (const auto& [names, border] : borders) {
    for (const std::string& name : {names.first, names.second}) {
      const bool is_floor = names.first == kFloor || names.second == kFloor;
      on_floor[name].first += is_floor ? border.length_px : 0.0;
      on_floor[name].second += border.length_px;
    }
  }
  std::set<std::string> painted;
  for (const LearntClass& one : classes) {
    const auto& [with_floor, with_any] = on_floor[one.region.name];
    if (with_floor > kPaintedOnFloor * with_any && one.side_share > kPaintedEdge * one.surface_share)
      painted.insert(one.region.name);
  }
  std::vector<LearntPair> pairs;
  for (const auto& [names, border] : borders) {
    if (names.first == kIgnored || names.second == kIgnored) continue;
    if (border.length_px < kLeastPair * all_px || border.images.size() < kLeastPairImages) continue;
    pairs.push_back(
        {labelOf(names.first, names.second, painted), names.first, names.second, border.length_px / all_px});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
  return pairs;
}

void PaletteLearner::nameRest(std::vector<Cluster>& found) const {
  if (!clicks_.contains(kFloor)) {
    const auto low = [](const Cluster& one) { return one.name.empty() ? one.low_surface : -1.0; };
    const auto lowest = std::max_element(found.begin(), found.end(),
                                         [&](const auto& a, const auto& b) { return low(a) < low(b); });
    if (lowest->name.empty()) lowest->name = kFloor;
  }
  std::map<std::string, int> guessed;
  for (Cluster& cluster : found) {
    if (!cluster.name.empty()) continue;
    cluster.name = cluster.region.colourName();
    if (const int before = guessed[cluster.name]++; before > 0) cluster.name += std::to_string(before + 1);
  }
}

double PaletteLearner::keptNames(const Palette& palette,
                                 const std::function<cv::Mat(const cv::Mat&)>& relit) const {
  cv::Mat before(static_cast<int>(edges_.size()), 2, CV_8UC3);
  for (int i = 0; i < before.rows; ++i) {
    for (int s = 0; s < 2; ++s) {
      const Rgb& c = colours_[edges_[static_cast<std::size_t>(i)].sides[static_cast<std::size_t>(s)]];
      before.at<cv::Vec3b>(i, s) = {c[0], c[1], c[2]};
    }
  }
  const cv::Mat after = relit(before);
  const auto labelIn = [&](const cv::Mat& image, int i) {
    const auto classOf = [&](int s) {
      const Rgb c = rgbAt(image, s, i);
      return palette.classOf(c[0], c[1], c[2]);
    };
    return palette.label(classOf(0), classOf(1));
  };
  double named_px = 0.0;
  double kept_px = 0.0;
  for (int i = 0; i < before.rows; ++i) {
    const Label label = labelIn(before, i);
    if (label == kUnknownLabel) continue;
    const double length_px = edges_[static_cast<std::size_t>(i)].length_px;
    named_px += length_px;
    if (labelIn(after, i) == label) kept_px += length_px;
  }
  return named_px > 0.0 ? kept_px / named_px : 1.0;
}

LearntPalette PaletteLearner::learn() const {
  LearntPalette result;
  std::vector<std::vector<std::size_t>> clicked;
  for (const auto& [name, colours] : clicks_) clicked.push_back(colours);
  const ColourClusters clusters =
      cutBetweenGroups(clusterColours(colours_, weights_), colours_, clicked, kOtherName);
  std::vector<Cluster> found = gather(clusters, result.notes);
  nameRest(found);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.region.volume() < b.region.volume(); });
  std::vector<ColourRegion> regions;
  double side_px = 1.0;
  double surface = 1.0;
  for (const Cluster& cluster : found) {
    regions.push_back(cluster.region);
    side_px += cluster.side_px;
    surface += cluster.surface;
  }
  const std::vector<ColorClassDefinition> boxes = separateRegions(regions);
  for (std::size_t k = 0; k < found.size(); ++k) {
    result.classes.push_back({boxes[k], found[k].side_px / side_px, found[k].surface / surface});
    result.classes.back().region.name = found[k].name;
  }

  const Palette palette = Palette::parse(result.text(), "the learnt palette");
  double wrong = 0.0;
  double all = 0.0;
  for (const Cluster& cluster : found) {
    for (const Rgb& c : cluster.colours) {
      all += 1.0;
      if (palette.className(palette.classOf(c[0], c[1], c[2])) != cluster.name) wrong += 1.0;
    }
  }
  result.conflict_share = wrong / all;
  result.pairs = pairsUnder(palette, result.classes);
  if (result.pairs.empty()) throw std::runtime_error("no two colours meet at edges of three images or more");
  return result;
}

}  // namespace vismem
