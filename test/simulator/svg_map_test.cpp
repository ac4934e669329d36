// Maps of drawings: edges, their ends and units, and the messages for invalid files.
#include "simulator/core/svg_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <random>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using Eigen::Vector2d;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kSource = VISMEM_SOURCE_DIR;

const Palette& palette() {
  static const Palette result = Palette::parse(
      "class.floor = value 0..30\n"
      "class.line  = saturation 0..10 value 90..100\n"
      "class.door  = hue 15..50 saturation 60..100\n"
      "class.wall  = saturation 0..10 value 40..80\n"
      "pair.skirting = floor wall\n"
      "pair.door_foot = floor door\n"
      "pair.door_jamb = wall door\n"
      "pair.stripe_edge = floor line\n"
      "stripe.line = stripe_edge\n",
      "test.palette");
  return result;
}
const std::string kFloor = "<rect width='100%' height='100%' fill='#222'/>";
const std::string kWall = "fill='#999'";

/// A drawing of 6 x 4 units of a metre with a floor.
std::string drawing(const std::string& content) {
  return "<svg xmlns='http://www.w3.org/2000/svg' width='6000mm' height='4000mm' viewBox='0 0 6 4'>\n" +
         kFloor + "\n" + content + "\n</svg>";
}
SvgMap make(const std::string& svg, const SvgMapParams& params = {}) {
  return buildSvgMap(svg, "plan.svg", palette(), params);
}

