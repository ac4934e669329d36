#include "evaluation/figures/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/config/text_format.h"

namespace vismem {
namespace {

constexpr int kEnlarged = 2;
constexpr int kShift = 4;  // positions in sixteenths of an enlarged pixel
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kCapitalHeight = 21.0;  // of the font at scale 1 [px]

cv::Scalar scalar(Rgb color) {
  return cv::Scalar(color.r, color.g, color.b);
}

double fontScale(double size) {
  return size * kEnlarged / kCapitalHeight;
}
int fontThickness(double size, bool bold) {
  return std::max(1, static_cast<int>(std::lround(size * kEnlarged / (bold ? 7.0 : 11.0))));
}

}  // namespace

Rgb categoryColor(int index) {
  constexpr Rgb kColors[] = {{110, 120, 135}, {150, 110, 70},  {95, 140, 150},  {140, 120, 170},
                             {165, 145, 60},  {105, 145, 100}, {175, 115, 115}, {100, 115, 175}};
  return kColors[index % 8];
}

double gridStep(double px_per_m) {
  for (const double step : {0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    if (step * px_per_m >= 55.0) return step;
  }
  return 100.0;
}

std::string metresText(double value) {
  return formatted("%g m", value == 0.0 ? 0.0 : value);
}

Canvas::Canvas(int width, int height, Rgb paper)
    : width_(width),
      height_(height),
      large_(height * kEnlarged, width * kEnlarged, CV_8UC3, scalar(paper)),
      target_(large_) {}

void Canvas::restrictTo(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const cv::Rect all(0, 0, large_.cols, large_.rows);
  const cv::Point from(static_cast<int>(std::lround(low.x() * kEnlarged)),
                       static_cast<int>(std::lround(low.y() * kEnlarged)));
  const cv::Point to(static_cast<int>(std::lround(high.x() * kEnlarged)),
                     static_cast<int>(std::lround(high.y() * kEnlarged)));
  const cv::Rect part = cv::Rect(from, to) & all;
  target_ = large_(part);
  origin_ = part.tl();
}

void Canvas::release() {
  target_ = large_;
  origin_ = {0, 0};
}

cv::Point Canvas::fixed(const Eigen::Vector2d& px) const {
  constexpr double kUnit = kEnlarged * (1 << kShift);
  // Points may lie far outside: OpenCV clips them, but its integers must not overflow.
  constexpr double kLimit = 1e6;
  const auto one = [=](double value) {
    return static_cast<int>(std::lround(std::clamp(value, -kLimit, kLimit)));
  };
  return {one(px.x() * kUnit - origin_.x * (1 << kShift)), one(px.y() * kUnit - origin_.y * (1 << kShift))};
}

int Canvas::thickness(double width) const {
  return std::max(1, static_cast<int>(std::lround(width * kEnlarged)));
}

void Canvas::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Rgb color, double width) {
  cv::line(target_, fixed(a), fixed(b), scalar(color), thickness(width), cv::LINE_AA, kShift);
}

void Canvas::dashedLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Rgb color, double width,
                        double on, double off) {
  const double length = (b - a).norm();
  for (double from = 0.0; from < length; from += on + off) {
    line(a + (b - a) * from / length, a + (b - a) * std::min(length, from + on) / length, color, width);
  }
}

void Canvas::polyline(const std::vector<Eigen::Vector2d>& points, Rgb color, double width) {
  if (points.size() < 2) return;
  std::vector<cv::Point> fixed_points;
  for (const auto& p : points) fixed_points.push_back(fixed(p));
  cv::polylines(target_, fixed_points, false, scalar(color), thickness(width), cv::LINE_AA, kShift);
}

void Canvas::rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Rgb color, double width) {
  cv::rectangle(target_, fixed(low), fixed(high), scalar(color), thickness(width), cv::LINE_AA, kShift);
}

void Canvas::fill(const std::vector<Eigen::Vector2d>& polygon, Rgb color, double opacity) {
  if (polygon.size() < 3) return;
  std::vector<cv::Point> points;
  for (const auto& p : polygon) points.push_back(fixed(p));
  if (opacity >= 1.0) {
    cv::fillPoly(target_, std::vector<std::vector<cv::Point>>{points}, scalar(color), cv::LINE_AA, kShift);
    return;
  }
  cv::Mat over = target_.clone();
  cv::fillPoly(over, std::vector<std::vector<cv::Point>>{points}, scalar(color), cv::LINE_AA, kShift);
  cv::addWeighted(over, opacity, target_, 1.0 - opacity, 0.0, target_);
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius, Rgb color, double opacity) {
  std::vector<Eigen::Vector2d> polygon;
  for (int i = 0; i < 40; ++i) {
    polygon.emplace_back(centre +
                         radius * Eigen::Vector2d(std::cos(i * CV_PI / 20), std::sin(i * CV_PI / 20)));
  }
  fill(polygon, color, opacity);
}

void Canvas::circle(const Eigen::Vector2d& centre, double radius, Rgb color, double width) {
  cv::circle(target_, fixed(centre), static_cast<int>(std::lround(radius * kEnlarged * (1 << kShift))),
             scalar(color), thickness(width), cv::LINE_AA, kShift);
}

void Canvas::picture(const cv::Mat& picture, const Eigen::Vector2d& low) {
  cv::Mat enlarged;
  cv::resize(picture, enlarged, {}, kEnlarged, kEnlarged, cv::INTER_NEAREST);
  const cv::Point at(static_cast<int>(std::lround(low.x())) * kEnlarged,
                     static_cast<int>(std::lround(low.y())) * kEnlarged);
  const cv::Rect place = cv::Rect(at, enlarged.size()) & cv::Rect(0, 0, large_.cols, large_.rows);
  if (place.empty()) return;
  enlarged(cv::Rect(place.tl() - at, place.size())).copyTo(large_(place));
}

void Canvas::text(std::string_view text, const Eigen::Vector2d& at, double size, Rgb color, Align align,
                  bool bold) {
  const double width = textWidth(text, size, bold);
  const double shift = align == Align::kLeft ? 0.0 : align == Align::kCentre ? 0.5 * width : width;
  const cv::Point origin(static_cast<int>(std::lround((at.x() - shift) * kEnlarged)) - origin_.x,
                         static_cast<int>(std::lround(at.y() * kEnlarged)) - origin_.y);
  cv::putText(target_, std::string(text), origin, kFont, fontScale(size), scalar(color),
              fontThickness(size, bold), cv::LINE_AA);
}

double Canvas::textWidth(std::string_view text, double size, bool bold) const {
  int base_line = 0;
  const cv::Size extent =
      cv::getTextSize(std::string(text), kFont, fontScale(size), fontThickness(size, bold), &base_line);
  return static_cast<double>(extent.width) / kEnlarged;
}

cv::Mat Canvas::finish() const {
  cv::Mat reduced;
  cv::resize(large_, reduced, {width_, height_}, 0, 0, cv::INTER_AREA);
  return reduced;
}

}  // namespace vismem
