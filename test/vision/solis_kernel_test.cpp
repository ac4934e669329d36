// The Solis detector's kernel: the same bits on every processor, and no allocation for a frame.
// Tests V1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/vision/collinear_merge.h"
#include "common/vision/edge_points.h"
#include "common/vision/edge_rows.h"
#include "common/vision/line_runs.h"
#include "common/vision/segment_detector.h"
#include "support/allocations.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

cv::Mat scene(int width, int height, int type, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  cv::Mat image(height, width, type, cv::Scalar::all(110));
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d middle(unit(random) * width, unit(random) * height);
    fillQuad(image, squareAt(middle, 10.0 + unit(random) * 0.4 * width, unit(random) * 3.0),
             cv::Scalar(255.0 * unit(random), 255.0 * unit(random), 255.0 * unit(random)));
  }
  addNoise(image, 4.0, random);
  return image;
}

std::vector<RawSegment> segmentsOf(SegmentDetector& detector, const cv::Mat& image) {
  std::vector<RawSegment> out;
  detector.detect(image, out);
  return out;
}

double xOf(const EdgePoint& point) {
  return point.column() + kEdgePointUnit_px * point.asideX();
}

cv::Mat grayBy(const EdgeRowKernel& kernel, const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat gray(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    kernel.gray(image.ptr<std::uint8_t>(y), image.cols, gray.ptr<std::uint8_t>(y));
  }
  return gray;
}

/// Starts of chains, then possible starts of rings.
std::vector<std::int32_t> startsOf(const EdgePointFinder& finder) {
  const auto room = static_cast<std::size_t>(finder.count() + 2 * kEdgePointBlock);
  std::vector<std::int32_t> starts(room);
  std::vector<std::int32_t> tops(room);
  const EdgeChainEnds found = finder.listStarts(starts.data(), tops.data());
  starts.resize(static_cast<std::size_t>(found.starts));
  starts.insert(starts.end(), tops.begin(), tops.begin() + found.tops);
  return starts;
}

TEST(EdgeRows, EveryKernelGivesTheSameBits) {
  for (const int width : {16, 17, 31, 33, 64, 255, 320, 321, 641, 800, 1111, 1700}) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      const cv::Mat given = scene(width, 60, type, static_cast<std::uint64_t>(width));
      const cv::Mat image = grayBy(portableEdgeRows(), given);
      EdgePointFinder portable(portableEdgeRows());
      portable.find(image, 9.0, true);
      const auto count = static_cast<std::size_t>(portable.count());
      EXPECT_GT(count, 0U);
      for (const EdgeRowKernel* kernel : edgeRowKernels()) {
        EdgePointFinder other(*kernel);
        other.find(grayBy(*kernel, given), 9.0, true);
        const std::string what = std::string(kernel->name) + " at " + std::to_string(width);
        ASSERT_EQ(static_cast<std::size_t>(other.count()), count) << what;
        EXPECT_EQ(std::memcmp(portable.points(), other.points(), count * sizeof(EdgePoint)), 0) << what;
        EXPECT_EQ(std::memcmp(portable.next(), other.next(), count * sizeof(std::int16_t)), 0) << what;
        EXPECT_EQ(std::memcmp(portable.previous(), other.previous(), count), 0) << what;
        EXPECT_EQ(startsOf(other), startsOf(portable)) << what;
      }
    }
  }
}

