#include "localization/core/hypotheses/landmark_explorers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kCornerAngle_rad = degToRad(25);    // two directions
constexpr double kStraightAngle_rad = degToRad(12);  // one line
constexpr double kAngleBin_rad = degToRad(20);
constexpr double kAngleTolerance_rad = degToRad(20);
constexpr double kMapGap_m = 0.05;
constexpr double kSeenGap_m = 0.25;
constexpr double kShortestArm_m = 0.1;
constexpr double kLongestDoor_m = 2.5;  // longer segments are rarely seen whole
constexpr double kLengthTolerance_m = 0.12;
constexpr double kLengthTolerance = 0.1;
constexpr double kSameVertex_m = 0.15;
/// Largest number of observed segments whose pairs are formed: the cost grows with its square.
constexpr std::size_t kSegments = 24;
constexpr std::size_t kFew = 256;     // map landmarks of one kind that are compared exhaustively
constexpr std::size_t kSample = 128;  // largest and smallest sample of more
constexpr std::size_t kLeast = 16;
constexpr std::size_t kAhead = 8;  // elements of the sample that are prefetched

struct Arm {
  Eigen::Vector2d vector;
  double length;
};

/// The parts of a segment on either side of a point on (or near) it.
std::vector<Arm> armsFrom(const Eigen::Vector2d& vertex, const Segment2& segment) {
  std::vector<Arm> arms;
  for (const Eigen::Vector2d& end : {segment.a, segment.b}) {
    const Eigen::Vector2d vector = end - vertex;
    if (vector.norm() >= kShortestArm_m) arms.push_back({vector, vector.norm()});
  }
  // With both ends on one side of the vertex only the longer arm counts.
  if (arms.size() == 2 && arms[0].vector.dot(arms[1].vector) > 0.0) {
    arms.erase(arms.begin() + (arms[0].length < arms[1].length ? 0 : 1));
  }
  return arms;
}

void appendArms(const Eigen::Vector2d& vertex, std::span<const Arm> of_a, std::span<const Arm> of_b,
                int label_a, int label_b, std::vector<JunctionLandmark>& out) {
  for (const Arm& a : of_a) {
    for (const Arm& b : of_b) {
      const double direction = std::atan2(a.vector.y(), a.vector.x());
      out.push_back({vertex, direction, angleDifference(std::atan2(b.vector.y(), b.vector.x()), direction),
                     a.length, b.length, label_a, label_b});
    }
  }
}

bool similarLength(double a, double b) {
  return std::abs(a - b) <= kLengthTolerance_m + kLengthTolerance * std::min(a, b);
}

int angleBin(double turn) {
  return static_cast<int>(std::floor(turn / kAngleBin_rad));
}

/// Pairs of segments with points in one cell of 1 m.
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearPairs(std::span<const LandmarkSegment> segments) {
  constexpr double kCell_m = 1.0;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    const Segment2& plan = segments[i].plan;
    const int steps = static_cast<int>(plan.length() / (0.5 * kCell_m)) + 1;
    std::uint64_t last = ~std::uint64_t{0};
    for (int k = 0; k <= steps; ++k) {
      const Eigen::Vector2d p = plan.a + static_cast<double>(k) / steps * (plan.b - plan.a);
      // A point near a border belongs to the neighbouring cell, too.
      for (const double dx : {-kMapGap_m, kMapGap_m}) {
        for (const double dy : {-kMapGap_m, kMapGap_m}) {
          const auto x =
              static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor((p.x() + dx) / kCell_m)));
          const auto y =
              static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor((p.y() + dy) / kCell_m)));
          const std::uint64_t key = (std::uint64_t{x} << 32) | y;
          if (key == last) continue;
          last = key;
          auto& cell = cells[key];
          if (cell.empty() || cell.back() != i) cell.push_back(i);
        }
      }
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [key, members] : cells) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = i + 1; j < members.size(); ++j) {
        pairs.emplace_back(std::min(members[i], members[j]), std::max(members[i], members[j]));
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
  return pairs;
}

}  // namespace

