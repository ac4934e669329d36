/// @file Clusters of colours by quick shift (Vedaldi and Soatto 2008): each colour belongs to the hill of the
/// density that it stands on. Pure.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vismem {

using Rgb = std::array<std::uint8_t, 3>;

/// A colour where a distance of 1 means about as much in every direction: half the logarithm of the value,
/// and hue and saturation as a vector. Shade changes the first alone, and hue is no direction where a colour
/// is nearly grey.
Eigen::Vector3d colourFeature(const Rgb& rgb);

struct ClusterParams {
  double bin = 0.03;           ///< colours this near are one
  double bandwidth = 0.05;     ///< standard deviation of the kernel of the density
  double maximum_step = 0.15;  ///< a denser colour further away is another hill
};

struct ColourClusters {
  /// Of each sample, 0..count - 1.
  std::vector<std::size_t> cluster_of;
  std::size_t count = 0;
};

/// @param weights of the samples, as many, >= 0.
/// @return the clusters, most weight first.
ColourClusters clusterColours(const std::vector<Rgb>& samples, const std::vector<double>& weights,
                              const ClusterParams& params = {});

/// Cuts clusters that hold several groups of samples which people call different: each of their colours goes
/// to the nearest group's mean. A cluster stays whole where groups overlap.
/// @param groups indices of samples.
/// @param stray share of a group that is of no account.
ColourClusters cutBetweenGroups(ColourClusters clusters, const std::vector<Rgb>& samples,
                                const std::vector<std::vector<std::size_t>>& groups, double stray);

}  // namespace vismem
