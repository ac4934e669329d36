#include "active_visual_memory/synthetic_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vismem::testing {
namespace {

Eigen::Vector2d direction(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}
Eigen::Vector2d left(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

}  // namespace

double SyntheticShapes::uniform(double low, double high) {
  return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1.0p-53);
}

double SyntheticShapes::normal(double sigma) {
  const double u = std::max(1e-12, uniform(0.0, 1.0));
  return sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

void SyntheticShapes::hold(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = (to - from).normalized();
  // Short edges are placed as well as long ones; only their direction suffers.
  const auto off = [&] {
    return Eigen::Vector2d(normal(noise_.end_along_m) * along + normal(noise_.end_across_m) * left(along));
  };
  const Eigen::Vector2d a = from + off();
  const Eigen::Vector2d b = to + off();
  MemorySegment segment;
  segment.id = segments_.size() + 1;
  segment.odom = {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}};
  segment.label = "marking";
  segment.confirmed = true;
  segment.life = 50.0;
  segments_.push_back(segment);
}

void SyntheticShapes::edge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool may_break) {
  const double length = (to - from).norm();
  if (may_break && length > 0.4 && uniform(0.0, 1.0) < noise_.broken) {
    const Eigen::Vector2d along = (to - from) / length;
    const double middle = uniform(0.35, 0.65) * length;
    hold(from, from + (middle - 0.5 * noise_.hole_m) * along);
    hold(from + (middle + 0.5 * noise_.hole_m) * along, to);
    return;
  }
  hold(from, to);
}

void SyntheticShapes::stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width_m) {
  const Eigen::Vector2d side = 0.5 * width_m * left((to - from).normalized());
  edge(from - side, to - side, false);  // the bright paint lies left of both
  edge(to + side, from + side, false);
}

void SyntheticShapes::addParallelogram(const Eigen::Vector2d& corner, const Eigen::Vector2d& u,
                                       const Eigen::Vector2d& v) {
  const std::vector<Eigen::Vector2d> p{corner, corner + u, corner + u + v, corner + v};
  const int hidden = noise_.hide_a_corner ? static_cast<int>(uniform(0.0, 4.0)) : -1;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector2d from = p[i];
    Eigen::Vector2d to = p[(i + 1) % 4];
    const bool cut = hidden == i || hidden == (i + 1) % 4;
    if (hidden == i) from += uniform(0.25, 0.5) * (to - from);
    if (hidden == (i + 1) % 4) to += uniform(0.25, 0.5) * (from - to);
    edge(from, to, !cut);
  }
  Primitive truth;
  truth.kind = PrimitiveKind::kParallelogram;
  truth.vertices.assign(p.begin(), p.end());
  truth.hidden_vertex = hidden;
  truth.centre = corner + 0.5 * (u + v);
  truth_.push_back(truth);
}

void SyntheticShapes::addTriangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                  const Eigen::Vector2d& c) {
  edge(a, b);
  edge(b, c);
  edge(c, a);
  Primitive truth;
  truth.kind = PrimitiveKind::kTriangle;
  truth.vertices = {a, b, c};
  truth.centre = (a + b + c) / 3.0;
  truth_.push_back(truth);
}

void SyntheticShapes::addArrow(const Eigen::Vector2d& tail, double heading_rad, double length_m,
                               double head_m, double head_rad, double width_m) {
  const Eigen::Vector2d tip = tail + length_m * direction(heading_rad);
  const Eigen::Vector2d head_left = tip - head_m * direction(heading_rad - head_rad);
  const Eigen::Vector2d head_right = tip - head_m * direction(heading_rad + head_rad);
  // The shaft's edges stop where the heads' paint begins.
  stroke(tail, tip - 0.06 * direction(heading_rad), width_m);
  stroke(tip, head_left, width_m);
  stroke(tip, head_right, width_m);
  Primitive truth;
  truth.kind = PrimitiveKind::kArrow;
  truth.vertices = {tip, tail, head_left, head_right};
  truth.centre = 0.5 * (tip + tail);
  truth_.push_back(truth);
}