/// "label x1,y1 x2,y2" in centimetres, ends and rows in order, so that drawings can be compared.
std::vector<std::string> rows(const SegmentMap& map) {
  std::vector<std::string> result;
  for (const auto& segment : map.segments) {
    EXPECT_EQ(segment.world.a.z(), 0.0);
    EXPECT_EQ(segment.world.b.z(), 0.0);
    using End = std::pair<long, long>;
    const auto end = [](const Eigen::Vector3d& p) {
      return End{std::lround(100 * p.x()), std::lround(100 * p.y())};
    };
    End a = end(segment.world.a);
    End b = end(segment.world.b);
    if (b < a) std::swap(a, b);
    std::ostringstream row;
    row << segment.label << ' ' << a.first << ',' << a.second << ' ' << b.first << ',' << b.second;
    if (segment.width_m > 0.0) row << " width " << std::lround(100 * segment.width_m);
    result.push_back(row.str());
  }
  std::sort(result.begin(), result.end());
  return result;
}
std::vector<std::string> rowsOf(const std::string& content) {
  const SvgMap made = make(drawing(content));
  EXPECT_THAT(made.warnings, IsEmpty()) << content;
  return rows(made.map);
}
std::string messageOf(const std::string& svg, const SvgMapParams& params = {}) {
  try {
    make(svg, params);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

// A box from (1, 1) to (2, 3) on the page, whose y is down: in the world of 4 m height from y = 1 to 3.
const std::vector<std::string> kBox{"skirting 100,100 100,300", "skirting 100,100 200,100",
                                    "skirting 100,300 200,300", "skirting 200,100 200,300"};

TEST(SvgMap, TheSameBoxHoweverItIsDrawn) {
  for (const std::string& content : std::vector<std::string>{
           "<rect x='1' y='1' width='1' height='2' " + kWall + "/>",
           "<polygon points='1,1 2,1 2,3 1,3' " + kWall + "/>",
           "<polyline points='1 1,2 1,2 3,1 3' " + kWall + "/>", "<path d='M1 1h1v2h-1z' " + kWall + "/>",
           "<path d='M2 3 1 3 1 1 2 1' style='fill: rgb(60%,60%,60%); stroke:none'/>",
           "<g transform='translate(1 1)'><g transform='scale(.5 1)'><rect width='2' height='2' " + kWall +
               "/></g></g>",
           "<g transform='rotate(90 2 1)'><rect x='2' y='1' width='2' height='1' " + kWall + "/></g>",
           "<g transform='matrix(0 1 1 0 0 0)'><rect x='1' y='1' width='2' height='1' " + kWall + "/></g>",
           // Of two halves, of four strips that overlap, and hidden under a floor that a box covers again.
           "<rect x='1' y='1' width='.5' height='2' " + kWall +
               "/><rect x='1.5' y='1' width='.5' height='2' " + kWall + "/>",
           "<path d='M1 1h1v2h-1zM1.2 1.2v1.6h.6v-1.6z' " + kWall +
               "/><rect x='1.1' y='1.1' width='.8' height='1.8' " + kWall + "/>",
           "<circle cx='3' cy='2' r='1' " + kWall + "/>" + kFloor +
               "<rect x='1' y='1' width='1' height='2' " + kWall + "/>",
           // A frame of a stroke 20 cm wide with its inside filled.
           std::string(
               "<rect x='1.1' y='1.1' width='.8' height='1.8' fill='#999' stroke='#999' stroke-width='.2'/>"),
           std::string("<line x1='1.5' x2='1.5' y1='1' y2='3' stroke='#999' stroke-width='1'/>"),
           // A thin pen around the box, in the box's colour or in one of no class.
           std::string(
               "<rect x='1' y='1' width='1' height='2' fill='none' stroke='#999' stroke-width='.01'/>"),
           std::string("<rect x='1' y='1' width='1' height='2' fill='none' stroke='#999' "
                       "vector-effect='non-scaling-stroke'/>"),
           std::string(
               "<rect x='1' y='1' width='1' height='2' fill='#999' stroke='#0f0' stroke-width='.01'/>"),
           std::string("<g data-label='skirting'><rect x='1' y='1' width='1' height='2'/></g>"),
           std::string("<path data-label='skirting' d='M1 1h1v2h-1z' fill='none'/>")}) {
    EXPECT_EQ(rowsOf(content), kBox) << content;
  }
}

TEST(SvgMap, WhatIsNotSeenIsNoEdge) {
  const std::string box = "x='1' y='1' width='1' height='2'";
  for (const std::string& content : std::vector<std::string>{
           "<rect " + box + " fill='none'/>", "<rect " + box + " " + kWall + " display='none'/>",
           "<g display='none'><rect " + box + " " + kWall + "/></g>",
           "<rect " + box + " " + kWall + " opacity='0.2'/>",
           "<g opacity='.6'><rect " + box + " " + kWall + " fill-opacity='.6'/></g>",
           "<rect " + box + " " + kWall + " visibility='hidden'/>",
           "<defs><rect " + box + " " + kWall + "/></defs>", "<rect " + box + " " + kWall + "/>" + kFloor,
           "<rect " + box + " fill='#0f0'/>",
           "<rect " + box + " fill='none' stroke='#999' stroke-width='.01'/>" + kFloor,
           "<rect width='0' height='2' " + kWall + "/>",
           "<clipPath id='c'><rect " + box + " " + kWall + "/></clipPath>"}) {
    EXPECT_THAT(rowsOf(content), IsEmpty()) << content;
  }
}

TEST(SvgMap, EdgesEndExactlyWhereSomethingElseCoversThem) {
  // A wall along the bottom, 50 cm high, with a door in it and a carpet of no class over its left end.
  EXPECT_THAT(rowsOf("<rect y='3.5' width='6' height='.5' " + kWall +
                     "/><rect x='2' y='3.5' width='.9' height='.5' "
                     "fill='#c87814'/><path d='M0 3h1v1h-1z' fill='#0f0'/>"),
              ElementsAre("door_foot 200,50 290,50", "door_jamb 200,0 200,50", "door_jamb 290,0 290,50",
                          "skirting 100,50 200,50", "skirting 290,50 600,50"));
  // Slanted: a wall's edge from (0, 4) to (4, 0), cut by a band from x = 1 to 2.
  EXPECT_THAT(
      rowsOf("<path d='M0 4 4 0 6 0 6 4z' " + kWall + "/><rect x='1' width='1' height='4' fill='#0f0'/>"),
      ElementsAre("skirting 0,0 100,100", "skirting 200,200 400,400"));
}

TEST(SvgMap, HolesByEitherRuleAndTheirStrokes) {
  const std::string frame = "d='M1 1h2v2h-2zM1.5 1.5h1v1h-1z'";
  EXPECT_EQ(rowsOf("<path " + frame + " " + kWall + " fill-rule='evenodd'/>").size(), 8U);
  EXPECT_EQ(rowsOf("<path " + frame + " " + kWall + "/>").size(), 4U) << "both turn the same way";
  EXPECT_EQ(rowsOf("<path d='M1 1h2v2h-2zM1.5 1.5v1h1v-1z' " + kWall + "/>").size(), 8U)
      << "they turn against";
  // A frame by a stroke 50 cm wide, with square corners, is the frame by two outlines.
  EXPECT_EQ(rowsOf("<rect x='1' y='1' width='2' height='2' fill='none' stroke='#999' stroke-width='.5'/>"),
            rowsOf("<path d='M.75.75h2.5v2.5h-2.5zM1.25 1.25v1.5h1.5v-1.5z' " + kWall + "/>"));
}

TEST(SvgMap, StripesAreRowsWithTheirWidth) {
  EXPECT_THAT(rowsOf("<path d='M1 1H5' stroke='#fff' stroke-width='.05'/>"),
              ElementsAre("line 100,300 500,300 width 5"));
  // Crossing ones, and one that runs into another, as painted with one pen.
  EXPECT_THAT(rowsOf("<path d='M1 1H5V3M3 .5V2' fill='none' stroke='#fff' stroke-width='.05'/>"),
              ElementsAre("line 100,300 500,300 width 5", "line 300,200 300,350 width 5",
                          "line 500,100 500,300 width 5"));
  EXPECT_THAT(rowsOf("<path data-label='line' d='M1 1H5' stroke='red' stroke-width='.1'/>"),
              ElementsAre("line 100,300 500,300 width 10"));
}

TEST(SvgMap, RoundThingsAreWithinTheFlatnessOfTheirRadius) {
  for (const std::string& content : std::vector<std::string>{
           "<circle cx='3' cy='2' r='1' " + kWall + "/>",
           "<ellipse cx='3' cy='2' rx='1' ry='1' " + kWall + "/>",
           "<path d='M2 2a1 1 0 1 0 2 0 1 1 0 0 0-2 0' " + kWall + "/>",
           "<rect x='2' y='1' width='2' height='2' rx='1' " + kWall + "/>",
           "<g transform='translate(3 2) rotate(30) scale(2 .5)'><ellipse rx='.5' ry='2' " + kWall +
               "/></g>"}) {
    const SvgMap made = make(drawing(content));
    double around = 0;
    for (const auto& segment : made.map.segments) {
      for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Eigen::Vector3d p = segment.world.a + t * (segment.world.b - segment.world.a);
        // The flatness and the rounding to a millimetre.
        ASSERT_NEAR((p.head<2>() - Vector2d(3, 2)).norm(), 1.0, 0.003) << content;
      }
      around += segment.world.length();
    }
    EXPECT_NEAR(around, 2 * std::numbers::pi, 0.02) << content;
  }
  // A painted circle is a ring of stripes.
  const SvgMap ring =
      make(drawing("<circle cx='3' cy='2' r='.75' fill='none' stroke='#fff' stroke-width='.05'/>"));
  double around = 0;
  for (const auto& segment : ring.map.segments) {
    EXPECT_EQ(segment.label, "line");
    EXPECT_NEAR(segment.width_m, 0.05, 0.0015);
    EXPECT_NEAR((segment.world.middle().head<2>() - Vector2d(3, 2)).norm(), 0.75, 0.004);
    around += segment.world.length();
  }
  // Of each of its 48 facets the part where the inner edge lies beside the outer one: 3 mm less.
  EXPECT_NEAR(around, 2 * std::numbers::pi * 0.75, 0.2);
}

TEST(SvgMap, ATurnedDrawingIsTheTurnedMap) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> any(-1, 1);
  const std::string things = "<rect x='1' y='1' width='1.2' height='.7' " + kWall +
                             "/><path d='M2 2.5C2.5 1 3 3 4 2L4 3.2z' fill='#c87814'/><line x1='.5' y1='3' "
                             "x2='3' y2='3.3' stroke='#999' "
                             "stroke-width='.3'/>";
  const auto middles = [](const SegmentMap& map) {
    std::vector<std::pair<Vector2d, double>> result;
    for (const auto& s : map.segments) result.emplace_back(s.world.middle().head<2>(), s.world.length());
    return result;
  };
  const auto plain = middles(make(drawing(things)).map);
  ASSERT_GT(plain.size(), 10U);
  for (int i = 0; i < 20; ++i) {
    // Turned and moved on a floor that is large enough for all of it.
    const double degrees = 180 * any(engine);
    const Vector2d moved(any(engine), any(engine));
    std::ostringstream group;
    group << "<rect x='-50' y='-50' width='100' height='100' fill='#222'/><g transform='translate("
          << moved.x() << ',' << moved.y() << ") rotate(" << degrees << ")'>" << things << "</g>";
    const auto turned = middles(make(drawing(group.str())).map);
    EXPECT_EQ(turned.size(), plain.size()) << group.str();
    // On the page, whose y is down, then in the world.
    const Eigen::Rotation2Dd R(degrees * std::numbers::pi / 180);
    for (const auto& [middle, length] : plain) {
      const Vector2d page = R * Vector2d(middle.x(), 4 - middle.y()) + moved;
      const Vector2d expected(page.x(), 4 - page.y());
      const double nearest =
          std::accumulate(turned.begin(), turned.end(), 1e9, [&](double best, const auto& other) {
            return std::min(best, (other.first - expected).norm() + std::abs(other.second - length));
          });
      EXPECT_LT(nearest, 0.006) << "seed 5, turn " << i << ", at " << middle.transpose();
    }
  }
}

