/// @file A drawing surface for figures: smooth lines, translucent areas, text. Pure.
///
/// Positions are in pixels of the finished picture, u right and v down; it is drawn twice as large and
/// reduced at the end, which makes OpenCV's stroke letters and narrow strokes legible.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

struct Rgb {
  int r = 0;
  int g = 0;
  int b = 0;
  bool operator==(const Rgb&) const = default;
};

namespace colors {
constexpr Rgb kPaper{255, 255, 255};
constexpr Rgb kInk{38, 42, 48};
constexpr Rgb kFaintInk{120, 126, 134};
constexpr Rgb kGrid{228, 231, 235};
constexpr Rgb kTruth{30, 150, 75};
constexpr Rgb kOdometry{240, 150, 30};
constexpr Rgb kEstimate{30, 95, 215};
constexpr Rgb kMemory{205, 30, 110};
constexpr Rgb kLost{205, 45, 45};
}  // namespace colors

/// A colour for the index-th of several kinds; muted, so that paths stand out. Repeats after eight.
Rgb categoryColor(int index);

/// Spacing of a grid's lines, at least 55 px [m].
double gridStep(double px_per_m);
/// "2.5 m".
std::string metresText(double value);

enum class Align { kLeft, kCentre, kRight };

/// *Single-threaded*.
class Canvas {
 public:
  Canvas(int width, int height, Rgb paper = colors::kPaper);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Everything drawn from here on stays inside the rectangle, until release().
  void restrictTo(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  void release();

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Rgb color, double width = 1.0);
  /// @param on, off lengths of dashes and gaps [px].
  void dashedLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Rgb color, double width = 1.0,
                  double on = 6.0, double off = 5.0);
  void polyline(const std::vector<Eigen::Vector2d>& points, Rgb color, double width = 1.0);
  void rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Rgb color, double width = 1.0);
  /// @param opacity 0..1.
  void fill(const std::vector<Eigen::Vector2d>& polygon, Rgb color, double opacity = 1.0);
  void disc(const Eigen::Vector2d& centre, double radius, Rgb color, double opacity = 1.0);
  void circle(const Eigen::Vector2d& centre, double radius, Rgb color, double width = 1.0);
  /// Copies a picture (CV_8UC3, R G B) in, each of its pixels as one of the finished figure.
  void picture(const cv::Mat& picture, const Eigen::Vector2d& low);

  /// @param at left, middle or right end of the text's base line. @param size height of a capital [px].
  void text(std::string_view text, const Eigen::Vector2d& at, double size, Rgb color = colors::kInk,
            Align align = Align::kLeft, bool bold = false);
  double textWidth(std::string_view text, double size, bool bold = false) const;

  /// @return CV_8UC3 (R, G, B).
  cv::Mat finish() const;

 private:
  int width_;
  int height_;
  cv::Mat large_;
  cv::Mat target_;          ///< the part of large_ that is drawn into
  cv::Point origin_{0, 0};  ///< of target_ in large_
  cv::Point fixed(const Eigen::Vector2d& px) const;
  int thickness(double width) const;
};

}  // namespace vismem