void appendJunctions(const LandmarkSegment& s, const LandmarkSegment& t, double gap_m,
                     std::vector<JunctionLandmark>& out) {
  const Eigen::Vector2d along_s = s.plan.b - s.plan.a;
  const Eigen::Vector2d along_t = t.plan.b - t.plan.a;
  const double angle = lineAngleDifference(s.plan.direction(), t.plan.direction());
  if (angle >= kCornerAngle_rad) {
    const double fraction = cross2(t.plan.a - s.plan.a, along_t) / cross2(along_s, along_t);
    const Eigen::Vector2d vertex = s.plan.a + fraction * along_s;
    if (distanceToSegment(vertex, s.plan) > gap_m || distanceToSegment(vertex, t.plan) > gap_m) return;
    appendArms(vertex, armsFrom(vertex, s.plan), armsFrom(vertex, t.plan), s.label, t.label, out);
  } else if (angle <= kStraightAngle_rad && s.label != t.label) {
    for (const bool s_by_a : {true, false}) {
      for (const bool t_by_a : {true, false}) {
        const Eigen::Vector2d& end_s = s_by_a ? s.plan.a : s.plan.b;
        const Eigen::Vector2d& end_t = t_by_a ? t.plan.a : t.plan.b;
        if ((end_s - end_t).norm() > gap_m) continue;
        const Eigen::Vector2d out_s = s_by_a ? along_s : Eigen::Vector2d(-along_s);
        const Eigen::Vector2d out_t = t_by_a ? along_t : Eigen::Vector2d(-along_t);
        if (out_s.dot(out_t) >= 0.0) continue;  // parallel, on one side
        const Arm arm_s{out_s, out_s.norm()};
        const Arm arm_t{out_t, out_t.norm()};
        if (std::min(arm_s.length, arm_t.length) < kShortestArm_m) continue;
        appendArms(0.5 * (end_s + end_t), {&arm_s, 1}, {&arm_t, 1}, s.label, t.label, out);
      }
    }
  }
}

std::uint64_t LandmarkExplorers::key(int label_a, int label_b, int angle_bin) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(label_a)) << 40) |
         (static_cast<std::uint64_t>(static_cast<std::uint32_t>(label_b)) << 16) |
         static_cast<std::uint64_t>(static_cast<std::uint16_t>(angle_bin + 64));
}

LandmarkExplorers::LandmarkExplorers(const MapIndex& map, const LandmarkKinds& kinds) : kinds_(kinds) {
  std::vector<LandmarkSegment> segments;
  for (int label = 0; label < map.labelCount(); ++label) {
    std::vector<Line> lines;
    for (const Segment2& plan : map.floor(label)) {
      segments.push_back({plan, label});
      const double length = plan.length();
      if (length >= kShortestArm_m && length <= kLongestDoor_m) lines.push_back({plan, length});
    }
    std::stable_sort(lines.begin(), lines.end(),
                     [](const Line& a, const Line& b) { return a.length < b.length; });
    by_length_.push_back(std::move(lines));
  }
  std::vector<JunctionLandmark> all;
  for (const auto& [i, j] : nearPairs(segments)) {
    appendJunctions(segments[i], segments[j], kMapGap_m, all);
    appendJunctions(segments[j], segments[i], kMapGap_m, all);
  }
  for (const JunctionLandmark& junction : all) {
    junctions_[key(junction.label_a, junction.label_b, angleBin(junction.turn))].push_back(junction);
  }
  indexParallelograms(all);
}

