// Tests of common/segment_map/symmetry: which motions no observation of a map tells apart.
#include "common/segment_map/symmetry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/segment_map/segment_map.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

SegmentMap mapOf(const std::string& rows) {
  return parseSegmentMap("x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n" + rows, "test.csv");
}

/// A rectangle of 4 x 2 m around (1, 1): two long walls, two short ones.
const std::string kRectangle =
    "-1,0,0,3,0,0,skirting\n"
    "3,0,0,3,2,0,skirting\n"
    "3,2,0,-1,2,0,skirting\n"
    "-1,2,0,-1,0,0,skirting\n";

TEST(SymmetriesOf, RectangleHasTheHalfTurnAboutItsMiddle) {
  const auto found = symmetriesOf(mapOf(kRectangle));
  ASSERT_EQ(found.size(), 1u);
  // The half turn about (1, 1) takes p to (2, 2) - p.
  EXPECT_NEAR(found[0].x, 2.0, 1e-9);
  EXPECT_NEAR(found[0].y, 2.0, 1e-9);
  EXPECT_NEAR(std::abs(found[0].theta), kPi, 1e-9);
}

TEST(SymmetriesOf, SquareHasThreeQuarterTurns) {
  const auto found =
      symmetriesOf(mapOf("0,0,0,2,0,0,a\n"
                         "2,0,0,2,2,0,a\n"
                         "2,2,0,0,2,0,a\n"
                         "0,2,0,0,0,0,a\n"));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[0].theta, kPi / 2, 1e-9);
  EXPECT_NEAR(found[2].theta, -kPi / 2, 1e-9);
}

TEST(SymmetriesOf, OneDoorBreaksTheSymmetry) {
  EXPECT_TRUE(symmetriesOf(mapOf(kRectangle + "0,0,0,0.8,0,0,door_foot\n")).empty());
}

TEST(SymmetriesOf, AnotherLabelOnOneSideBreaksIt) {
  EXPECT_TRUE(symmetriesOf(mapOf("-1,0,0,3,0,0,red\n3,2,0,-1,2,0,blue\n")).empty());
}

TEST(SymmetriesOf, AMirrorImageIsNone) {
  // An L and its reflection: no turn brings one onto the other.
  EXPECT_TRUE(
      symmetriesOf(mapOf("1,0,0,2,0,0,a\n1,0,0,1,0.5,0,a\n-1,0,0,-2,0,0,a\n-1,0,0,-1,0.5,0,a\n")).empty());
}

class ShippedMaps : public testing::TestWithParam<std::pair<const char*, std::size_t>> {};

TEST_P(ShippedMaps, HaveTheirSymmetries) {
  const auto map = loadSegmentMap(std::string(VISMEM_SOURCE_DIR) + "/cfg/maps/" + GetParam().first);
  EXPECT_EQ(symmetriesOf(map).size(), GetParam().second);
}

INSTANTIATE_TEST_SUITE_P(Symmetry, ShippedMaps,
                         testing::Values(std::pair("field_6x4.csv", 1u), std::pair("field_9x6.csv", 1u),
                                         std::pair("room.csv", 0u), std::pair("curve.csv", 0u),
                                         std::pair("furniture.csv", 0u), std::pair("texture.csv", 0u),
                                         std::pair("corridor_irregular.csv", 0u)));

}  // namespace
}  // namespace vismem
