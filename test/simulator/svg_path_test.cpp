// Outlines of SVG: commands, accuracy of straight pieces, strokes.
#include "simulator/core/svg_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>

#include "simulator/core/svg_style.h"

namespace vismem {
namespace {

using Eigen::Affine2d;
using Eigen::Vector2d;

double distanceToLineOf(const Vector2d& p, const SvgPoints& points) {
  double best = 1e18;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vector2d d = points[i + 1] - points[i];
    const double t = std::clamp((p - points[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - points[i] - t * d).norm());
  }
  return best;
}

SvgPoints pointsOf(const std::string& d, double flatness = 0.001) {
  const SvgPath path = parseSvgPath(d);
  EXPECT_EQ(path.size(), 1U) << d;
  return flattenSvg(path.front(), Affine2d::Identity(), flatness);
}

void expectPoints(const SvgPoints& points, const SvgPoints& expected, const std::string& what) {
  ASSERT_EQ(points.size(), expected.size()) << what;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((points[i] - expected[i]).norm(), 1e-9) << what << ", point " << i;
  }
}

TEST(SvgPath, TheSameSquareInEveryNotation) {
  const SvgPoints square{{1, 2}, {4, 2}, {4, 5}, {1, 5}};
  for (const char* d : {"M1,2 L4,2 L4,5 L1,5 Z", "M1 2 4 2 4 5 1 5z", "m1,2 l3,0 l0,3 l-3,0 z",
                        "m1 2 3 0 0 3-3 0z", "M1 2H4V5H1Z", "M 1 2 h3v3h-3 z", "M1 2h1h2v3h-3v-3",
                        "M1,2L4,2,4,5,1,5,1,2z", "M+1e0 2.0L4. 2 L4 .5e1 L10e-1,5z"}) {
    SvgPoints points = pointsOf(d);
    // Collinear and closing points are not corners.
    std::erase_if(points, [](const Vector2d& p) { return p == Vector2d(2, 2); });
    if (points.back() == points.front()) points.pop_back();
    expectPoints(points, square, d);
  }
}

TEST(SvgPath, NumbersRunTogetherAsDrawingProgramsWriteThem) {
  expectPoints(pointsOf("M.5.5-1-.5 0 0"), {{0.5, 0.5}, {-1, -0.5}, {0, 0}},
               "decimal points and signs separate");
  // The flags of an arc need no separator: radius 1, half a circle from (0, 0) to (2, 0).
  const SvgPoints arc = pointsOf("M0 0a1 1 0 012 0", 1e-6);
  EXPECT_LT((arc.back() - Vector2d(2, 0)).norm(), 1e-12);
  for (const auto& p : arc) EXPECT_NEAR((p - Vector2d(1, 0)).norm(), 1.0, 1e-5);
  EXPECT_LT(arc[arc.size() / 2].y(), -0.99) << "sweep: clockwise on a page whose y is down, over the top";
}

TEST(SvgPath, SubpathsBeginWhereTheLastOneClosed) {
  const SvgPath path = parseSvgPath("M1 1h1v1z l-1 0 M5 5h1");
  ASSERT_EQ(path.size(), 3U);
  EXPECT_TRUE(path[0].closed);
  EXPECT_EQ(path[1].start, Vector2d(1, 1));
  EXPECT_EQ(path[1].curves[0].end, Vector2d(0, 1));
  EXPECT_FALSE(path[1].closed);
  EXPECT_EQ(path[2].start, Vector2d(5, 5));
}

TEST(SvgPath, SmoothCurvesMirrorTheLastControlPoint) {
  expectPoints(pointsOf("M0 0C0 1 1 2 2 2S4 3 4 4"), pointsOf("M0 0C0 1 1 2 2 2C3 2 4 3 4 4"), "S behind C");
  expectPoints(pointsOf("M0 0S4 3 4 4"), pointsOf("M0 0C0 0 4 3 4 4"), "S behind M");
  expectPoints(pointsOf("M0 0Q1 2 2 0T4 0T6 0"), pointsOf("M0 0Q1 2 2 0Q3-2 4 0Q5 2 6 0"),
               "T behind Q and T");
  expectPoints(pointsOf("m1 1q1 2 2 0t2 0"), pointsOf("M1 1Q2 3 3 1T5 1"), "relative ones");
  expectPoints(pointsOf("M0 0Q1 2 2 0C3 0 3 0 4 0T6 0"), pointsOf("M0 0Q1 2 2 0C3 0 3 0 4 0Q4 0 6 0"),
               "T behind C");
}

TEST(SvgPath, CurvesAsStraightPiecesAreWithinTheFlatnessAsTheTransformSeesThem) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> anywhere(-10, 10);
  const auto point = [&] { return Vector2d(anywhere(engine), anywhere(engine)); };
  for (int i = 0; i < 200; ++i) {
    SvgSubpath subpath{point(), {}, false};
    const SvgCurve curve{point(), point(), point()};
    subpath.curves.push_back(curve);
    Affine2d T = Affine2d::Identity();
    T.linear() << anywhere(engine), anywhere(engine), anywhere(engine), anywhere(engine);
    const double flatness = std::pow(10.0, -1.0 - i % 3);
    SvgPoints seen;
    for (const auto& p : flattenSvg(subpath, T, flatness)) seen.emplace_back(T * p);
    for (double t = 0; t <= 1.0; t += 0.001) {
      const double s = 1 - t;
      const Vector2d p = s * s * s * subpath.start + 3 * s * s * t * curve.control1 +
                         3 * s * t * t * curve.control2 + t * t * t * curve.end;
      ASSERT_LE(distanceToLineOf(T * p, seen), flatness * 1.0001) << "curve " << i << " at " << t;
    }
  }
}

