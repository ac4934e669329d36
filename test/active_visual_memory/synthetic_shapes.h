/// @file Remembered segments of painted shapes on a floor, with the errors that a memory has. For tests.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "common/visual_memory/primitive.h"

namespace vismem::testing {

/// A floor with shapes far enough apart to be distinguished, and what a memory holds of it.
class SyntheticShapes {
 public:
  struct Noise {
    double end_along_m = 0.012;
    double end_across_m = 0.006;
    double broken = 0.15;        ///< share of sides held in two pieces
    double hole_m = 0.15;        ///< between the pieces
    bool hide_a_corner = false;  ///< of every parallelogram: both its sides stop short
  };

  SyntheticShapes(std::uint64_t seed, const Noise& noise) : noise_(noise), random_(seed) {}

  /// A filled shape, or its sides' middle lines; corners counter-clockwise, the inside bright.
  void addParallelogram(const Eigen::Vector2d& corner, const Eigen::Vector2d& u, const Eigen::Vector2d& v);
  void addTriangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);
  /// Painted with strokes of `width_m`.
  void addArrow(const Eigen::Vector2d& tail, double heading_rad, double length_m, double head_m,
                double head_rad, double width_m);
  /// A ring of chords of about `chord_m`, as a detector delivers arcs. @param share of it that is held.
  void addCircle(const Eigen::Vector2d& centre, double radius_m, double width_m, double chord_m,
                 double share);
  void addStripe(const Segment2& middle, double width_m);
  /// Edges that belong to nothing.
  void addClutter(int count, double extent_m);

  /// One shape of each kind (two parallelograms) at random places of a floor of 8 x 6 m, and clutter.
  static SyntheticShapes room(std::uint64_t seed, const Noise& noise);

  const std::vector<MemorySegment>& segments() const { return segments_; }
  const std::vector<Primitive>& truth() const { return truth_; }

 private:
  double uniform(double low, double high);
  double normal(double sigma);
  void edge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool may_break = true);
  void stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width_m);
  void hold(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  Noise noise_;
  std::mt19937_64 random_;
  std::vector<MemorySegment> segments_;
  std::vector<Primitive> truth_;
};

/// The two are the same shape, corner by corner within `tolerance_m`.
bool isNearShape(const Primitive& found, const Primitive& truth, double tolerance_m);

}  // namespace vismem::testing
