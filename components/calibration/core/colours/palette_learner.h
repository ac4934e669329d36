/// @file A palette from images of a place. Pure. See V3, B5.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calibration/core/colours/colour_clusters.h"
#include "calibration/core/colours/colour_region.h"
#include "common/vision/palette.h"
#include "common/vision/segment_detector.h"

namespace vismem {

struct LearntClass {
  ColorClassDefinition region;
  double side_share = 0.0;     ///< of the length beside all edges
  double surface_share = 0.0;  ///< of the pixels of even surfaces
};

struct LearntPair {
  std::string label;
  std::string a;
  std::string b;
  double share = 0.0;  ///< of the length of all edges
};

struct LearntPalette {
  std::vector<LearntClass> classes;  ///< in the order of the file; names may repeat: regions of one class
  std::vector<LearntPair> pairs;     ///< most frequent first
  /// Share of the colours of all classes that the palette gives to another class or to none.
  double conflict_share = 0.0;
  std::vector<std::string> notes;  ///< for people: what clicks contradict

  /// The palette's file.
  std::string text() const;
};

/// Collects the colours beside edges and of even surfaces, and finds their clusters. Clusters that were
/// clicked have the names of the clicks. Of the others the floor is what fills the lower part of the images,
/// if none was clicked; the rest is called after its colour. Pairs are those classes that meet at edges.
/// *Single-threaded*, deterministic.
class PaletteLearner {
 public:
  /// @param image    CV_8UC3 (R, G, B), raw pixels.
  /// @param segments detected in it, brighter side on the left.
  void addImage(const cv::Mat& image, const std::vector<RawSegment>& segments);
  /// Learns that the even surface around a pixel has this name.
  /// @param px inside the image.
  void addClick(const std::string& name, const cv::Mat& image, const Eigen::Vector2i& px);

  /// @throws std::runtime_error with what is missing, when no two classes meet at edges.
  LearntPalette learn() const;

  /// Share of the named edges, by length, that keep their name when the light changes.
  /// @param relit  the colours of an image, CV_8UC3 (R, G, B), under the other light.
  double keptNames(const Palette& palette, const std::function<cv::Mat(const cv::Mat&)>& relit) const;

 private:
  enum class Kind { kSide, kSurface, kLowSurface, kClick };
  struct Edge {
    std::array<std::size_t, 2> sides{};  ///< indices of colours_
    double length_px = 0.0;
    std::size_t image = 0;
  };
  /// What the colours of one cluster are.
  struct Cluster {
    std::string name;
    double side_px = 0.0;
    double surface = 0.0;      ///< pixels
    double low_surface = 0.0;  ///< pixels of the lower part of images
    std::vector<Rgb> colours;
    ColourRegion region;
  };

  std::size_t add(const Rgb& rgb, double weight, Kind kind);
  void addSurfaces(const cv::Mat& image);
  std::vector<Cluster> gather(const ColourClusters& clusters, std::vector<std::string>& notes) const;
  std::string nameByClicks(std::size_t cluster, const ColourClusters& clusters,
                           std::vector<std::string>& notes) const;
  void nameRest(std::vector<Cluster>& found) const;
  std::vector<LearntPair> pairsUnder(const Palette& palette, const std::vector<LearntClass>& classes) const;

  std::size_t images_ = 0;
  std::vector<Rgb> colours_;
  std::vector<double> weights_;
  std::vector<Kind> kinds_;
  std::vector<Edge> edges_;
  std::map<std::string, std::vector<std::size_t>> clicks_;  ///< indices of colours_ by name
};

}  // namespace vismem