/// Corners of which the fourth vertex of their parallelogram is the vertex of another corner.
void LandmarkExplorers::indexParallelograms(std::span<const JunctionLandmark> junctions) {
  std::unordered_map<std::uint64_t, std::vector<Eigen::Vector2d>> vertices;  // of corners
  const auto cell = [](const Eigen::Vector2d& p, int dx, int dy) {
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(p.x())) + dx);
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(p.y())) + dy);
    return (std::uint64_t{x} << 32) | y;
  };
  for (const JunctionLandmark& junction : junctions) {
    if (std::abs(junction.turn) < std::numbers::pi - kCornerAngle_rad) {
      vertices[cell(junction.vertex, 0, 0)].push_back(junction.vertex);
    }
  }
  const auto isVertex = [&](const Eigen::Vector2d& p) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = vertices.find(cell(p, dx, dy));
        if (found == vertices.end()) continue;
        for (const Eigen::Vector2d& vertex : found->second) {
          if ((vertex - p).norm() <= kSameVertex_m) return true;
        }
      }
    }
    return false;
  };
  for (const JunctionLandmark& junction : junctions) {
    if (junction.turn <= 0.0 || junction.turn > std::numbers::pi - kCornerAngle_rad) continue;
    const double direction_b = junction.direction_a + junction.turn;
    const Eigen::Vector2d opposite =
        junction.vertex +
        junction.length_a * Eigen::Vector2d(std::cos(junction.direction_a), std::sin(junction.direction_a)) +
        junction.length_b * Eigen::Vector2d(std::cos(direction_b), std::sin(direction_b));
    if (isVertex(opposite)) parallelogram_corners_.push_back(junction);
  }
}

/// Visits map landmarks of one kind: all of a few, else a sample. In a large map landmarks repeat, and a
/// different sample per search finds the robot as well as all of them.
class LandmarkExplorers::Sampler {
 public:
  Sampler(std::size_t sample, RandomEngine& engine) : sample_(sample), engine_(engine) {}

  template <typename T, typename Use>
  void visit(std::span<const T> all, const Use& use) {
    const std::size_t step = all.size() < kFew ? 1 : all.size() / sample_;
    const std::size_t begin = step > 1 ? vismem::pick(engine_, step) : 0;
    for (std::size_t i = begin; i < all.size(); i += step) {
      // The stride exceeds what the processor prefetches by itself.
      if (step > 1 && i + kAhead * step < all.size()) __builtin_prefetch(&all[i + kAhead * step]);
      use(all[i]);
    }
  }

 private:
  std::size_t sample_;
  RandomEngine& engine_;
};

void LandmarkExplorers::Proposals::add(Seen seen) {
  if (seen.world.empty()) return;
  count_ += seen.world.size();
  seen_.push_back(std::move(seen));
}

LandmarkExplorers::Proposals LandmarkExplorers::match(const FloorObservation& observation, int explorers,
                                                      RandomEngine& engine) const {
  Proposals proposals;
  std::vector<ObservedSegment> segments = observation.segments;
  std::stable_sort(segments.begin(), segments.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  if (segments.size() > kSegments) segments.resize(kSegments);
  std::vector<JunctionLandmark> junctions;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      appendJunctions({segments[i].robot, segments[i].label}, {segments[j].robot, segments[j].label},
                      kSeenGap_m, junctions);
    }
  }
  // Each observed landmark is drawn by an equal share of the explorers.
  const std::size_t seen_count = junctions.size() + segments.size() + observation.parallelograms.size();
  const std::size_t sample =
      seen_count > 0
          ? std::clamp(static_cast<std::size_t>(std::max(0, explorers)) / seen_count, kLeast, kSample)
          : kSample;
  Sampler sampler(sample, engine);
  matchJunctions(junctions, sampler, proposals);
  if (kinds_.doors) matchLengths(segments, sampler, proposals);
  if (kinds_.parallelograms) {
    for (const auto& corners : observation.parallelograms) matchParallelogram(corners, sampler, proposals);
  }
  return proposals;
}

