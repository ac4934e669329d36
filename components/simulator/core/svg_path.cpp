#include "simulator/core/svg_path.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

using Eigen::Vector2d;

/// Maximum number of pieces of a curve.
constexpr int kMaxPieces = 1000;
constexpr double kLargest = 1e9;
/// A cubic curve of this angle or less follows its arc to 5e-6 of the radius.
constexpr double kArcStep_rad = std::numbers::pi / 4.0;
/// Corners with smaller turns belong to a curve: mitred under any limit.
constexpr double kSmoothTurn_cos = 0.95;

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  /// Blanks and commas only separate.
  bool done() {
    while (at_ < text_.size() &&
           (text_[at_] == ',' || std::isspace(static_cast<unsigned char>(text_[at_])) != 0)) {
      ++at_;
    }
    return at_ >= text_.size();
  }
  bool atLetter() { return !done() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0; }
  char take() { return text_[at_++]; }
  bool accept(char c) {
    if (done() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string_view word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  double number() {
    if (done()) fail("ends where a number is due");
    std::size_t begin = at_;
    if (text_[begin] == '+') ++begin;
    const std::size_t digits = begin + (begin < text_.size() && text_[begin] == '-' ? 1 : 0);
    const bool is_number =
        digits < text_.size() &&
        (std::isdigit(static_cast<unsigned char>(text_[digits])) != 0 || text_[digits] == '.');
    double value = 0.0;
    const char* last = text_.data() + text_.size();
    const auto [end, error] = is_number
                                  ? std::from_chars(text_.data() + begin, last, value)
                                  : std::from_chars_result{text_.data() + begin, std::errc::invalid_argument};
    if (error == std::errc::invalid_argument) fail("has no number");
    if (error != std::errc() || std::abs(value) > kLargest) fail("has a number out of range (at most 1e9)");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  /// A flag of an arc; it needs no separator after it.
  bool flag() {
    if (done()) fail("ends where a flag is due");
    const char c = take();
    if (c != '0' && c != '1') {
      --at_;
      fail("has no flag (0 or 1)");
    }
    return c == '1';
  }
  Vector2d point() {
    const double x = number();
    return {x, number()};
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(what + " at character " + std::to_string(at_ + 1));
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

SvgCurve lineTo(const Vector2d& end) {
  return {end, end, end, true};
}

/// An arc of an ellipse from p to `end` as SVG says it (appendix "Elliptical arc implementation notes").
void addArc(std::vector<SvgCurve>& curves, const Vector2d& p, Vector2d radii, double turned_deg, bool large,
            bool sweep, const Vector2d& end) {
  if (p == end) return;
  radii = radii.cwiseAbs();
  if (!(radii.minCoeff() > 0.0)) {
    curves.push_back(lineTo(end));
    return;
  }
  const Eigen::Rotation2Dd R(turned_deg * std::numbers::pi / 180.0);
  const Vector2d half = R.inverse() * (0.5 * (p - end));
  const double excess = half.cwiseQuotient(radii).squaredNorm();
  if (excess > 1.0) radii *= std::sqrt(excess);
  // On the unit circle: the middle lies on the bisector of both ends.
  const Vector2d h = half.cwiseQuotient(radii);
  const double squared = h.squaredNorm();
  double off = std::sqrt(std::max(0.0, 1.0 / squared - 1.0));
  if (large == sweep) off = -off;
  const Vector2d middle = off * Vector2d(h.y(), -h.x());
  const double from = std::atan2(h.y() - middle.y(), h.x() - middle.x());
  double angle = std::atan2(-h.y() - middle.y(), -h.x() - middle.x()) - from;
  if (sweep && angle < 0.0) angle += 2.0 * std::numbers::pi;
  if (!sweep && angle > 0.0) angle -= 2.0 * std::numbers::pi;
  if (!std::isfinite(angle) || !radii.allFinite()) {
    curves.push_back(lineTo(end));
    return;
  }
  const Vector2d center = R * middle.cwiseProduct(radii) + 0.5 * (p + end);
  const auto at = [&](const Vector2d& unit) -> Vector2d { return center + R * unit.cwiseProduct(radii); };
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / kArcStep_rad - 1e-9)));
  const double step = angle / count;
  const double k = 4.0 / 3.0 * std::tan(0.25 * step);
  for (int i = 0; i < count; ++i) {
    const double a = from + i * step;
    const double b = a + step;
    const Vector2d ua(std::cos(a), std::sin(a));
    const Vector2d ub(std::cos(b), std::sin(b));
    curves.push_back({at(ua + k * turned90(ua)), at(ub - k * turned90(ub)), i + 1 == count ? end : at(ub)});
  }
}

class PathReader {
 public:
  explicit PathReader(std::string_view d) : in_(d) {}

  SvgPath read() {
    char command = '\0';
    while (!in_.done()) {
      if (in_.atLetter()) {
        command = in_.take();
      } else if (command == '\0' || command == 'Z' || command == 'z') {
        in_.fail("has no command");
      }
      if (path_.empty() && command != 'M' && command != 'm') in_.fail("does not begin with M");
      run(command);
      // Further points of a move are lines.
      if (command == 'M') command = 'L';
      if (command == 'm') command = 'l';
    }
    return std::move(path_);
  }

 private:
  /// After a close command the next subpath begins at the start of the last one.
  std::vector<SvgCurve>& curves() {
    if (path_.back().closed) path_.push_back({here_, {}, false});
    return path_.back().curves;
  }
  void add(const SvgCurve& curve) {
    curves().push_back(curve);
    here_ = curve.end;
  }
  void addQuadratic(const Vector2d& control, const Vector2d& end) {
    quadratic_ = control;
    add({here_ + 2.0 / 3.0 * (control - here_), end + 2.0 / 3.0 * (control - end), end});
  }

  void run(char command) {
    const bool relative = std::islower(static_cast<unsigned char>(command)) != 0;
    const Vector2d base = relative ? here_ : Vector2d(0, 0);
    const auto point = [&]() -> Vector2d { return base + in_.point(); };
    std::optional<Vector2d> cubic;  // the last control point, for a smooth curve behind
    std::optional<Vector2d> quadratic;
    switch (std::toupper(static_cast<unsigned char>(command))) {
      case 'M':
        here_ = point();
        path_.push_back({here_, {}, false});
        break;
      case 'Z':
        path_.back().closed = true;
        here_ = path_.back().start;
        break;
      case 'L':
        add(lineTo(point()));
        break;
      case 'H':
        add(lineTo({base.x() + in_.number(), here_.y()}));
        break;
      case 'V':
        add(lineTo({here_.x(), base.y() + in_.number()}));
        break;
      case 'C': {
        const Vector2d control1 = point();
        cubic = point();
        add({control1, *cubic, point()});
        break;
      }
      case 'S': {
        const Vector2d control1 = cubic_ ? Vector2d(2.0 * here_ - *cubic_) : here_;
        cubic = point();
        add({control1, *cubic, point()});
        break;
      }
      case 'Q':
        quadratic = point();
        addQuadratic(*quadratic, point());
        break;
      case 'T':
        quadratic = quadratic_ ? Vector2d(2.0 * here_ - *quadratic_) : here_;
        addQuadratic(*quadratic, point());
        break;
      case 'A': {
        const Vector2d radii = in_.point();
        const double turned_deg = in_.number();
        const bool large = in_.flag();
        const bool sweep = in_.flag();
        const Vector2d end = point();
        addArc(curves(), here_, radii, turned_deg, large, sweep, end);
        here_ = end;
        break;
      }
      default:
        in_.fail(std::string("has a command that is none of M L H V C S Q T A Z before"));
    }
    cubic_ = cubic;
    quadratic_ = quadratic;
  }

  Scanner in_;
  SvgPath path_;
  Vector2d here_ = Vector2d::Zero();
  std::optional<Vector2d> cubic_;
  std::optional<Vector2d> quadratic_;
};

Eigen::Affine2d transformCalled(std::string_view name, const std::vector<double>& n, const Scanner& in) {
  const auto takes = [&](std::initializer_list<std::size_t> counts) {
    if (std::find(counts.begin(), counts.end(), n.size()) != counts.end()) return;
    in.fail(std::string(name) + " has " + std::to_string(n.size()) + " numbers, before");
  };
  constexpr double kDegree = std::numbers::pi / 180.0;
  Eigen::Affine2d T = Eigen::Affine2d::Identity();
  if (name == "matrix") {
    takes({6});
    T.matrix() << n[0], n[2], n[4], n[1], n[3], n[5], 0, 0, 1;
  } else if (name == "translate") {
    takes({1, 2});
    T.translation() = Vector2d(n[0], n.size() > 1 ? n[1] : 0.0);
  } else if (name == "scale") {
    takes({1, 2});
    T.linear().diagonal() = Vector2d(n[0], n.back());
  } else if (name == "rotate") {
    takes({1, 3});
    const Vector2d center = n.size() == 3 ? Vector2d(n[1], n[2]) : Vector2d(0, 0);
    T = Eigen::Translation2d(center) * Eigen::Rotation2Dd(n[0] * kDegree) * Eigen::Translation2d(-center);
  } else if (name == "skewX") {
    takes({1});
    T.matrix()(0, 1) = std::tan(n[0] * kDegree);
  } else if (name == "skewY") {
    takes({1});
    T.matrix()(1, 0) = std::tan(n[0] * kDegree);
  } else {
    in.fail("is none of matrix, translate, scale, rotate, skewX, skewY before");
  }
  return T;
}

/// Reorders a polygon so that all of a stroke's polygons have one sense of rotation.
SvgPoints counterClockwise(SvgPoints polygon) {
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    area += cross2(a, b);
  }
  if (area < 0.0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

}  // namespace

SvgPath parseSvgPath(std::string_view d) {
  return PathReader(d).read();
}

Eigen::Affine2d parseSvgTransform(std::string_view text) {
  Scanner in(text);
  Eigen::Affine2d T = Eigen::Affine2d::Identity();
  while (!in.done()) {
    if (!in.atLetter()) in.fail("has no transform");
    const std::string_view name = in.word();
    if (!in.accept('(')) in.fail("has no ( behind " + std::string(name));
    std::vector<double> numbers;
    while (!in.accept(')')) numbers.push_back(in.number());
    T = T * transformCalled(name, numbers, in);
  }
  if (!T.matrix().allFinite()) in.fail("is not finite");
  return T;
}

std::vector<double> parseSvgNumbers(std::string_view text) {
  Scanner in(text);
  std::vector<double> result;
  while (!in.done()) result.push_back(in.number());
  return result;
}

SvgPath svgPolyline(const SvgPoints& points, bool closed) {
  if (points.empty()) return {};
  SvgSubpath result{points.front(), {}, closed};
  for (std::size_t i = 1; i < points.size(); ++i) result.curves.push_back(lineTo(points[i]));
  return {result};
}

SvgPath svgEllipse(const Vector2d& center, const Vector2d& radii) {
  const Vector2d side(radii.x(), 0.0);
  SvgSubpath result{center + side, {}, true};
  addArc(result.curves, center + side, radii, 0.0, false, true, center - side);
  addArc(result.curves, center - side, radii, 0.0, false, true, center + side);
  return {result};
}

SvgPath svgRectangle(const Vector2d& corner, const Vector2d& size, const Vector2d& radii) {
  const Vector2d far = corner + size;
  if (!(radii.minCoeff() > 0.0)) {
    return svgPolyline({corner, {far.x(), corner.y()}, far, {corner.x(), far.y()}}, true);
  }
  const Vector2d r = radii.cwiseMin(0.5 * size);
  SvgSubpath result{{corner.x() + r.x(), corner.y()}, {}, true};
  const auto side = [&](const Vector2d& end, const Vector2d& behind_corner) {
    result.curves.push_back(lineTo(end));
    addArc(result.curves, end, r, 0.0, false, true, behind_corner);
  };
  side({far.x() - r.x(), corner.y()}, {far.x(), corner.y() + r.y()});
  side({far.x(), far.y() - r.y()}, {far.x() - r.x(), far.y()});
  side({corner.x() + r.x(), far.y()}, {corner.x(), far.y() - r.y()});
  side({corner.x(), corner.y() + r.y()}, result.start);
  return {result};
}

SvgPoints flattenSvg(const SvgSubpath& subpath, const Eigen::Affine2d& T, double flatness) {
  SvgPoints points{subpath.start};
  const auto add = [&](const Vector2d& p) {
    if (p != points.back()) points.push_back(p);
  };
  for (const SvgCurve& curve : subpath.curves) {
    if (curve.straight) {
      add(curve.end);
      continue;
    }
    const Vector2d start = points.back();
    // Wang's bound on the distance of a cubic curve from its chords.
    const Vector2d bend1 = T.linear() * (start - 2.0 * curve.control1 + curve.control2);
    const Vector2d bend2 = T.linear() * (curve.control1 - 2.0 * curve.control2 + curve.end);
    const double bend = std::max(bend1.norm(), bend2.norm());
    const double wanted = std::ceil(std::sqrt(0.75 * bend / flatness));
    const int pieces = wanted >= 1.0 ? static_cast<int>(std::min<double>(wanted, kMaxPieces)) : 1;
    for (int i = 1; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      const double s = 1.0 - t;
      add(i == pieces ? curve.end
                      : Vector2d(s * s * s * start + 3.0 * s * s * t * curve.control1 +
                                 3.0 * s * t * t * curve.control2 + t * t * t * curve.end));
    }
  }
  while (subpath.closed && points.size() > 1 && points.back() == points.front()) points.pop_back();
  return points;
}

std::vector<SvgPoints> strokeSvg(const SvgPoints& line, bool closed, const SvgStroke& stroke) {
  std::vector<SvgPoints> result;
  if (line.size() < 2 || !(stroke.width > 0.0)) return result;
  const double half = 0.5 * stroke.width;
  const bool ring = closed && line.size() > 2;
  const std::size_t sides = ring ? line.size() : line.size() - 1;
  std::vector<Vector2d> along;
  for (std::size_t i = 0; i < sides; ++i) {
    const Vector2d& a = line[i];
    const Vector2d& b = line[(i + 1) % line.size()];
    along.emplace_back((b - a).normalized());
    const Vector2d n = half * turned90(along[i]);
    result.push_back({a - n, b - n, b + n, a + n});
  }
  for (std::size_t i = 0; i < (ring ? sides : sides - 1); ++i) {
    const Vector2d& before = along[i];
    const Vector2d& after = along[(i + 1) % sides];
    const Vector2d& corner = line[(i + 1) % line.size()];
    const double cosine = before.dot(after);
    const double cross = cross2(before, after);
    if (std::abs(cross) < 1e-12) continue;
    const double outside = cross > 0.0 ? -half : half;
    const Vector2d o1 = outside * turned90(before);
    const Vector2d o2 = outside * turned90(after);
    SvgPoints piece{corner, corner + o1};
    // The length of a miter over the stroke's width is 1 / cos(half the turn).
    const double pointed = std::sqrt(2.0 / std::max(1.0 + cosine, 1e-12));
    if (cosine >= kSmoothTurn_cos || pointed <= stroke.miter_limit) {
      piece.push_back(corner + (o1 + o2) / (1.0 + cosine));
    }
    piece.push_back(corner + o2);
    result.push_back(counterClockwise(std::move(piece)));
  }
  return result;
}

}  // namespace vismem