TEST(SvgMap, DrawnAgainFromAMapItGivesThatMap) {
  // The field of 2009: its stripes as strokes, its circle's facets too.
  const SegmentMap field = loadSegmentMap(kSource + "/cfg/maps/field_6x4.csv");
  std::ostringstream strokes;
  for (const auto& row : field.segments) {
    if (row.width_m <= 0.0) continue;
    strokes << "<line x1='" << row.world.a.x() << "' y1='" << -row.world.a.y() << "' x2='" << row.world.b.x()
            << "' y2='" << -row.world.b.y() << "' stroke='#fff' stroke-width='" << row.width_m << "'/>";
  }
  SvgMapParams params;
  params.drawing.metres_per_unit = 1.0;
  params.drawing.origin = Vector2d(0, 0);
  params.ground = "floor";
  const SvgMap made = make("<svg>" + strokes.str() + "</svg>", params);
  double length_then = 0;
  double length_now = 0;
  for (const auto& row : field.segments) length_then += row.width_m > 0.0 ? row.world.length() : 0.0;
  for (const auto& row : made.map.segments) {
    if (row.width_m <= 0.0) continue;
    length_now += row.world.length();
    const double off = std::accumulate(
        field.segments.begin(), field.segments.end(), 1e9, [&](double best, const MapSegment& other) {
          return std::min(best, std::max(distanceToSegment(row.world.a, other.world),
                                         distanceToSegment(row.world.b, other.world)));
        });
    EXPECT_LT(off, 0.05) << row.world.a.transpose() << " to " << row.world.b.transpose();
  }
  EXPECT_NEAR(length_now, length_then, 0.05 * length_then);
}

