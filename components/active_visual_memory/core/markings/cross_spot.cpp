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
  const PublishedEdge* edge = nullptr;
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

double offOf(const Piece& piece, const Cross& cross) {
  return (piece.middle - cross.centre - reachOf(piece, cross.arm_m, cross.width_m) * piece.outward).norm();
}

/// Least squares over the middles of the edges, weighted by sightings.
std::optional<Cross> fit(std::span<const Piece> pieces, double width_m) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Piece& piece : pieces) {
    const double weight = std::min(20, piece.edge->element->sightings);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d row(i == 0, i == 1, (piece.slanting ? 0.5 : 1.0) * piece.outward[i]);
      normal += weight * row * row.transpose();
      right += weight * (piece.middle[i] - reachOf(piece, 0.0, width_m) * piece.outward[i]) * row;
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || solver.rcond() < 1e-6) return std::nullopt;
  const Eigen::Vector3d x = solver.solve(right);
  return Cross{x.head<2>(), x.z(), width_m};
}

/// Number of the four slanting edges that were observed.
int slantingEdges(std::span<const Piece> pieces) {
  bool seen[4] = {};
  for (const Piece& piece : pieces) {
    if (piece.slanting) seen[2 * (piece.outward.x() > 0.0) + (piece.outward.y() > 0.0)] = true;
  }
  return static_cast<int>(std::count(std::begin(seen), std::end(seen), true));
}

/// Fits, leaving out the worst edge until all lie within most_off_m. @return empty if it is no cross.
std::optional<Cross> fitCross(std::pmr::vector<Piece>& pieces, double width_m,
                              const CrossSpotParams& params) {
  while (slantingEdges(pieces) >= params.least_slanting) {
    const auto cross = fit(pieces, width_m);
    if (!cross) return std::nullopt;
    const auto worst = std::max_element(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) {
      return offOf(a, *cross) < offOf(b, *cross);
    });
    if (offOf(*worst, *cross) > params.most_off_m) {
      pieces.erase(worst);
      continue;
    }
    int views = 0;
    for (const Piece& piece : pieces) views += piece.edge->element->sightings;
    const double arm_widths = cross->arm_m / width_m;
    const bool is_cross = arm_widths >= params.least_arm_widths && arm_widths <= params.most_arm_widths &&
                          views >= params.least_views;
    return is_cross ? cross : std::nullopt;
  }
  return std::nullopt;
}

/// @param bright  the cross is brighter than the floor.
Piece pieceOf(const PublishedEdge& edge, const Eigen::Rotation2Dd& to_direction, bool bright,
              const CrossSpotParams& params) {
  const Segment2 floor = edge.element->line.segment();
  // The brighter side lies on the left.
  const Eigen::Vector2d outward =
      (bright ? -1.0 : 1.0) * turned90(Eigen::Vector2d(to_direction * edge.element->line.along()));
  Piece piece{&edge, to_direction * floor.middle(), outward.array().sign().matrix(),
              outward.cwiseAbs().minCoeff() > std::sin(params.least_slant_rad)};
  if (!piece.slanting) piece.outward[std::abs(outward.x()) > std::abs(outward.y())] = 0.0;
  return piece;
}

