// Maps of drives in the formats of other programs. Tests B6.
#include "mapper/core/map_output.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/vision/palette.h"
#include "simulator/core/svg_map.h"

namespace vismem {
namespace {

const char* const kPalette =
    "class.floor = value 0..30\nclass.wall = value 40..100\nclass.door = hue 15..50 saturation 50..100\n"
    "pair.skirting = floor wall\npair.door_foot = floor door\npair.line_edge = wall door\nstripe.line = "
    "line_edge\n";

MapSegment row(double x1, double y1, double x2, double y2, const char* label, double width_m = 0.0) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, width_m};
}

SegmentMap hall() {
  SegmentMap map;
  map.segments = {row(-1.234, 2.001, 3.999, 2.003, "skirting"), row(3.999, 2.003, 4.857, 2.004, "door_foot"),
                  row(-0.007, -0.5, -0.007, 1.25, "line", 0.048), row(12.345, -7.891, 0.1, 0.2, "skirting")};
  return map;
}

void expectSame(const SegmentMap& one, const SegmentMap& other) {
  ASSERT_EQ(one.segments.size(), other.segments.size());
  for (std::size_t i = 0; i < one.segments.size(); ++i) {
    EXPECT_EQ(one.segments[i].world.a, other.segments[i].world.a) << i;
    EXPECT_EQ(one.segments[i].world.b, other.segments[i].world.b) << i;
    EXPECT_EQ(one.segments[i].label, other.segments[i].label) << i;
    EXPECT_EQ(one.segments[i].width_m, other.segments[i].width_m) << i;
  }
}

TEST(MapOutput, SvgIsReadBackByMakeMapBitForBit) {
  const Palette palette = Palette::parse(kPalette, "hall.palette");
  expectSame(hall(), buildSvgMap(svgOf(hall()), "hall.svg", palette, {}).map);
}

TEST(MapOutput, CsvIsReadBackBitForBit) {
  const auto file = std::filesystem::temp_directory_path() / "map_output_test.csv";
  saveSegmentMap(hall(), file);
  expectSame(hall(), loadSegmentMap(file));
  std::filesystem::remove(file);
}

/// The lines of a drawing in DXF: pairs of a group's number and its value.
SegmentMap linesOf(const std::string& dxf) {
  SegmentMap map;
  std::istringstream in(dxf);
  for (std::string group, value; std::getline(in, group) && std::getline(in, value);) {
    if (group == "0" && value == "LINE") map.segments.emplace_back();
    if (map.segments.empty()) continue;
    MapSegment& line = map.segments.back();
    const int number = std::stoi(group);
    if (number == 8) line.label = value;
    if (number == 39) line.width_m = std::stod(value);
    if (number >= 10 && number < 39)
      (number % 10 == 0 ? line.world.a : line.world.b)[number / 10 - 1] = std::stod(value);
  }
  return map;
}

TEST(MapOutput, DxfIsReadBackBitForBit) {
  SegmentMap map = hall();
  map.segments.push_back({{{1.5, 2.0, 2.0}, {1.5, 2.0, 0.0}}, "door_foot"});  // upright
  expectSame(map, linesOf(dxfOf(map)));
}

TEST(MapOutput, PaintedLinesAreNoObstacles) {
  DriveRecord record;
  Keyframe keyframe;
  keyframe.intrinsics = intrinsicsFromFieldOfView(320, 240, 1.05);
  keyframe.T_robot_camera = cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, 0.0);
  record.keyframes = {keyframe};
  SegmentMap map;
  map.segments = {row(1.0, -1.0, 1.0, 1.0, "line_edge"), row(2.0, -1.0, 2.0, 1.0, "skirting")};
  const GridImage grid = gridOf(map, record, {Pose2{}}, {});
  const auto at = [&](double x, double y) {
    const int column = static_cast<int>((x - grid.low.x()) / grid.resolution_m);
    const int from_below = static_cast<int>((y - grid.low.y()) / grid.resolution_m);
    return grid.cells[static_cast<std::size_t>((grid.height - 1 - from_below) * grid.width + column)];
  };
  EXPECT_EQ(at(0.1, 0.0), 254);    // driven over
  EXPECT_EQ(at(1.02, 0.02), 254);  // a painted line
  EXPECT_EQ(at(2.02, 0.02), 0);    // the foot of a wall
  EXPECT_EQ(at(2.5, 0.0), 205);    // behind it
  EXPECT_EQ(pgmOf(grid).substr(0, 3), "P5\n");
}

