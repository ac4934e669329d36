#include "calibration/core/colours/colour_clusters.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "common/vision/palette.h"

namespace vismem {
namespace {

constexpr double kDarkest_percent = 4.0;  // below it hue is noise, and values are alike

struct Bin {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  double density = 0.0;
  std::size_t parent = 0;

  Eigen::Vector3d mean() const { return sum / weight; }
};

void findDensities(std::vector<Bin>& bins, double bandwidth) {
  const double scale = 0.5 / (bandwidth * bandwidth);
  for (Bin& bin : bins) {
    for (const Bin& other : bins)
      bin.density += other.weight * std::exp(-scale * (bin.mean() - other.mean()).squaredNorm());
  }
}

/// The nearest bin of greater density; itself on top of a hill.
void climb(std::vector<Bin>& bins, double maximum_step) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].parent = i;
    double nearest = maximum_step * maximum_step;
    for (std::size_t j = 0; j < bins.size(); ++j) {
      const bool is_denser =
          bins[j].density > bins[i].density || (bins[j].density == bins[i].density && j < i);
      const double distance = (bins[i].mean() - bins[j].mean()).squaredNorm();
      if (!is_denser || distance >= nearest) continue;
      nearest = distance;
      bins[i].parent = j;
    }
  }
}

/// Means of the groups within one cluster.
class GroupMeans {
 public:
  void add(const std::vector<Eigen::Vector3d>& colours) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& colour : colours) sum += colour;
    means_.emplace_back(sum / static_cast<double>(colours.size()));
    groups_.push_back(colours);
  }
  std::size_t size() const { return means_.size(); }
  std::size_t nearest(const Eigen::Vector3d& colour) const {
    const auto distance = [&](const Eigen::Vector3d& mean) { return (mean - colour).squaredNorm(); };
    const auto best = std::min_element(means_.begin(), means_.end(), [&](const auto& a, const auto& b) {
      return distance(a) < distance(b);
    });
    return static_cast<std::size_t>(best - means_.begin());
  }
  bool areApart(double stray) const {
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const auto off = std::count_if(groups_[k].begin(), groups_[k].end(),
                                     [&](const Eigen::Vector3d& colour) { return nearest(colour) != k; });
      if (static_cast<double>(off) > stray * static_cast<double>(groups_[k].size())) return false;
    }
    return true;
  }

 private:
  std::vector<Eigen::Vector3d> means_;
  std::vector<std::vector<Eigen::Vector3d>> groups_;
};

}  // namespace

Eigen::Vector3d colourFeature(const Rgb& rgb) {
  const ColorValues hsv = colorValues(rgb[0], rgb[1], rgb[2]);
  const double value = std::max(hsv.value_percent, kDarkest_percent);
  const double chroma =
      0.01 * hsv.saturation_percent * std::min(1.0, hsv.value_percent / (3.0 * kDarkest_percent));
  const double hue = hsv.hue_deg * std::numbers::pi / 180.0;
  return {0.3 * std::log(0.01 * value), chroma * std::cos(hue), chroma * std::sin(hue)};
}

ColourClusters clusterColours(const std::vector<Rgb>& samples, const std::vector<double>& weights,
                              const ClusterParams& params) {
  std::map<std::array<int, 3>, std::size_t> index;
  std::vector<Bin> bins;
  std::vector<std::size_t> bin_of(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d feature = colourFeature(samples[i]);
    std::array<int, 3> key{};
    for (int k = 0; k < 3; ++k) key[k] = static_cast<int>(std::lround(feature[k] / params.bin));
    const auto [found, is_new] = index.try_emplace(key, bins.size());
    if (is_new) bins.emplace_back();
    bin_of[i] = found->second;
    constexpr double kLeastWeight = 1e-9;
    const double weight = std::max(weights[i], kLeastWeight);
    bins[bin_of[i]].sum += weight * feature;
    bins[bin_of[i]].weight += weight;
  }
  findDensities(bins, params.bandwidth);
  climb(bins, params.maximum_step);

  std::map<std::size_t, double> hills;  // weight of each top
  std::vector<std::size_t> top(bins.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    top[i] = i;
    while (bins[top[i]].parent != top[i]) top[i] = bins[top[i]].parent;
    hills[top[i]] += bins[i].weight;
  }
  std::vector<std::size_t> order;
  for (const auto& [hill, weight] : hills) order.push_back(hill);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(-hills.at(a), a) < std::pair(-hills.at(b), b);
  });
  std::map<std::size_t, std::size_t> rank;
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  ColourClusters result;
  result.count = order.size();
  for (const std::size_t bin : bin_of) result.cluster_of.push_back(rank.at(top[bin]));
  return result;
}

ColourClusters cutBetweenGroups(ColourClusters clusters, const std::vector<Rgb>& samples,
                                const std::vector<std::vector<std::size_t>>& groups, double stray) {
  const std::size_t count = clusters.count;
  for (std::size_t cluster = 0; cluster < count; ++cluster) {
    GroupMeans means;
    for (const auto& group : groups) {
      std::vector<Eigen::Vector3d> here;
      for (const std::size_t i : group) {
        if (clusters.cluster_of[i] == cluster) here.push_back(colourFeature(samples[i]));
      }
      if (static_cast<double>(here.size()) > stray * static_cast<double>(group.size())) means.add(here);
    }
    if (means.size() < 2 || !means.areApart(stray)) continue;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (clusters.cluster_of[i] != cluster) continue;
      const std::size_t nearest = means.nearest(colourFeature(samples[i]));
      if (nearest > 0) clusters.cluster_of[i] = clusters.count + nearest - 1;
    }
    clusters.count += means.size() - 1;
  }
  return clusters;
}

}  // namespace vismem