TEST(SvgMap, UnitsScaleAndOrigin) {
  const std::string box = "<rect x='100' y='100' width='100' height='200' " + kWall + "/>";
  const std::string floor = "<rect x='-50' width='1000' height='1000' fill='#222'/>";
  const auto rowsIn = [&](const std::string& root, const SvgMapParams& params = {}) {
    return rows(make("<svg " + root + ">" + floor + box + "</svg>", params).map);
  };
  SvgMapParams paper;
  paper.drawing.scale = 100.0;
  // 60 x 40 mm for 600 x 400 units, drawn 1:100: a unit is 1 cm.
  EXPECT_EQ(rowsIn("width='60mm' height='40mm' viewBox='0 0 600 400'", paper), kBox);
  EXPECT_EQ(rowsIn("width='6cm' height='4cm' viewBox='0 0 600 400'", paper), kBox);
  // Without a view box a unit is 1/96 inch.
  SvgMapParams pixels;
  pixels.drawing.scale = 0.01 / (0.0254 / 96.0);
  const std::string inches =
      std::to_string(600.0 / 96.0) + "in' height='" + std::to_string(400.0 / 96.0) + "in'";
  EXPECT_EQ(rowsIn("width='" + inches, pixels), kBox);
  SvgMapParams stated;
  stated.drawing.metres_per_unit = 0.01;
  EXPECT_EQ(rowsIn("viewBox='0 0 600 400'", stated), kBox);
  EXPECT_EQ(rowsIn("width='600' height='400'", stated), kBox);
  EXPECT_EQ(rowsIn("viewBox='0 100 600 300'", stated), kBox) << "the lower left corner is the same";
  stated.drawing.origin = Vector2d(-100, 500);
  auto moved = rowsIn("width='100%'", stated);
  EXPECT_THAT(moved, Contains("skirting 200,200 200,400"));
  // Both axes apart, only where the file asks for it; else the smaller scale counts and the rest is margin.
  EXPECT_THAT(rowsIn("width='60mm' height='80mm' viewBox='0 0 600 400' preserveAspectRatio='none'", paper),
              Contains("skirting 100,200 100,600"));
  EXPECT_THAT(rowsIn("width='60mm' height='80mm' viewBox='0 0 600 400'", paper),
              Contains("skirting 100,100 100,300"));
}

