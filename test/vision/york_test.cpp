// Accuracy on real photographs with annotated segments (york_urban_half): keeps what was reached.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "common/vision/segment_detector.h"
#include "vision/support/accuracy.h"

namespace vismem {
namespace {

std::filesystem::path dataFolder() {
  const char* data = std::getenv("AVM_DATA");
  return data != nullptr ? std::filesystem::path(data)
                         : std::filesystem::path(VISMEM_SOURCE_DIR) / "../shared/data";
}

// Hand-worked: an annotated line of 100 px; one detection on its first half 1 px beside, one crossing it.
TEST(AccuracyMeter, WorkedExample) {
  const std::vector<Segment2> annotated{{{0, 0}, {100, 0}}};
  const std::vector<Segment2> detected{{{0, 1}, {50, 1}}, {{60, -25}, {60, 25}}};
  AccuracyMeter near(0.5);
  AccuracyMeter meter(2.0);
  near.add(detected, annotated);
  meter.add(detected, annotated);
  EXPECT_DOUBLE_EQ(near.figures().recall, 0.0);
  EXPECT_DOUBLE_EQ(meter.figures().recall, 0.5);
  EXPECT_DOUBLE_EQ(meter.figures().precision, 0.5);
  FragmentMeter fragments;
  fragments.add({{{0, 1}, {30, 1}}, {{20, 0}, {60, 0}}}, annotated);
  EXPECT_DOUBLE_EQ(fragments.mean(), 2.0);
  StructuralMeter structural;
  structural.add({{{100, 2}, {1, 0}}, {{0, 1}, {50, 1}}}, annotated);
  EXPECT_DOUBLE_EQ(structural.figures().precision, 0.5);
  EXPECT_DOUBLE_EQ(structural.figures().recall, 1.0);
}

TEST(YorkUrban, AccuracyAtHalfSize) {
  const auto images = loadAnnotated(dataFolder() / "york_urban_half", true);
  if (images.empty())
    GTEST_SKIP() << dataFolder() / "york_urban_half"
                 << " is absent (set AVM_DATA)";
  std::cout << "detector F1 F2 F5 sF5 frag segments\n";
  for (const auto& name : segmentDetectorNames()) {
    const auto detector = makeSegmentDetector(name);
    AccuracyMeter at1(1.0);
    AccuracyMeter at2(2.0);
    AccuracyMeter at5(5.0);
    StructuralMeter structural;
    FragmentMeter fragments;
    std::size_t count = 0;
    for (const auto& image : images) {
      std::vector<RawSegment> raw;
      detector->detect(image.rgb, raw);
      std::vector<Segment2> found;
      for (const auto& segment : raw) found.push_back(segment.px_raw);
      count += found.size();
      for (AccuracyMeter* meter : {&at1, &at2, &at5}) meter->add(found, image.annotated);
      structural.add(found, image.annotated);
      fragments.add(found, image.annotated);
    }
    std::cout << name << ' ' << at1.figures().f() << ' ' << at2.figures().f() << ' ' << at5.figures().f()
              << ' ' << structural.figures().f() << ' ' << fragments.mean() << ' ' << count / images.size()
              << '\n';
    // solis: a hundredth under what it reached; the others: what is published for them on the whole set.
    EXPECT_GT(at2.figures().f(), name == "solis" ? 0.72 : name == "chapter" ? 0.35 : 0.30) << name;
    if (name == "solis") {
      EXPECT_GT(at1.figures().f(), 0.575);
    }
  }
}

}  // namespace
}  // namespace vismem
