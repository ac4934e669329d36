#include "active_visual_memory/core/markings/cross_spot.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "active_visual_memory/core/memory/life.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// An edge that may belong to a cross, in the frame of the dominant direction.
struct Piece {
  const MemoryElement* element = nullptr;
  Eigen::Vector2d middle;
  Eigen::Vector2d outward;  ///< of unit length, across an arm's end; or both components +-1, from arm to arm
  bool slanting = false;
};

struct Cross {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double arm_m = 0.0;  ///< from the centre to an arm's end
  double width_m = 0.0;
};

/// Distance of the middle of an edge from the centre, along `outward`.
double reachOf(const Piece& piece, double arm_m, double width_m) {
  return piece.slanting ? 0.5 * (arm_m + 0.5 * width_m) : arm_m;
}

Eigen::Vector2d offOf(const Piece& piece, const Cross& cross) {
  return piece.middle - cross.centre - reachOf(piece, cross.arm_m, cross.width_m) * piece.outward;
}

/// Least squares over the middles of the edges, weighted by sightings.
std::optional<Cross> fit(const std::vector<Piece>& pieces, double width_m) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Piece& piece : pieces) {
    const double weight = std::min(20, piece.element->sightings);
    const double known = reachOf(piece, 0.0, width_m);
    const double share = piece.slanting ? 0.5 : 1.0;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d row(i == 0, i == 1, share * piece.outward[i]);
      normal += weight * row * row.transpose();
      right += weight * (piece.middle[i] - known * piece.outward[i]) * row;
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || solver.rcond() < 1e-6) return std::nullopt;
  const Eigen::Vector3d x = solver.solve(right);
  return Cross{x.head<2>(), x.z(), width_m};
}

/// Number of the four slanting edges that were observed.
int slantingEdges(const std::vector<Piece>& pieces) {
  bool seen[2][2] = {};
  for (const Piece& piece : pieces) {
    if (piece.slanting) seen[piece.outward.x() > 0.0][piece.outward.y() > 0.0] = true;
  }
  return seen[0][0] + seen[0][1] + seen[1][0] + seen[1][1];
}

/// Fits, leaving out the worst edge until all lie within most_off_m.
std::optional<Cross> fitMost(std::vector<Piece>& pieces, double width_m, const CrossSpotParams& params) {
  while (slantingEdges(pieces) >= params.least_slanting) {
    const auto cross = fit(pieces, width_m);
    if (!cross) return std::nullopt;
    const auto worst = std::max_element(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) {
      return offOf(a, *cross).norm() < offOf(b, *cross).norm();
    });
    if (offOf(*worst, *cross).norm() <= params.most_off_m) return cross;
    pieces.erase(worst);
  }
  return std::nullopt;
}

bool isCross(const Cross& cross, const std::vector<Piece>& pieces, const CrossSpotParams& params) {
  const double arm_widths = cross.arm_m / cross.width_m;
  int views = 0;
  for (const Piece& piece : pieces) views += piece.element->sightings;
  return arm_widths >= params.least_arm_widths && arm_widths <= params.most_arm_widths &&
         views >= params.least_views;
}

/// @param bright  the cross is brighter than the floor.
Piece pieceOf(const MemoryElement& element, const Eigen::Rotation2Dd& to_direction, bool bright,
              const CrossSpotParams& params) {
  const Segment2 floor = element.line.segment();
  Piece piece;
  piece.element = &element;
  piece.middle = to_direction * floor.middle();
  // The brighter side lies on the left.
  const Eigen::Vector2d along = to_direction * (floor.b - floor.a).normalized();
  const Eigen::Vector2d outward = (bright ? 1.0 : -1.0) * Eigen::Vector2d(along.y(), -along.x());
  const double least = std::sin(params.least_slant_rad);
  piece.slanting = outward.cwiseAbs().minCoeff() > least;
  for (int i = 0; i < 2; ++i) {
    const bool counts = piece.slanting || std::abs(outward[i]) > std::abs(outward[1 - i]);
    piece.outward[i] = counts ? std::copysign(1.0, outward[i]) : 0.0;
  }
  return piece;
}

/// Crosses of one label: replaced edges and published arm ends.
struct CrossSpotEnds {
  std::vector<std::uint64_t> replaced;
  std::vector<MemorySegment> ends;

  bool has(const Piece& piece) const {
    return std::find(replaced.begin(), replaced.end(), piece.element->value.id) != replaced.end();
  }
};

