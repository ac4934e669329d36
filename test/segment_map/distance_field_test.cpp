// Distances to map lines: the table against the exact search (SPEC L5; DESIGN 9).
#include "common/segment_map/distance_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/config/config_error.h"

namespace vismem {
namespace {

std::vector<Segment2> randomLines(std::mt19937_64& random, int count, double size_m) {
  std::uniform_real_distribution<double> place(-size_m, size_m);
  std::vector<Segment2> lines;
  for (int i = 0; i < count; ++i) {
    lines.push_back({{place(random), place(random)}, {place(random), place(random)}});
  }
  return lines;
}

// One line along x from 0 to 2: over its middle the distance is |y|, beyond its end that to the end.
TEST(DistanceField, WorkedExample) {
  const std::vector<Segment2> lines{{{0, 0}, {2, 0}}};
  const DistanceField field(lines, {0.05, 1.0});
  EXPECT_NEAR(field.distance({1.0, 0.30}), 0.30, 1e-6);
  EXPECT_NEAR(field.at({1.0, -0.52}).gradient.y(), -1.0, 1e-5);
  EXPECT_NEAR(field.at({1.0, 0.52}).gradient.y(), 1.0, 1e-5);
  EXPECT_NEAR(field.distance({2.3, 0.4}), 0.5, 1e-3);
  EXPECT_EQ(field.distance({1.0, 50.0}), 1.0);
  EXPECT_EQ(field.at({1.0, 50.0}).gradient, Eigen::Vector2d(0, 0));
  EXPECT_EQ(field.distance({std::nan(""), 0.0}), 1.0);
}

TEST(DistanceField, AgreesWithTheExactSearchWithinACell) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::mt19937_64 random(seed);
    const auto lines = randomLines(random, 25, 6.0);
    const DistanceFieldParams params{0.05, 0.8};
    const DistanceField field(lines, params);
    std::uniform_real_distribution<double> place(-8.0, 8.0);
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Vector2d p(place(random), place(random));
      const double exact = std::min(nearestLine(lines, p)->distance_m, params.truncation_m);
      // A distance changes by at most 1 m/m and no node of the cell is further than its diagonal; where the
      // field bends (on a line, between two) half a diagonal is the most a mean can be off.
      EXPECT_NEAR(field.distance(p), exact, 0.5 * params.cell_m * std::sqrt(2.0))
          << "seed " << seed << " at " << p;
      EXPECT_EQ(field.at(p).distance_m, field.distance(p));
    }
  }
}

TEST(DistanceField, IsContinuousAcrossTilesAndItsGradientIsItsDerivative) {
  std::mt19937_64 random(4);
  const auto lines = randomLines(random, 12, 4.0);
  const DistanceField field(lines, {0.05, 1.0});
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  std::uniform_real_distribution<double> direction(-3.2, 3.2);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector2d p(place(random), place(random));
    const double angle = direction(random);
    const Eigen::Vector2d step = kStep * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const double change = field.distance(p + step) - field.distance(p);
    EXPECT_NEAR(change, 0.0, 1.5 * kStep);  // |gradient| is at most sqrt(2) inside a cell
    const Eigen::Vector2d gradient = field.at(p).gradient;
    // Only a cell's border within the step can make a difference: none is met with these seeds.
    EXPECT_NEAR(change / kStep, gradient.dot(step) / kStep, 2e-2);
  }
}

TEST(DistanceField, MemoryGrowsWithTheLinesNotWithTheArea) {
  const std::vector<Segment2> lines{{{0, 0}, {1, 0}}, {{1000, 1000}, {1001, 1000}}};
  const DistanceField field(lines, {0.05, 0.5});
  EXPECT_LE(field.tileCount(), 12u);
  EXPECT_NEAR(field.distance({1000.5, 1000.2}), 0.2, 1e-4);
  EXPECT_EQ(field.distance({500, 500}), 0.5);
}

TEST(DistanceField, RefusesWhatItCannotHold) {
  const std::vector<Segment2> far{{{0, 0}, {1, 0}}, {{1e9, 1e9}, {1e9, 1e9 + 1}}};
  EXPECT_THROW(DistanceField(far, {}), ConfigError);
  EXPECT_THROW(DistanceField(far, {0.0, 1.0}), ConfigError);
  EXPECT_THROW(DistanceField(far, {0.05, std::nan("")}), ConfigError);
}

TEST(NearestLine, IsEmptyWithoutLinesAndTheFirstOfEquals) {
  EXPECT_FALSE(nearestLine({}, {0, 0}).has_value());
  const std::vector<Segment2> lines{{{0, 1}, {1, 1}}, {{0, -1}, {1, -1}}};
  EXPECT_EQ(nearestLine(lines, {0.5, 0.0})->index, 0u);
  EXPECT_EQ(nearestLine(lines, {0.5, -0.1})->index, 1u);
}

TEST(LabelledDistanceFields, AnyIsInEveryFieldAndUnknownHasNone) {
  SegmentMap map;
  map.segments.push_back({{{0, 0, 0}, {2, 0, 0}}, "skirting", 0.0});
  map.segments.push_back({{{0, 2, 0}, {2, 2, 0}}, kAnyLabel, 0.0});
  map.segments.push_back({{{0, 1, 1}, {2, 1, 1}}, "skirting", 0.0});  // not on the floor
  const LabelledDistanceFields fields(map, {0.05, 1.0});
  ASSERT_NE(fields.find("skirting"), nullptr);
  EXPECT_NEAR(fields.find("skirting")->distance({1, 0.1}), 0.1, 1e-6);
  EXPECT_NEAR(fields.find("skirting")->distance({1, 1.9}), 0.1, 1e-6);
  EXPECT_NEAR(fields.find("skirting")->distance({1, 1.0}), 1.0, 1e-6);
  ASSERT_NE(fields.find("door"), nullptr);
  EXPECT_EQ(fields.find("door")->distance({1, 0.1}), 1.0);
  EXPECT_NEAR(fields.find("door")->distance({1, 1.9}), 0.1, 1e-6);
  EXPECT_EQ(fields.find(kUnknownLabel), nullptr);

  map.segments.erase(map.segments.begin() + 1);
  EXPECT_EQ(LabelledDistanceFields(map, {0.05, 1.0}).find("door"), nullptr);
}

}  // namespace
}  // namespace vismem