/// Adds the four ends of arms. @param fitted  the edges of the fit, at least one.
void addArmEnds(const Cross& cross, std::span<const Piece> fitted, const Eigen::Rotation2Dd& to_direction,
                bool bright, const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                std::pmr::vector<MemorySegment>& ends) {
  MemorySegment end = *fitted.front().edge->published;
  std::uint64_t oldest = end.id;
  double variance = 0.0;
  end.confirmed = false;
  for (const Piece& piece : fitted) {
    const MemorySegment& value = *piece.edge->published;
    oldest = std::min(oldest, value.id);
    end.life = std::min(end.life, value.life);
    end.last_seen_us = std::max(end.last_seen_us, value.last_seen_us);
    end.confirmed = end.confirmed || piece.edge->element->plane.on_floor;
    const double both = (value.P_a + value.P_b).topLeftCorner<2, 2>().trace();
    variance += 0.25 * both / static_cast<double>(fitted.size());
  }
  end.uncertainty = uncertaintyOf(end.life);
  // Isotropic covariance: the end does not lie along one of the edges.
  end.P_a.setZero();
  end.P_a.topLeftCorner<2, 2>() = variance * Eigen::Matrix2d::Identity();
  end.P_b = end.P_a;
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();
  for (int n = 0; n < 4; ++n, outward = turned90(outward)) {
    const Eigen::Vector2d middle = cross.centre + cross.arm_m * outward;
    const Eigen::Vector2d half = (bright ? 0.5 : -0.5) * cross.width_m * turned90(outward);
    end.id = id_of(oldest, n);
    placeAt(end, {to_direction.inverse() * (middle - half), to_direction.inverse() * (middle + half)});
    ends.push_back(end);
  }
}

}  // namespace

void replaceCrossSpots(std::vector<MemorySegment>& segments, std::span<const PublishedEdge> edges,
                       const LineWidths& widths, const DominantDirectionParams& dominant_direction,
                       const CrossSpotParams& params,
                       const std::function<std::uint64_t(std::uint64_t, int)>& id_of,
                       std::pmr::memory_resource* scratch) {
  if (widths.empty()) return;
  DominantDirection place(dominant_direction);
  for (const PublishedEdge& edge : edges) {
    if (edge.confirmed()) place.add(edge.line.direction(), edge.length());
  }
  const auto direction_rad = place.direction();
  if (!direction_rad) return;
  const Eigen::Rotation2Dd to_direction(-*direction_rad);

  std::pmr::vector<MemorySegment> ends(scratch);
  std::pmr::vector<std::uint64_t> replaced(scratch);
  for (const auto& [label, signed_width] : widths) {
    const double width = std::abs(signed_width);
    std::pmr::vector<Piece> pieces(scratch);
    for (const PublishedEdge& edge : edges) {
      if (edge.published->label != label || !edge.element || edge.element->plane.stands) continue;
      if (edge.element->line.length() > params.most_edge_m) continue;
      pieces.push_back(pieceOf(edge, to_direction, signed_width > 0.0, params));
    }
    const auto isReplaced = [&](const Piece& piece) {
      return std::find(replaced.begin(), replaced.end(), piece.edge->published->id) != replaced.end();
    };
    for (const Piece& first : pieces) {
      if (!first.slanting || isReplaced(first)) continue;
      // First guess of the centre: arms as long as the line is wide.
      const Eigen::Vector2d about = first.middle - reachOf(first, width, width) * first.outward;
      std::pmr::vector<Piece> fitted(scratch);
      std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(fitted), [&](const Piece& piece) {
        return !isReplaced(piece) && (piece.middle - about).norm() <= params.most_reach_m;
      });
      const std::pmr::vector<Piece> near(fitted, scratch);
      const auto cross = fitCross(fitted, width, params);
      if (!cross) continue;
      const Eigen::Vector2d centre = to_direction.inverse() * cross->centre;
      const bool joins = std::any_of(edges.begin(), edges.end(), [&](const PublishedEdge& edge) {
        return edge.published->label == label && edge.length() >= params.alone_m &&
               distanceToSegment(centre, edge.line) <= params.alone_reach_m;
      });
      if (joins) continue;
      addArmEnds(*cross, fitted, to_direction, signed_width > 0.0, id_of, ends);
      // Edges left out of the fit stay, unless they lie on the cross.
      for (const Piece& piece : near) {
        const bool is_of_it =
            std::any_of(fitted.begin(), fitted.end(), [&](const Piece& f) { return f.edge == piece.edge; });
        const bool lies_on_it = (piece.middle - cross->centre).cwiseAbs().maxCoeff() <= cross->arm_m;
        if (is_of_it || lies_on_it) replaced.push_back(piece.edge->published->id);
      }
    }
  }
  eraseSegments(segments, replaced);
  segments.insert(segments.end(), ends.begin(), ends.end());
}

}  // namespace vismem