TEST(LineRuns, EveryKernelGivesTheSameRunsAndPieces) {
  for (const int width : {64, 321, 800}) {
    const cv::Mat image = scene(width, 300, CV_8UC1, static_cast<std::uint64_t>(width));
    std::vector<LineRun> expected_runs;
    std::vector<GroupedSegment> expected_pieces;
    for (const EdgeRowKernel* kernel : edgeRowKernels()) {
      EdgePointFinder edges(*kernel);
      LineRunFinder finder(SolisParams{}, *kernel);
      CollinearMerger merger(*kernel);
      edges.find(image, 9.0, true);
      const std::span<const LineRun> found = finder.find(edges);
      const std::vector<LineRun> runs(found.begin(), found.end());
      std::vector<GroupedSegment> pieces;
      for (const LineRun& run : runs)
        pieces.push_back({{{run.ax_px, run.ay_px}, {run.bx_px, run.by_px}}, 0, 1.0, 0.0});
      merger.merge(pieces, CollinearMergeParams{});
      if (kernel == edgeRowKernels().front()) {
        expected_runs = runs;
        expected_pieces = pieces;
        EXPECT_GT(runs.size(), pieces.size());
        continue;
      }
      ASSERT_EQ(runs.size(), expected_runs.size()) << kernel->name;
      EXPECT_EQ(std::memcmp(runs.data(), expected_runs.data(), runs.size() * sizeof(LineRun)), 0)
          << kernel->name;
      ASSERT_EQ(pieces.size(), expected_pieces.size()) << kernel->name;
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        EXPECT_EQ(pieces[k].px.a, expected_pieces[k].px.a) << kernel->name;
        EXPECT_EQ(pieces[k].px.b, expected_pieces[k].px.b) << kernel->name;
      }
    }
  }
}

// Points know their row modulo 256 only: an edge down 700 rows must not wrap, nor one that begins far below.
TEST(LineRuns, AnEdgeLongerThanPointsCanCountIsWhole) {
  cv::Mat image(900, 64, CV_8UC1, cv::Scalar(50));
  image(cv::Rect(20, 0, 44, 700)) = 114;
  image(cv::Rect(0, 760, 30, 140)) = 180;
  for (const EdgeRowKernel* kernel : edgeRowKernels()) {
    EdgePointFinder edges(*kernel);
    LineRunFinder finder(SolisParams{}, *kernel);
    edges.find(image, 9.0, true);
    bool whole = false;
    bool lower = false;
    for (const LineRun& run : finder.find(edges)) {
      const double top = std::min(run.ay_px, run.by_px);
      const double bottom = std::max(run.ay_px, run.by_px);
      if (std::abs(run.ax_px - 19.5) < 0.1 && std::abs(run.bx_px - 19.5) < 0.1)
        whole |= top < 3.0 && bottom > 695.0;
      if (std::abs(run.ax_px - 29.5) < 0.1 && std::abs(run.bx_px - 29.5) < 0.1)
        lower |= top < 766.0 && bottom > 895.0;
    }
    EXPECT_TRUE(whole) << kernel->name;
    EXPECT_TRUE(lower) << kernel->name;
  }
}

// A step of 64 grey levels between columns 19 and 20: the gradient is [1 3 3 1] of it about 19.5, so the two
// middle columns are equal, and the edge point between them lies at 19.5 by the parabola through 1, 3, 3.
TEST(EdgePoints, WorkedExampleStep) {
  cv::Mat image(32, 40, CV_8UC1, cv::Scalar(50));
  image.colRange(20, 40) = 114;
  EdgePointFinder finder(bestEdgeRows());
  finder.find(image, 9.0, true);
  ASSERT_EQ(finder.count(), 28);  // a row each, but 2 at the top and at the bottom
  for (int i = 0; i < finder.count(); ++i) {
    EXPECT_DOUBLE_EQ(xOf(finder.points()[i]), 19.5);
    EXPECT_EQ(finder.points()[i].row(i), i + 2);
    EXPECT_EQ(finder.points()[i].asideY(), 0);
    EXPECT_EQ(finder.rowBegins()[i + 2], i);
    EXPECT_EQ(finder.points()[i].gx, 48 * 64);
    EXPECT_EQ(finder.points()[i].gy, 0);
    // Bright on the right of the picture: with it on the left the way goes down.
    EXPECT_EQ(finder.next()[i], i + 1 < finder.count() ? 1 : 0);
  }
}