TEST(SvgMap, PensTakeWhatTheyLieUpon) {
  const std::string pen = "stroke='#999' stroke-width='.01'";
  EXPECT_THAT(rowsOf("<path d='M1 1H5' " + pen + "/>"), ElementsAre("skirting 100,300 500,300"));
  // Over a door of 2 m: there it is the door's jamb.
  EXPECT_THAT(
      rowsOf("<rect x='2' y='.5' width='2' height='1' fill='#c87814'/><path d='M1 1H5' " + pen + "/>"),
      testing::IsSupersetOf(
          {"skirting 100,300 200,300", "door_jamb 200,300 400,300", "skirting 400,300 500,300"}));
  // Unpainted areas are no floor, unless `ground` is set.
  SvgMapParams params;
  params.drawing.metres_per_unit = 1.0;
  const std::string alone = "<svg viewBox='0 0 6 4'><path d='M1 1H5' " + pen + "/></svg>";
  EXPECT_THAT(rows(make(alone, params).map), IsEmpty());
  params.ground = "floor";
  EXPECT_THAT(rows(make(alone, params).map), ElementsAre("skirting 100,300 500,300"));
  params.ground = "grass";
  EXPECT_EQ(messageOf(alone, params),
            "ground = grass (must be a colour class of the palette: floor, line, door, wall)");
}

TEST(SvgMap, WarnsOfWhatItLeavesOut) {
  const auto made = make(
      drawing("<text>a</text>\n<text>b</text><image href='x.png'/><inkscape:grid/>\n"
              "<rect x='1' y='1' width='1' height='2' " +
              kWall +
              " clip-path='url(#c)'/>"
              "<rect width='1' height='1' fill='url(#pattern)'/>"
              "<path d='M0 4V4.1H.1' fill='none' stroke='#0f0' stroke-width='.05' stroke-linejoin='round' "
              "style='stroke-linecap:square;marker-end:url(#arrow);filter:none'/>"));
  EXPECT_EQ(rows(made.map).size(), 4U);
  EXPECT_THAT(made.warnings, testing::UnorderedElementsAre(
                                 "plan.svg:3: <text> is left out (2 times)",
                                 "plan.svg:4: <image> is left out", "plan.svg:5: clip-path is not applied",
                                 "plan.svg:5: fill = \"url(#pattern)\" is left out (plain colours are known)",
                                 "plan.svg:5: marker-end is not applied",
                                 "plan.svg:5: stroke-linecap square is drawn as butt",
                                 "plan.svg:5: stroke-linejoin round is drawn as miter"));
}