TEST(MapOutput, NothingIsSeenThroughTheWallOfAGrid) {
  // Across the rows of cells, so that its cells touch at corners.
  SegmentMap map;
  map.segments = {row(2.0, -8.0, 2.13, 8.0, "skirting")};
  DriveRecord record;
  std::vector<Pose2> poses;
  for (int i = 0; i < 100; ++i) {
    Keyframe& keyframe = record.keyframes.emplace_back();
    keyframe.intrinsics = intrinsicsFromFieldOfView(320, 240, 1.2);
    keyframe.T_robot_camera.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
    poses.push_back({0.0, -1.0 + 0.02 * i, 0.0});
  }
  const GridImage grid = gridOf(map, record, poses, {});
  for (int from_top = 0; from_top < grid.height; ++from_top) {
    for (int x = static_cast<int>((2.2 - grid.low.x()) / grid.resolution_m); x < grid.width; ++x)
      EXPECT_NE(grid.cells[static_cast<std::size_t>(from_top * grid.width + x)], 254) << x << " " << from_top;
  }
}

MappedRow mapped(const Segment2& map, const char* label) {
  MappedRow made;
  made.map = map;
  made.row = row(map.a.x(), map.a.y(), map.b.x(), map.b.y(), label);
  made.closed_a = made.closed_b = true;
  return made;
}

TEST(MapOutput, TwoEdgesOfAPaintedLineGetTheirEnds) {
  std::vector<MappedRow> rows{mapped({{0.0, 0.0}, {2.0, 0.0}}, "marking"),
                              mapped({{2.01, 0.05}, {0.0, 0.05}}, "marking")};
  addStripeEnds(rows, {});
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_TRUE(rows[2].derived);
  EXPECT_NEAR(rows[2].map.length(), 0.05, 1e-9);
  // Squarely: both edges end there.
  EXPECT_NEAR(rows[3].map.a.x(), 2.005, 1e-9);
  EXPECT_NEAR(rows[3].map.b.x(), 2.005, 1e-9);
  EXPECT_NEAR(rows[0].map.b.x(), 2.005, 1e-9);
  // Walls on both sides of a passage are no line.
  std::vector<MappedRow> walls{mapped({{0.0, 0.0}, {2.0, 0.0}}, "skirting"),
                               mapped({{2.0, 0.8}, {0.0, 0.8}}, "skirting")};
  addStripeEnds(walls, {});
  EXPECT_EQ(walls.size(), 2u);
}

TEST(MapOutput, APaintedLineThatGoesOnHasNoEndThere) {
  // An L of lines: its outer edges meet at a corner, its inner ones, too.
  std::vector<MappedRow> rows{
      mapped({{0.0, 0.0}, {2.0, 0.0}}, "marking"), mapped({{2.0, 0.0}, {2.0, 1.0}}, "marking"),
      mapped({{1.95, 1.0}, {1.95, 0.05}}, "marking"), mapped({{1.95, 0.05}, {0.0, 0.05}}, "marking")};
  // The skew of the corner is above what ends may differ by; also where it is not:
  rows[0].map.b.x() = 1.97;
  addStripeEnds(rows, {});
  EXPECT_EQ(rows.size(), 6U) << "one end for each line";
}

TEST(MapOutput, EdgesOfAStripeOfThePaletteBecomeOneRow) {
  std::vector<MappedRow> rows{mapped({{0.0, 0.0}, {2.0, 0.0}}, "line_edge"),
                              mapped({{2.0, 0.05}, {0.0, 0.05}}, "line_edge")};
  joinIntoStripes(rows, {{"line", "line_edge"}}, {});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].row.label, "line");
  EXPECT_DOUBLE_EQ(rows[0].row.width_m, 0.05);
  EXPECT_NEAR(rows[0].map.a.y(), 0.025, 1e-12);
}

}  // namespace
}  // namespace vismem
