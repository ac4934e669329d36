// The accuracy measures by hand, and the accuracy of the detectors on real photographs (york_urban_half).
#include <gtest/gtest.h>

#include <iostream>

#include "common/vision/segment_detector.h"
#include "evaluation/app/annotated_images.h"
#include "evaluation/core/segment_accuracy.h"
#include "support/data_folder.h"
#include "vision/support/repeatability.h"
#include "vision/support/synthetic_scenes.h"

namespace vismem {
namespace {

// Hand-worked: an annotated line of 100 px; one detection on its first half 1 px beside, one crossing it.
TEST(Accuracy, WorkedExample) {
  const std::vector<Segment2> annotated{{{0, 0}, {100, 0}}};
  const std::vector<Segment2> detected{{{0, 1}, {50, 1}}, {{60, -25}, {60, 25}}};
  EXPECT_DOUBLE_EQ(lengthMatch(detected, annotated, 0.5).recall, 0.0);
  const ImageScore score = scoreImage(detected, annotated);
  EXPECT_DOUBLE_EQ(score.at[1].recall, 0.5);
  EXPECT_DOUBLE_EQ(score.at[1].precision, 0.5);
  EXPECT_DOUBLE_EQ(summarize({score}).at[1].f(), 0.5);

  // Overlapping by 10 of 60 px: two fragments, 70 px of parts on 60 px of recalled line.
  const ImageScore twice = scoreImage({{{0, 1}, {30, 1}}, {{20, 0}, {60, 0}}}, annotated);
  EXPECT_DOUBLE_EQ(summarize({twice}).fragments, 2.0);
  EXPECT_DOUBLE_EQ(summarize({twice}).redundancy, 70.0 / 60.0);
  EXPECT_DOUBLE_EQ(summarize({twice}).segments, 2.0);

  const ImageScore structural = scoreImage({{{100, 2}, {1, 0}}, {{0, 1}, {50, 1}}}, annotated);
  EXPECT_DOUBLE_EQ(structural.structural.precision, 0.5);
  EXPECT_DOUBLE_EQ(structural.structural.recall, 1.0);
}

TEST(Accuracy, MeansOverImagesAreOfPrecisionAndRecall) {
  ImageScore good;
  good.at[1] = {1.0, 0.5};
  ImageScore poor;
  poor.at[1] = {0.0, 0.25};
  const AccuracySummary sum = summarize({good, poor});
  EXPECT_DOUBLE_EQ(sum.at[1].precision, 0.5);
  EXPECT_DOUBLE_EQ(sum.at[1].recall, 0.375);
  EXPECT_DOUBLE_EQ(sum.at[1].f(), 2.0 * 0.5 * 0.375 / 0.875);
  EXPECT_DOUBLE_EQ(summarize({}).at[1].f(), 0.0);
}

// The picture itself found again: what one view shows is what the other shows, at the places the homography
// says.
TEST(Repeatability, PerfectDetectionsRepeatAndShiftedOnesDoNot) {
  const cv::Mat gray(240, 320, CV_8UC1, cv::Scalar(120));
  for (const std::uint64_t seed : {1, 2, 3}) {
    const TwoViews views = makeTwoViews(gray, seed);
    const auto seen = [&](const Eigen::Vector2d& p) {
      return Eigen::Vector2d((views.H_b_a * p.homogeneous()).hnormalized());
    };
    const std::vector<Segment2> a{{{100, 80}, {200, 90}}, {{150, 100}, {140, 180}}};
    std::vector<Segment2> b;
    std::vector<Segment2> shifted;
    for (const Segment2& segment : a) {
      b.push_back({seen(segment.b), seen(segment.a)});
      const Eigen::Vector2d aside =
          2.0 * Eigen::Vector2d(segment.a.y() - segment.b.y(), segment.b.x() - segment.a.x()).normalized();
      shifted.push_back({seen(segment.a + aside), seen(segment.b + aside)});
    }
    const Repeatability perfect = compareViews(views, a, b);
    EXPECT_EQ(perfect.segments, 4);
    EXPECT_DOUBLE_EQ(perfect.structuralShare(), 1.0);
    EXPECT_DOUBLE_EQ(perfect.orthogonalShare(), 1.0);
    EXPECT_NEAR(perfect.localisation_px(), 0.0, 1e-6);
    const Repeatability beside = compareViews(views, a, shifted);
    EXPECT_DOUBLE_EQ(beside.structuralShare(), 1.0);
    EXPECT_DOUBLE_EQ(beside.orthogonalShare(), 0.0);
    EXPECT_NEAR(beside.localisation_px(), 2.0, 1e-6);
    // Outside the common area nothing counts.
    EXPECT_EQ(compareViews(views, {{{0, 0}, {0, 239}}}, {}).segments, 0);
  }
}

TEST(SyntheticScenes, TheTrueEdgesHaveNoErrorAndThoseBesideThemTheirDistance) {
  const SyntheticScene scene = makeScene(3.0, 7);
  ASSERT_EQ(scene.edges.size(), 32u);
  EXPECT_NEAR(endLineError(scene.edges, scene.edges).rms_px(), 0.0, 1e-9);
  std::vector<Segment2> beside = scene.edges;
  for (Segment2& edge : beside) {
    const Eigen::Vector2d aside =
        0.25 * Eigen::Vector2d(edge.a.y() - edge.b.y(), edge.b.x() - edge.a.x()).normalized();
    edge = {edge.b + aside, edge.a + aside};
  }
  EXPECT_EQ(endLineError(beside, scene.edges).ends, 64);
  EXPECT_NEAR(endLineError(beside, scene.edges).rms_px(), 0.25, 1e-9);
}

TEST(YorkUrban, AccuracyAtHalfSize) {
  const auto folder = dataFolder() / "york_urban_half";
  const auto images = loadAnnotated(folder, folder);
  if (images.empty()) GTEST_SKIP() << folder << " is absent (set AVM_DATA)";
  std::cout << "detector F1 F2 F5 sF5 frag segments\n";
  for (const auto& name : segmentDetectorNames()) {
    const auto detector = makeSegmentDetector(name);
    std::vector<ImageScore> scores;
    for (const auto& full : images) {
      const AnnotatedImage image = atWidth(full, 320);
      std::vector<RawSegment> raw;
      detector->detect(image.rgb, raw);
      std::vector<Segment2> found;
      for (const auto& segment : raw) found.push_back(segment.px_raw);
      scores.push_back(scoreImage(found, image.annotated));
    }
    const AccuracySummary sum = summarize(scores);
    std::cout << name << ' ' << sum.at[0].f() << ' ' << sum.at[1].f() << ' ' << sum.at[2].f() << ' '
              << sum.structural.f() << ' ' << sum.fragments << ' ' << sum.segments << '\n';
    // solis: a hundredth under what it reached; the others: what is published for them on the whole set.
    EXPECT_GT(sum.at[1].f(), name == "solis" ? 0.72 : name == "chapter" ? 0.35 : 0.30) << name;
    if (name == "solis") {
      EXPECT_GT(sum.at[0].f(), 0.60);
      EXPECT_LT(sum.fragments, 1.45);
    }
  }
}

}  // namespace
}  // namespace vismem