TEST(SvgMap, RefusesWhatWouldChangeTheMapByLineAndElement) {
  const std::string box = "x='1' y='1' width='1' height='2'";
  EXPECT_EQ(
      messageOf(drawing("<style>.w{fill:#999}</style><rect class='w' " + box +
                        "/>\n"
                        "<defs><rect id='b' width='1' height='2'/></defs>\n"
                        "<use id='copy' xlink:href='#b' " +
                        kWall +
                        "/>\n"
                        "<svg " +
                        box +
                        " viewBox='5 5 2 4'/>\n"
                        "<g color='#999'><rect " +
                        box +
                        " fill='currentColor'/></g>\n"
                        "<rect " +
                        box + " fill='rgba(9, 9, 9, .5)' stroke='forestgreen'/>")),
      "plan.svg:5: <use id=\"copy\">: copies are not supported (must be unlinked: drawn in full)\n"
      "plan.svg:6: <svg>: drawings within drawings are not supported (must be groups)\n"
      "plan.svg:7: <rect>: fill = \"currentColor\" (must be none, #rgb, #rrggbb, rgb(), or a basic colour "
      "name as white)\n"
      "plan.svg:8: <rect>: fill = \"rgba(9, 9, 9, .5)\" (must be none, #rgb, #rrggbb, rgb(), or a basic "
      "colour name as white)\n"
      "plan.svg:8: <rect>: stroke = \"forestgreen\" (must be none, #rgb, #rrggbb, rgb(), or a basic colour "
      "name as white)\n"
      "plan.svg:3: <style>: style sheets are not supported (must be attributes or style=\"\" of each "
      "element)");
  // Nothing to refuse: no rules, copies that are never drawn.
  EXPECT_EQ(rowsOf("<style id='empty'/><defs><use href='#b'/></defs><rect " + box + " " + kWall + "/>"),
            kBox);
}