TEST(SvgPath, ArcsLieOnTheirEllipseAndGoTheWayTheirFlagsSay) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> anywhere(-5, 5);
  std::uniform_real_distribution<double> radius(0.2, 8);
  for (int i = 0; i < 400; ++i) {
    const Vector2d from(anywhere(engine), anywhere(engine));
    const Vector2d to(anywhere(engine), anywhere(engine));
    Vector2d radii(radius(engine), radius(engine));
    const double turned_deg = 36.0 * anywhere(engine);
    const bool large = i % 2 == 1;
    const bool sweep = i / 2 % 2 == 1;
    std::ostringstream d;
    d.precision(17);
    d << "M" << from.x() << " " << from.y() << "A" << radii.x() << " " << radii.y() << " " << turned_deg
      << " " << large << " " << sweep << " " << to.x() << " " << to.y();
    const SvgPoints points = pointsOf(d.str(), 1e-5);
    EXPECT_EQ(points.back(), to);
    // In the coordinates of the unit circle; radii too small for the ends grow together.
    const Eigen::Rotation2Dd R(-turned_deg * std::numbers::pi / 180);
    const Vector2d half = (R * (0.5 * (from - to))).cwiseQuotient(radii);
    if (half.norm() > 1.0) radii *= half.norm();
    SvgPoints unit;
    for (const auto& p : points) unit.emplace_back((R * p).cwiseQuotient(radii));
    // The middle: at distance 1 of three of them.
    const Vector2d u = unit[unit.size() / 3] - unit[0];
    const Vector2d v = unit[2 * unit.size() / 3] - unit[0];
    Eigen::Matrix2d A;
    A << u.transpose(), v.transpose();
    const Vector2d middle =
        unit[0] + A.fullPivLu().solve(Vector2d(0.5 * u.squaredNorm(), 0.5 * v.squaredNorm()));
    double turned = 0;
    for (std::size_t k = 0; k < unit.size(); ++k) {
      ASSERT_NEAR((unit[k] - middle).norm(), 1.0, 2e-3) << d.str();
      if (k == 0) continue;
      const Vector2d a = unit[k - 1] - middle;
      const Vector2d b = unit[k] - middle;
      turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    EXPECT_EQ(turned > 0, sweep) << d.str();
    if (half.norm() < 0.99) {
      EXPECT_EQ(std::abs(turned) > std::numbers::pi, large) << d.str();
    }
  }
}