void LandmarkExplorers::matchJunctions(std::span<const JunctionLandmark> seen, Sampler& sampler,
                                       Proposals& proposals) const {
  for (const JunctionLandmark& junction : seen) {
    const bool is_corner = std::abs(junction.turn) < std::numbers::pi - kStraightAngle_rad;
    if (is_corner ? !kinds_.corners : !kinds_.doors) continue;
    Proposals::Seen one{{junction.vertex, junction.direction_a + 0.5 * junction.turn}, {}};
    const int middle = angleBin(junction.turn);
    std::set<int> bins{middle - 1, middle, middle + 1};
    if (!is_corner) bins.insert({angleBin(-std::numbers::pi), angleBin(std::numbers::pi)});
    for (const int bin : bins) {
      const auto found = junctions_.find(key(junction.label_a, junction.label_b, bin));
      if (found == junctions_.end()) continue;
      sampler.visit(std::span<const JunctionLandmark>(found->second), [&](const JunctionLandmark& world) {
        const double difference = angleDifference(world.turn, junction.turn);
        if (std::abs(difference) > kAngleTolerance_rad) return;
        // The heading comes from both arms: their bisector.
        one.world.push_back({world.vertex, world.direction_a + 0.5 * (junction.turn + difference)});
      });
    }
    proposals.add(std::move(one));
  }
}

void LandmarkExplorers::matchLengths(std::span<const ObservedSegment> segments, Sampler& sampler,
                                     Proposals& proposals) const {
  for (const ObservedSegment& segment : segments) {
    const double length = segment.robot.length();
    const auto& lines = by_length_[static_cast<std::size_t>(segment.label)];
    Proposals::Seen one{{segment.robot.middle(), segment.robot.direction()}, {}};
    const auto first =
        std::lower_bound(lines.begin(), lines.end(), length / (1.0 + kLengthTolerance) - kLengthTolerance_m,
                         [](const Line& line, double least) { return line.length < least; });
    const auto last = std::lower_bound(first, lines.end(), length * 2.0,
                                       [](const Line& line, double most) { return line.length < most; });
    sampler.visit(std::span<const Line>(first, last), [&](const Line& line) {
      if (!similarLength(line.length, length)) return;
      const double direction = line.plan.direction();
      one.world.push_back({line.plan.middle(), direction});
      one.world.push_back({line.plan.middle(), direction + std::numbers::pi});
    });
    proposals.add(std::move(one));
  }
}

void LandmarkExplorers::matchParallelogram(const std::array<Eigen::Vector2d, 4>& corners, Sampler& sampler,
                                           Proposals& proposals) const {
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d a = corners[(k + 1) % 4] - corners[k];
    const Eigen::Vector2d b = corners[(k + 3) % 4] - corners[k];
    const double direction_a = std::atan2(a.y(), a.x());
    const double turn = angleDifference(std::atan2(b.y(), b.x()), direction_a);
    Proposals::Seen one{{corners[k], direction_a + 0.5 * turn}, {}};
    sampler.visit(std::span<const JunctionLandmark>(parallelogram_corners_),
                  [&](const JunctionLandmark& world) {
                    if (similarLength(world.length_a, a.norm()) && similarLength(world.length_b, b.norm()) &&
                        std::abs(world.turn - turn) <= kAngleTolerance_rad) {
                      one.world.push_back({world.vertex, world.direction_a + 0.5 * world.turn});
                    }
                  });
    proposals.add(std::move(one));
  }
}

Pose2 LandmarkExplorers::Proposals::pick(RandomEngine& engine) const {
  // The observed landmark is drawn first: a common landmark does not suppress a rare one.
  const Seen& seen = seen_[vismem::pick(engine, seen_.size())];
  const Anchor& world = seen.world[vismem::pick(engine, seen.world.size())];
  const double heading = wrapAngle(world.direction - seen.robot.direction);
  const Eigen::Vector2d arm = transform(Pose2{0.0, 0.0, heading}, seen.robot.point);
  return {world.point.x() - arm.x(), world.point.y() - arm.y(), heading};
}

}  // namespace vismem
