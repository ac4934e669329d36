#include "active_visual_memory/core/memory/plane_verification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace vismem {
namespace {

constexpr double kHeight_m = 0.45;  // of the camera

FloorSegment segmentOn(const Segment2& line) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = 1e-5 * Eigen::Matrix2d::Identity();
  return segment;
}

/// An edge at a height is projected further from the camera by h / (H - h) of its distance.
FloorSegment seenFrom(const Eigen::Vector2d& camera, const Segment2& edge, double height_m) {
  const double further = kHeight_m / (kHeight_m - height_m);
  return segmentOn({camera + further * (edge.a - camera), camera + further * (edge.b - camera)});
}

/// Drives on to the left past an edge.
void drive(PlaneVerification& plane, const Segment2& edge, double height_m, double from_m, double to_m) {
  for (int i = 0; i <= 10; ++i) {
    const PlaneView view{{0.0, from_m + 0.1 * i * (to_m - from_m)}, kHeight_m, CameraTiltCovariance::Zero()};
    const FloorSegment seen = seenFrom(view.camera, edge, height_m);
    if (i == 0 && from_m == 0.0) plane.begin(FloorLine(seen, {}), view);
    plane.observe(plane.anchor_line, seen, view, {}, {});
  }
}

PlaneVerification verified(const Segment2& edge, double height_m, double way_m) {
  PlaneVerification plane;
  drive(plane, edge, height_m, 0.0, way_m);
  return plane;
}

const Segment2 kOblique{{1.5, -0.4}, {2.0, 0.4}};

}  // namespace

TEST(PlaneVerification, VerifiesWhatRestsWhileTheCameraMoves) {
  const PlaneVerification rests = verified(kOblique, 0.0, 0.6);
  EXPECT_TRUE(rests.isVerified());
  EXPECT_FALSE(rests.stands);
  EXPECT_FALSE(verified(kOblique, 0.0, 0.05).on_floor) << "a step of 5 cm shows nothing";
}

TEST(PlaneVerification, RefutesWhatMovesWithTheCamera) {
  const PlaneVerification high = verified(kOblique, 0.15, 0.6);
  EXPECT_TRUE(high.stands);
  EXPECT_FALSE(high.on_floor);
}

TEST(PlaneVerification, RefutesWhatMovesLater) {
  // An error of odometry or tilt may hide the parallax at first.
  PlaneVerification plane = verified(kOblique, 0.0, 0.2);
  ASSERT_TRUE(plane.isVerified());
  drive(plane, kOblique, 0.15, 0.2, 1.0);
  EXPECT_TRUE(plane.stands);
  EXPECT_FALSE(plane.on_floor);
  PlaneVerification rests = verified(kOblique, 0.0, 0.2);
  drive(rests, kOblique, 0.0, 0.2, 1.0);
  EXPECT_TRUE(rests.isVerified());
}

TEST(PlaneVerification, WhatWasAbsentIsVerifiedAnew) {
  PlaneVerification plane = verified(kOblique, 0.0, 0.6);
  plane.contradict();
  EXPECT_FALSE(plane.on_floor);
  drive(plane, kOblique, 0.0, 0.65, 0.7);
  EXPECT_FALSE(plane.on_floor) << "the views before it do not count";
  drive(plane, kOblique, 0.0, 0.7, 1.1);
  EXPECT_TRUE(plane.isVerified());
  PlaneVerification high = verified(kOblique, 0.15, 0.6);
  high.contradict();
  EXPECT_TRUE(high.stands) << "an absence does not lay it on the floor";
}

TEST(PlaneVerification, NodsOfTheCameraAreNoParallax) {
  // A walking robot: each image has a pitch of its own.
  const auto refuted = [](double stated_rad) {
    std::mt19937 engine(7);
    std::normal_distribution<double> pitch(0.0, 0.01);
    int stands = 0;
    for (int run = 0; run < 100; ++run) {
      PlaneVerification plane;
      for (int i = 0; i <= 10; ++i) {
        PlaneView view{{0.0, 0.06 * i}, kHeight_m, CameraTiltCovariance::Zero()};
        view.P_frame_tilt(1, 1) = stated_rad * stated_rad;
        FloorSegment seen = seenFrom(view.camera, kOblique, 0.0);
        const double nod = pitch(engine);
        for (FloorEnd* const end : {&seen.a, &seen.b}) {
          const Eigen::Vector2d ray = end->p - view.camera;
          end->D.col(1) << -kHeight_m - ray.x() * ray.x() / kHeight_m, -ray.x() * ray.y() / kHeight_m;
          end->p += nod * end->D.col(1);
        }
        if (i == 0) plane.begin(FloorLine(seen, {}), view);
        plane.observe(plane.anchor_line, seen, view, {}, {});
      }
      stands += plane.stands;
    }
    return stands;
  };
  EXPECT_LE(refuted(0.01), 5);
  EXPECT_GE(refuted(0.0), 20) << "the test draws enough";
}

TEST(PlaneVerification, BoundsTheShiftByTheSlopeOfTheParallax) {
  const auto shift = [](const PlaneVerification& plane, double way_m) {
    return plane.possibleShift({{0.0, way_m}, kHeight_m, CameraTiltCovariance::Zero()}, {});
  };
  const double across = std::abs(std::cos(kOblique.direction()));
  EXPECT_NEAR(shift(verified(kOblique, 0.15, 0.05), 0.05), 0.05 * across, 1e-9) << "no slope yet";
  EXPECT_NEAR(shift(verified(kOblique, 0.15, 0.6), 0.6), 0.5 * 0.6 * across, 0.01) << "h / (H - h)";
  EXPECT_EQ(shift(verified(kOblique, 0.0, 0.6), 0.6), 0.0) << "on the floor";
}

TEST(PlaneVerification, AnEdgeAlongTheViewingRayMayBeVertical) {
  PlaneVerification plane;
  const PlaneView view{{0.0, 0.0}, kHeight_m, CameraTiltCovariance::Zero()};
  const FloorSegment radial = segmentOn({{1.0, 0.0}, {2.0, 0.0}});
  plane.begin(FloorLine(radial, {}), view);
  plane.observe(plane.anchor_line, radial, view, {}, {});
  EXPECT_TRUE(plane.mayBeVertical());
  const FloorSegment across = segmentOn({{1.0, 0.0}, {1.0, 1.0}});
  plane.observe(FloorLine(across, {}), across, view, {}, {});
  EXPECT_FALSE(plane.mayBeVertical());
}

}  // namespace vismem