void SyntheticShapes::addCircle(const Eigen::Vector2d& centre, double radius_m, double width_m,
                                double chord_m, double share) {
  const double begin = uniform(0.0, 2.0 * std::numbers::pi);
  for (const double side : {1.0, -1.0}) {
    const double radius = radius_m + 0.5 * side * width_m;
    const int chords = std::max(6, static_cast<int>(std::lround(2.0 * std::numbers::pi * radius / chord_m)));
    const int held = static_cast<int>(std::lround(share * chords));
    // A line fitted to an arc cuts it: its ends lie outside by two thirds of the arc's height over its chord.
    const double half = std::numbers::pi / chords;
    const double outward = 2.0 / 3.0 * radius * (1.0 - std::cos(half));
    for (int i = 0; i < held; ++i) {
      const double from = begin + 2.0 * half * i;
      const Eigen::Vector2d a = centre + (radius + outward) * direction(from);
      const Eigen::Vector2d b = centre + (radius + outward) * direction(from + 2.0 * half);
      if (side > 0.0)
        hold(a, b);  // the paint lies inside the outer edge
      else
        hold(b, a);
    }
  }
  Primitive truth;
  truth.kind = PrimitiveKind::kCircle;
  truth.centre = centre;
  truth.radius_m = radius_m;
  truth_.push_back(truth);
}

void SyntheticShapes::addStripe(const Segment2& middle, double width_m) {
  stroke(middle.a, middle.b, width_m);
  Primitive truth;
  truth.kind = PrimitiveKind::kStripe;
  truth.vertices = {middle.a, middle.b};
  truth.centre = middle.middle();
  truth_.push_back(truth);
}

void SyntheticShapes::addClutter(int count, double extent_m) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d from(uniform(-extent_m, extent_m), uniform(-extent_m, extent_m));
    hold(from, from + uniform(0.15, 1.0) * direction(uniform(-std::numbers::pi, std::numbers::pi)));
  }
}

SyntheticShapes SyntheticShapes::room(std::uint64_t seed, const Noise& noise) {
  SyntheticShapes room(seed, noise);
  // Six places of 2.6 x 2.6 m; what stands where is drawn.
  std::vector<Eigen::Vector2d> places;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 2; ++y) places.emplace_back(-2.7 + 2.7 * x, -1.4 + 2.8 * y);
  }
  for (std::size_t i = places.size(); i > 1; --i) {
    std::swap(places[i - 1], places[static_cast<std::size_t>(room.uniform(0.0, static_cast<double>(i)))]);
  }
  const auto angle = [&] { return room.uniform(-std::numbers::pi, std::numbers::pi); };
  for (int i = 0; i < 2; ++i) {
    const double heading = angle();
    const double corner = room.uniform(0.8, 2.3);
    const Eigen::Vector2d u = room.uniform(0.4, 1.2) * direction(heading);
    const Eigen::Vector2d v = room.uniform(0.4, 1.2) * direction(heading + corner);
    room.addParallelogram(places[static_cast<std::size_t>(i)] - 0.5 * (u + v), u, v);
  }
  {
    const double a = angle();
    const Eigen::Vector2d c = places[2];
    room.addTriangle(c + room.uniform(0.4, 0.7) * direction(a),
                     c + room.uniform(0.4, 0.7) * direction(a + room.uniform(1.7, 2.4)),
                     c + room.uniform(0.4, 0.7) * direction(a - room.uniform(1.7, 2.4)));
  }
  {
    const double heading = angle();
    const double length = room.uniform(0.5, 1.0);
    room.addArrow(places[3] - 0.5 * length * direction(heading), heading, length, room.uniform(0.2, 0.35),
                  room.uniform(0.5, 0.9), 0.05);
  }
  room.addCircle(places[4], room.uniform(0.25, 0.8), 0.05, 0.22, 0.9);
  {
    const double heading = angle();
    const Eigen::Vector2d half = room.uniform(0.4, 0.9) * direction(heading);
    room.addStripe({places[5] - half, places[5] + half}, 0.05);
  }
  room.addClutter(12, 4.0);
  return room;
}

bool isNearShape(const Primitive& found, const Primitive& truth, double tolerance_m) {
  if (found.kind != truth.kind) return false;
  if (truth.kind == PrimitiveKind::kCircle) {
    return (found.centre - truth.centre).norm() <= tolerance_m &&
           std::abs(found.radius_m - truth.radius_m) <= tolerance_m;
  }
  const std::size_t n = truth.vertices.size();
  if (found.vertices.size() != n) return false;
  const bool any_start = truth.kind != PrimitiveKind::kArrow;
  for (std::size_t shift = 0; shift < (any_start ? n : 1); ++shift) {
    bool near = true;
    for (std::size_t i = 0; i < n && near; ++i) {
      near = (found.vertices[(i + shift) % n] - truth.vertices[i]).norm() <= tolerance_m;
    }
    if (near) return true;
  }
  return false;
}

}  // namespace vismem::testing