/// @param fitted  the edges of the fit, at least one.
void publishEnds(const Cross& cross, const std::vector<Piece>& fitted, const Eigen::Rotation2Dd& to_direction,
                 bool bright, const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                 CrossSpotEnds& published) {
  const MemorySegment* newest = &fitted.front().element->value;
  std::uint64_t oldest = newest->id;
  bool on_floor = false;
  double life = newest->life;
  double variance = 0.0;
  for (const Piece& piece : fitted) {
    const MemorySegment& value = piece.element->value;
    life = std::min(life, value.life);
    const double both = (value.P_a + value.P_b).topLeftCorner<2, 2>().trace();
    variance += 0.25 * both / static_cast<double>(fitted.size());
    if (value.last_seen_us > newest->last_seen_us) newest = &value;
    oldest = std::min(oldest, value.id);
    on_floor = on_floor || piece.element->on_floor;
  }
  const Eigen::Vector2d outwards[] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
  for (int n = 0; n < 4; ++n) {
    const Eigen::Vector2d& outward = outwards[n];
    const Eigen::Vector2d middle = cross.centre + cross.arm_m * outward;
    const Eigen::Vector2d half = (bright ? 0.5 : -0.5) * cross.width_m * turned90(outward);
    MemorySegment end = *newest;
    end.life = life;
    end.uncertainty = uncertaintyOf(life);
    // Isotropic covariance: the end does not lie along the newest edge.
    for (Eigen::Matrix3d* P : {&end.P_a, &end.P_b}) {
      P->topLeftCorner<2, 2>() = variance * Eigen::Matrix2d::Identity();
      P->topRightCorner<2, 1>().setZero();
      P->bottomLeftCorner<1, 2>().setZero();
    }
    end.confirmed = on_floor;
    end.id = id_of(oldest, n);
    end.odom.a.head<2>() = to_direction.inverse() * (middle - half);
    end.odom.b.head<2>() = to_direction.inverse() * (middle + half);
    published.ends.push_back(std::move(end));
  }
}

}  // namespace

void replaceCrossSpots(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                       const LineWidths& widths, const DominantDirectionParams& dominant_direction,
                       const CrossSpotParams& params,
                       const std::function<std::uint64_t(std::uint64_t, int)>& id_of) {
  if (!params.enabled || widths.empty() || dominant_direction.sigma_rad <= 0.0) return;
  DominantDirection place(dominant_direction);
  for (const MemorySegment& segment : segments) {
    const Segment2 floor = segment.odom.floor();
    if (segment.confirmed) place.add(floor.direction(), floor.length());
  }
  const auto dominant_direction_rad = place.direction();
  if (!dominant_direction_rad) return;
  const Eigen::Rotation2Dd to_direction(-*dominant_direction_rad);

  for (const auto& [label, signed_width] : widths) {
    const bool bright = signed_width > 0.0;
    const double width = std::abs(signed_width);
    std::vector<Piece> pieces;
    std::vector<Segment2> longer;
    for (const MemorySegment& segment : segments) {
      if (segment.label != label) continue;
      const Segment2 floor = segment.odom.floor();
      if (floor.length() >= params.alone_m)
        longer.push_back({to_direction * floor.a, to_direction * floor.b});
      const MemoryElement* element = findElement(elements, segment.id);
      if (!element || element->stands) continue;
      if (element->line.length() > params.most_edge_m) continue;
      pieces.push_back(pieceOf(*element, to_direction, bright, params));
    }
    CrossSpotEnds published;
    for (const Piece& first : pieces) {
      if (!first.slanting || published.has(first)) continue;
      // First guess of the centre: arms as long as the line is wide.
      const Eigen::Vector2d about = first.middle - reachOf(first, width, width) * first.outward;
      std::vector<Piece> near;
      std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(near), [&](const Piece& piece) {
        return !published.has(piece) && (piece.middle - about).norm() <= params.most_reach_m;
      });
      std::vector<Piece> fitted = near;
      const auto cross = fitMost(fitted, width, params);
      if (!cross || !isCross(*cross, fitted, params)) continue;
      const bool alone = std::none_of(longer.begin(), longer.end(), [&](const Segment2& line) {
        return distanceToSegment(cross->centre, line) <= params.alone_reach_m;
      });
      if (!alone) continue;
      publishEnds(*cross, fitted, to_direction, bright, id_of, published);
      // Edges left out of the fit stay, unless they lie on the cross.
      for (const Piece& piece : near) {
        const bool is_of_it = std::any_of(fitted.begin(), fitted.end(),
                                          [&](const Piece& f) { return f.element == piece.element; });
        const bool lies_on_it = (piece.middle - cross->centre).cwiseAbs().maxCoeff() <= cross->arm_m;
        if (is_of_it || lies_on_it) published.replaced.push_back(piece.element->value.id);
      }
    }
    std::erase_if(segments, [&](const MemorySegment& s) {
      return std::find(published.replaced.begin(), published.replaced.end(), s.id) !=
             published.replaced.end();
    });
    segments.insert(segments.end(), published.ends.begin(), published.ends.end());
  }
}

}  // namespace vismem