TEST(SvgMap, NamesFileLineElementAndRuleOfEveryProblem) {
  EXPECT_THAT(messageOf(""), HasSubstr("plan.svg: not XML"));
  EXPECT_THAT(messageOf("<svg><rect></svg>"),
              HasSubstr("plan.svg:1: not XML: mismatched element (must be a drawing in SVG)"));
  EXPECT_EQ(messageOf("<sdf/>"), "plan.svg:1: begins with the element <sdf> (must be a drawing in SVG)");
  EXPECT_EQ(messageOf("<svg/>"),
            "plan.svg:1: <svg>: width and height = \"\" and \"\" (must be lengths in mm, cm or in, or the "
            "metres of a "
            "unit must be stated)");
  SvgMapParams params;
  params.drawing.metres_per_unit = 1.0;
  EXPECT_EQ(messageOf("<svg/>", params),
            "plan.svg:1: <svg>: has neither a viewBox nor a width and height: where the world's origin lies "
            "must be "
            "stated");
  EXPECT_EQ(messageOf("<svg viewBox='0 0 1'/>", params),
            "plan.svg:1: <svg>: viewBox = \"0 0 1\" (must be four numbers, the last two above 0)");
  const std::string message =
      messageOf(drawing("<rect id='a' width='x' height='1'/>\n<path d='M0 0L1'/>\n"
                        "<g><circle r='-1'/></g>\n<polygon points='1 2 3'/>\n"
                        "<rect fill='reddish' transform='turn(1)'/>\n<use href='#none'/>\n"
                        "<path d='M0 0H99999999'/>\n"
                        "<rect opacity='x' stroke-width='-1'/>"));
  std::vector<std::string> lines;
  std::istringstream stream(message);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  EXPECT_THAT(
      lines,
      ElementsAre(
          "plan.svg:3: <rect id=\"a\">: width = \"x\" (must be a number, maybe with px, mm, cm, in, pt, pc, "
          "Q or %)",
          "plan.svg:4: <path>: d ends where a number is due at character 7",
          "plan.svg:5: <circle>: r = \"-1\" (must be 0 or more)",
          "plan.svg:6: <polygon>: points has an odd number of numbers",
          "plan.svg:7: <rect>: fill = \"reddish\" (must be none, #rgb, #rrggbb, rgb(), or a basic colour "
          "name as "
          "white)",
          "plan.svg:7: <rect>: transform = \"turn(1)\" (must be a list of transforms, but is none of matrix, "
          "translate, scale, rotate, skewX, skewY before at character 8)",
          "plan.svg:8: <use>: copies are not supported (must be unlinked: drawn in full)",
          "plan.svg:9: <path>: lies farther than 100 km from the origin",
          "plan.svg:10: <rect>: stroke-width = \"-1\" (must be a number of 0 or more, maybe with a unit)",
          "plan.svg:10: <rect>: opacity = \"x\" (must be a number in 0..1)"));
  EXPECT_EQ(messageOf(drawing("<path id='p' data-label='wal' d='M1 1h1'/>")),
            "plan.svg:3: <path id=\"p\">: data-label = \"wal\" (must be any, door_foot, door_jamb, skirting, "
            "stripe_edge, line)");
  EXPECT_THAT(messageOf(drawing("<path data-label='line' d='M1 1h1'/>")),
              HasSubstr("must be a stroke of 0.03 to 0.12 m"));
}

TEST(SvgMap, AFileMadeToNeverEndEnds) {
  std::string path = "M0 0";
  for (int i = 0; i < 60000; ++i) path += " " + std::to_string(i % 7) + " " + std::to_string(i % 5);
  EXPECT_THAT(messageOf(drawing("<path d='" + path + "' " + kWall + "/>")),
              HasSubstr("here the outlines have more than 50000 corners"));
}

TEST(MakeMap, WritesTheMapOfADrawing) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("vismem_svg_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string drawings = kSource + "/test/data/drawings/office";
  const auto run = [&](const std::string& options) {
    const std::string line = std::string(VISMEM_BIN_DIR) + "/make_map " + drawings + ".svg --palette " +
                             drawings + ".palette -o " + (folder / "office.csv").string() + " " + options +
                             " > " + (folder / "out").string() + " 2> " + (folder / "err").string();
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(run("--scale 50"), 0);
  EXPECT_THAT(readTextFile(folder / "out", ""), HasSubstr("\"labels\":{\"door_foot\":"));
  EXPECT_THAT(readTextFile(folder / "err", ""), HasSubstr("<text> is left out"));
  // The drawing says 1:50: the room inside its walls is 4.6 x 2.6 m, its door 0.9 m.
  const SegmentMap map = loadSegmentMap(folder / "office.csv");
  EXPECT_THAT(rows(map), testing::IsSupersetOf({"skirting 20,280 480,280", "skirting 20,20 20,280",
                                                "door_foot 100,20 190,20", "skirting 20,20 100,20",
                                                "skirting 300,180 340,180", "line 60,150 220,150 width 5"}));
  EXPECT_EQ(run("--metres-per-unit 0.01 --origin 0,300"), 0);
  EXPECT_EQ(rows(loadSegmentMap(folder / "office.csv")), rows(map));
  EXPECT_EQ(run("--metres-per-unit 0.01 --scale 50"), 2) << "either says it all";
  EXPECT_EQ(run("--origin 1"), 2);
  EXPECT_EQ(run("--scale 50 --ground lawn"), 2);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace vismem
