/// @file Straight runs of edge points, fitted by total least squares. Pure. SPEC V1.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/edge_points.h"
#include "common/vision/segment_detector.h"

namespace vismem {

/// A straight run of edge points, the brighter side on the left.
struct LineRun {
  Segment2 px;
  double points = 0.0;  ///< on the line
};

/// Follows the links of edge points and cuts them into straight runs; the point that breaks a run begins the
/// next one. Keeps its work space.
class LineRunFinder {
 public:
  explicit LineRunFinder(const SolisParams& params) : params_(params) {}
  /// @param runs replaced.
  void find(const EdgePointFinder& edges, std::vector<LineRun>& runs);

 private:
  /// Over points: of their places and products of these.
  struct Sums {
    double n = 0.0, xy = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;

    void add(double px, double py) {
      n += 1.0;
      xy += px * py;
      x += px;
      y += py;
      xx += px * px;
      yy += py * py;
    }
    Sums& operator+=(const Sums& more) {
      n += more.n;
      xy += more.xy;
      x += more.x;
      y += more.y;
      xx += more.xx;
      yy += more.yy;
      return *this;
    }
    friend Sums operator-(const Sums& a, const Sums& b) {
      return {a.n - b.n, a.xy - b.xy, a.x - b.x, a.y - b.y, a.xx - b.xx, a.yy - b.yy};
    }
    /// Whether the points' variance about their line is at most `limit`: without roots and divisions.
    bool thin(double limit) const {
      const double shift = n * n * limit;
      const double a = n * xx - x * x - shift;
      const double b = n * xy - x * y;
      const double c = n * yy - y * y - shift;
      // The smaller eigenvalue is under the limit, unless both of the shifted matrix are positive.
      return (static_cast<int>(a + c <= 0.0) | static_cast<int>(a * c <= b * b)) != 0;
    }
  };
  struct Place {
    double x = 0.0, y = 0.0;  // relative to where the chain begins
  };
  struct Gradient {
    std::int16_t x = 0, y = 0;
  };
  class Line;
  class Fit;

  int keepLong(const EdgePointFinder& edges, std::int32_t* starts, int count) const;
  int follow(const EdgePointFinder& edges, std::int32_t first, bool ring);
  void split(int count, std::vector<LineRun>& runs);
  template <int kStep>
  int extend(Sums& run, int from, int stop);
  void leaveOut(Sums& run, int begin, int end) const;
  void emit(Sums& run, int first, int last, std::vector<LineRun>& runs);
  int countAgreeing(const Line& line, int first, int last, bool backward);

  SolisParams params_;
  double x0_ = 0.0;  // where the chain begins: places are relative to it
  double y0_ = 0.0;
  Room<std::int32_t> starts_;  // of chains
  Room<std::int32_t> tops_;    // of rings, maybe
  Room<std::uint8_t> used_;
  // The points of one chain.
  Room<Place> place_;
  Room<Gradient> gradient_;
  Room<Sums> sums_;            // over the points before each
  Room<std::int32_t> strays_;  // of the run
  int stray_count_ = 0;
  Room<std::int32_t> agrees_;
};

}  // namespace vismem