TEST(SvgPath, ArcsWithoutRadiusAreLinesAndWithoutLengthNothing) {
  expectPoints(pointsOf("M0 0A0 5 0 1 1 4 0"), {{0, 0}, {4, 0}}, "no radius");
  expectPoints(pointsOf("M0 0L1 0A5 5 0 1 1 1 0L2 0"), {{0, 0}, {1, 0}, {2, 0}}, "no length");
}

TEST(SvgPath, SaysWhatIsWrongAndWhere) {
  const auto messageOf = [](const std::string& d) -> std::string {
    try {
      parseSvgPath(d);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(messageOf(""), "no error");
  EXPECT_EQ(messageOf("L1 2"), "does not begin with M at character 2");
  EXPECT_EQ(messageOf("1 2"), "has no command at character 1");
  EXPECT_EQ(messageOf("M1 2 L3"), "ends where a number is due at character 8");
  EXPECT_EQ(messageOf("M1 2 X3 4"),
            "has a command that is none of M L H V C S Q T A Z before at character 7");
  EXPECT_EQ(messageOf("M1 nan"), "has no number at character 4");
  EXPECT_EQ(messageOf("M1 inf"), "has no number at character 4");
  EXPECT_EQ(messageOf("M1 1e99"), "has a number out of range (at most 1e9) at character 4");
  EXPECT_EQ(messageOf("M0 0A1 1 0 2 0 1 1"), "has no flag (0 or 1) at character 12");
  EXPECT_EQ(messageOf("M0 0Z 4"), "has no command at character 7");
}

TEST(SvgTransform, AListIsAppliedFromItsLast) {
  const Vector2d p(3, 4);
  const auto at = [&](const char* text) -> Vector2d { return parseSvgTransform(text) * p; };
  EXPECT_LT((at("") - p).norm(), 1e-12);
  EXPECT_LT((at("translate(1)") - Vector2d(4, 4)).norm(), 1e-12);
  EXPECT_LT((at("translate(1 , 2) scale(2)") - Vector2d(7, 10)).norm(), 1e-12);
  EXPECT_LT((at("scale(2 3),translate(1,2)") - Vector2d(8, 18)).norm(), 1e-12);
  EXPECT_LT((at("rotate(90)") - Vector2d(-4, 3)).norm(), 1e-12);
  EXPECT_LT((at("rotate(90 3 3)") - Vector2d(2, 3)).norm(), 1e-12);
  EXPECT_LT((at("matrix(1 2 3 4 5 6)") - Vector2d(1 * 3 + 3 * 4 + 5, 2 * 3 + 4 * 4 + 6)).norm(), 1e-12);
  EXPECT_LT((at("skewX(45)") - Vector2d(7, 4)).norm(), 1e-12);
  EXPECT_LT((at("skewY(45)") - Vector2d(3, 7)).norm(), 1e-12);
  for (const char* wrong :
       {"rotate(1 2)", "rotate", "turn(3)", "scale(1", "scale(1,,)x", "matrix(1)", "skewX()"}) {
    EXPECT_THROW(parseSvgTransform(wrong), std::invalid_argument) << wrong;
  }
}

/// Points on a grid that lie in any of the convex polygons.
std::vector<bool> coverage(const std::vector<SvgPoints>& polygons, const SvgPoints& grid) {
  std::vector<bool> result;
  for (const auto& p : grid) {
    bool covered = false;
    for (const auto& polygon : polygons) {
      bool inside = true;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d d = polygon[(i + 1) % polygon.size()] - polygon[i];
        inside = inside && d.x() * (p - polygon[i]).y() - d.y() * (p - polygon[i]).x() >= -1e-12;
      }
      covered = covered || inside;
    }
    result.push_back(covered);
  }
  return result;
}

TEST(SvgStrokes, PaintABandWithMitredCorners) {
  // A right angle of two arms 4 long, 2 wide: area by counting points of a fine grid.
  SvgPoints grid;
  for (double x = -3.05; x < 8; x += 0.1) {
    for (double y = -3.05; y < 8; y += 0.1) grid.emplace_back(x, y);
  }
  const auto area = [&](double miter_limit) {
    const auto covered = coverage(strokeSvg({{4, 0}, {0, 0}, {0, 4}}, false, {2.0, miter_limit}), grid);
    return 0.01 * static_cast<double>(std::count(covered.begin(), covered.end(), true));
  };
  // Two arms of 4 x 2 share a square of 1; the corner outside is another square of 1, or half of it where a
  // miter of 1.41 widths is beyond the limit.
  EXPECT_NEAR(area(4.0), 16.0, 0.2);
  EXPECT_NEAR(area(1.0), 15.5, 0.2);
  // A point sharper than the limit is cut off: 4 is reached at 29 degrees.
  const auto tip = [](double limit) {
    double farthest = 0;
    for (const auto& polygon : strokeSvg({{10, 1}, {0, 0}, {10, -1}}, false, {1.0, limit})) {
      for (const auto& p : polygon) farthest = std::max(farthest, -p.x());
    }
    return farthest;
  };
  EXPECT_LT(tip(4.0), 0.6);
  EXPECT_NEAR(tip(20.0), 0.5 / std::sin(std::atan(0.1)), 1e-6);
  EXPECT_TRUE(strokeSvg({{0, 0}}, false, {}).empty());
}

TEST(SvgStyle, ColoursAndLengths) {
  const auto color = [](const char* text) {
    const auto paint = parseSvgPaint(text);
    return paint && paint->color ? std::vector<int>(paint->color->begin(), paint->color->end())
                                 : std::vector<int>{};
  };
  using Rgb = std::vector<int>;
  EXPECT_EQ(color("#1aF"), (Rgb{0x11, 0xaa, 0xff}));
  EXPECT_EQ(color(" #102030 "), (Rgb{16, 32, 48}));
  EXPECT_EQ(color("rgb(1, 2,3)"), (Rgb{1, 2, 3}));
  EXPECT_EQ(color("rgb(100% 0% 50%)"), (Rgb{255, 0, 128}));
  EXPECT_EQ(color("Orange"), (Rgb{0xff, 0xa5, 0}));
  for (const char* unseen : {"none", "transparent"}) {
    ASSERT_TRUE(parseSvgPaint(unseen)) << unseen;
    EXPECT_FALSE(parseSvgPaint(unseen)->color) << unseen;
  }
  for (const char* wrong :
       {"", "#12", "#xyz", "rgb(1,2)", "rgb(1,2,x)", "rgb(1,2,3,4)", "reddish", "hsl(1,2,3)", "url(#a",
        "rgb(", "rgba(1,2,3,0.9)", "#12345610", "currentColor", "ForestGreen"}) {
    EXPECT_FALSE(parseSvgPaint(wrong)) << wrong;
  }

  EXPECT_DOUBLE_EQ(parseSvgLength("1in")->units(0), 96.0);
  EXPECT_DOUBLE_EQ(parseSvgLength("2.54cm")->units(0), 96.0);
  EXPECT_DOUBLE_EQ(parseSvgLength("25.4mm")->units(0), 96.0);
  EXPECT_DOUBLE_EQ(parseSvgLength("72pt")->units(0), 96.0);
  EXPECT_DOUBLE_EQ(parseSvgLength("50%")->units(300), 150.0);
  EXPECT_DOUBLE_EQ(parseSvgLength(" -3e1 ")->units(0), -30.0);
  for (const char* wrong : {"", "mm", "nan", "inf", "1e400", "1 2", "3furlongs", "-", "--1"}) {
    EXPECT_FALSE(parseSvgLength(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace vismem