// A bright square on dark: its edge is a ring, which has no beginning but a first point. A step that leaves
// the image is a chain. Links lead from every point but the last one of a chain.
TEST(EdgePoints, ChainsBeginWhereNothingLeadsAndRingsAtTheirFirstPoint) {
  cv::Mat image(60, 100, CV_8UC1, cv::Scalar(50));
  image(cv::Rect(20, 20, 16, 16)) = 114;
  image.colRange(70, 100) = 114;
  EdgePointFinder finder(bestEdgeRows());
  finder.find(image, 9.0, true);
  std::vector<int> followed(static_cast<std::size_t>(finder.count()), 0);
  int ends = 0;
  for (int i = 0; i < finder.count(); ++i) {
    if (finder.next()[i] != 0) ++followed[static_cast<std::size_t>(i + finder.next()[i])];
    ends += finder.next()[i] == 0;
  }
  EXPECT_EQ(ends, 1);
  std::vector<std::int32_t> begins;
  for (int i = 0; i < finder.count(); ++i) {
    EXPECT_EQ(followed[static_cast<std::size_t>(i)], finder.previous()[i] == kNone ? 0 : 1) << i;
    if (followed[static_cast<std::size_t>(i)] == 0) begins.push_back(i);
  }
  ASSERT_EQ(begins.size(), 1U);
  EXPECT_GT(xOf(finder.points()[begins[0]]), 60.0);
  const std::vector<std::int32_t> listed = startsOf(finder);
  ASSERT_GE(listed.size(), 2U);
  EXPECT_EQ(listed[0], begins[0]);
  // The ring's first point is among the others.
  int first_of_ring = 0;
  while (xOf(finder.points()[first_of_ring]) > 60.0) ++first_of_ring;
  EXPECT_NE(std::find(listed.begin() + 1, listed.end(), first_of_ring), listed.end());
}

TEST(EdgePoints, NoiseIsEstimatedWithoutTheEdges) {
  for (const double sigma : {3.0, 10.0, 25.0}) {
    std::mt19937_64 random(4);
    cv::Mat image(240, 320, CV_8UC1, cv::Scalar(120));
    fillQuad(image, squareAt({160, 120}, 120, 0.3), cv::Scalar::all(150));
    addNoise(image, sigma, random);
    EXPECT_NEAR(estimateNoise(image) / sigma, 1.0, 0.1) << sigma;
  }
}

TEST(SolisDetector, AllocatesNothingForAFrame) {
  const auto detector = makeSolisDetector();
  for (const int type : {CV_8UC1, CV_8UC3}) {
    std::vector<cv::Mat> frames;
    for (const std::uint64_t seed : {1, 2, 3, 4}) frames.push_back(scene(320, 240, type, seed));
    std::vector<RawSegment> out;
    out.reserve(1000);
    detector->detect(frames[0], out);
    ASSERT_FALSE(out.empty());
    const long before = test::allocations();
    for (const cv::Mat& frame : frames) detector->detect(frame, out);
    EXPECT_EQ(test::allocations() - before, 0);
  }
}

TEST(SolisDetector, TheSameImageGivesTheSameAfterOtherSizesAndWithAnyStride) {
  const cv::Mat image = scene(321, 239, CV_8UC1, 7);
  const auto detector = makeSolisDetector();
  const auto first = segmentsOf(*detector, image);
  ASSERT_GT(first.size(), 10U);
  cv::Mat large = scene(640, 480, CV_8UC1, 8);
  cv::Mat part = large(cv::Rect(37, 21, 321, 239));
  segmentsOf(*detector, large);
  segmentsOf(*detector, scene(16, 16, CV_8UC3, 9));
  image.copyTo(part);
  for (const auto& again :
       {segmentsOf(*detector, image), segmentsOf(*detector, part), segmentsOf(*makeSolisDetector(), image)}) {
    ASSERT_EQ(again.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(again[i].px_raw.a, first[i].px_raw.a);
      EXPECT_EQ(again[i].px_raw.b, first[i].px_raw.b);
      EXPECT_EQ(again[i].strength, first[i].strength);
    }
  }
}

}  // namespace
}  // namespace vismem
