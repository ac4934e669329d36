#include "mapper/core/drive_mapper.h"

#include <algorithm>

#include "mapper/core/map_output.h"

namespace vismem {

DriveMapperParams DriveMapperParams::of(const AttentiveVisualMemoryParams& memory,
                                        const LocalizerParams& localizer) {
  DriveMapperParams params;
  params.landmarks.confirmed_only = memory.primitives.finder.confirmed_only;
  params.graph.odometry = memory.memory.estimation.map_filter.odometry;
  params.graph.tilt = memory.memory.estimation.tilt_prior;
  const bool is_legged = params.graph.tilt.per_frame_rad >= memory.memory.estimation.min_legged_tilt_rad;
  if (is_legged) params.graph.lever_m = memory.memory.estimation.map_filter.gait_height_m;
  params.graph.timing_s = memory.projector.timing_sigma_s;
  params.closing.localizer = localizer;
  params.corners.obstacles = params.merge.obstacles = localizer.map.opaque_labels;
  return params;
}

namespace {

/// Removes landmarks that their sightings contradict: they stand off the floor or move.
int dropContradicted(const DriveRecord& record, const DriveMapperParams& params, MapState& state) {
  const auto before = state.landmarks.size();
  std::erase_if(state.landmarks, [&](const LineLandmark& landmark) {
    std::vector<double> errors = lineErrors(record, params.graph, state, landmark);
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle > params.most_error_px;
  });
  return static_cast<int>(before - state.landmarks.size());
}

/// Landmarks that were out of sight for more than a way.
int seenAgain(const DriveRecord& record, const MapState& state, double apart_m) {
  return static_cast<int>(
      std::count_if(state.landmarks.begin(), state.landmarks.end(), [&](const LineLandmark& landmark) {
        const auto& seen = landmark.seen;
        return std::adjacent_find(seen.begin(), seen.end(), [&](const auto& one, const auto& next) {
                 return wayAt(record, next) - wayAt(record, one) > apart_m;
               }) != seen.end();
      }));
}

void recentreAll(MapState& state) {
  for (LineLandmark& landmark : state.landmarks) landmark.recentre();
}

/// The drive in the making.
class Mapping {
 public:
  Mapping(const DriveRecord& record, const DriveMapperParams& params)
      : record_(record), params_(params), graph_(params.graph) {
    map_.state = initialState(record, params.landmarks);
    for (const Keyframe& keyframe : record.keyframes) ways_.push_back(keyframe.way_m);
  }

  DriveMap run(const std::vector<MemoryUpdate>& updates, const std::vector<Closing>& accepted,
               const MappingProgress& progress) {
    if (map_.state.landmarks.empty()) {
      map_.problem = "no edge on the floor was confirmed";
      return std::move(map_);
    }
    const bool has_right_angles =
        params_.right_angles && alignHeadings(record_, params_.graph.odometry, params_.heading, map_.state);
    for (const bool ends : {false, true}) {
      if (!solve({.ends = ends, .right_angles = has_right_angles})) return std::move(map_);
    }
    map_.dropped += dropContradicted(record_, params_, map_.state);
    map_.dropped += dropUprights(record_, params_.ends, params_.landmarks.min_sightings, map_.state);
    map_.dropped += dropRaised(record_, params_.ends, map_.state);
    if (!settle()) return std::move(map_);
    if (params_.close && !updates.empty()) close(updates, progress);
    if (!accepted.empty()) {
      map_.closings = accepted;
      if (!closeGraph()) return std::move(map_);
    }
    dropRefuted();
    takeCircles(record_, params_.circles, map_.state);
    if (!solve({.kernel = params_.kernel})) return std::move(map_);
    updateEnds(record_, params_.ends, map_.state);
    const DriveMap unfinished = map_;
    const GraphParams unfinished_graph = graph_;
    finish({});
    map_.T_map_world = mapFrameOf(map_.state);
    if (params_.edits.empty()) return std::move(map_);
    const Pose2 T_start_map = inverse(map_.T_map_world * map_.state.poses.front());
    map_ = unfinished;
    graph_ = unfinished_graph;
    finish(params_.edits);
    map_.T_map_world = inverse(map_.state.poses.front() * T_start_map);
    return std::move(map_);
  }

 private:
  bool solve(const SolveStage& stage) {
    const SolveReport report = solveGraph(record_, graph_, stage, map_.state, map_.closings);
    if (report.usable && stage.ends) graph_ = measured(graph_, report);
    map_.seconds += report.seconds;
    if (!report.usable) map_.problem = report.problem;
    recentreAll(map_.state);
    return report.usable;
  }

  /// Ends and extents by what single images showed, and what is one edge; then again, until nothing is
  /// merged: each merge brings the visits of a place nearer to each other. @return false when the solver
  /// failed.
  bool settle() {
    constexpr int kMostRounds = 10;
    for (int round = 0; round < kMostRounds; ++round) {
      updateEnds(record_, params_.ends, map_.state);
      map_.cut += cutOverlaps(record_, params_.overlap, map_.state);
      const int merged = merge(params_.merge);
      if (!solve({.kernel = params_.kernel})) return false;
      if (merged == 0) break;
    }
    return true;
  }

  /// What the memory refuted after a few images, and no other landmark took over.
  void dropRefuted() {
    map_.dropped += static_cast<int>(std::erase_if(map_.state.landmarks, [&](const LineLandmark& landmark) {
      return landmark.dropped && static_cast<int>(landmark.seen.size()) < params_.sure_sightings;
    }));
  }

  int merge(const LandmarkMergeParams& params) {
    const int merged = mergeLandmarks(record_, params, map_.state);
    map_.merged += merged;
    return merged;
  }

  /// Circles, right angles, a person's edits, corners.
  void finish(const std::vector<MapEdit>& edits) {
    map_.circles = joinCircles(record_, params_.circles, map_.state);
    for (std::string& missing : applyEdits(edits, map_.state)) map_.notes.push_back(std::move(missing));
    SolveStage last{.kernel = params_.kernel, .right_angles = params_.right_angles, .tolerance = 1e-6};
    last.constraints = constraintsOf(edits, map_.state);
    CornerJoinParams corners = params_.corners;
    for (const LineConstraint& constraint : last.constraints) {
      if (constraint.kind == LineConstraint::Kind::kLength) {
        corners.keep.push_back(map_.state.landmarks[constraint.one].id);
      }
    }
    if (!solve(last)) return;
    const std::string problem = addCovariances(record_, params_.graph, last, map_.state, map_.closings);
    if (!problem.empty()) map_.notes.push_back(problem);
    joinCorners(corners, map_.state);
    map_.seen_again = seenAgain(record_, map_.state, params_.closing.apart_m);
    map_.twice = edgesTwice(record_, params_.twice, map_.state);
  }

  /// Each search sees the map as the closings before it left it.
  void close(const std::vector<MemoryUpdate>& updates, const MappingProgress& progress) {
    for (const double begin_m : searchBegins(record_, params_.closing)) {
      if (progress) progress(begin_m, ways_.back());
      const FoundClosings found =
          searchClosings(record_, updates, map_.state, params_.closing, params_.seed, begin_m);
      map_.searches.push_back(found.evidence);
      if (!found.closings.empty() && !accept(found.closings)) return;
    }
  }

  /// @return false when the solver failed.
  bool accept(const std::vector<Closing>& found) {
    std::vector<Closing> candidates = map_.closings;
    candidates.insert(candidates.end(), map_.refused.begin(), map_.refused.end());
    candidates.insert(candidates.end(), found.begin(), found.end());
    const std::vector<Pose2>& poses = map_.state.poses;
    std::vector<Closing> accepted;
    const std::vector<Eigen::Matrix3d> P_chain =
        relativeCovariances(record_, params_.graph, {.kernel = params_.kernel}, map_.state, candidates);
    for (const int i : consistentClosings(poses, ways_, candidates, params_.consistency, P_chain)) {
      accepted.push_back(candidates[static_cast<std::size_t>(i)]);
    }
    std::vector<Closing> kept;
    for (const int i : closingsKeptByBoth(poses, ways_, accepted, params_.consistency.chain)) {
      kept.push_back(accepted[static_cast<std::size_t>(i)]);
    }
    const bool more = kept.size() > map_.closings.size();
    if (!more) {
      map_.refused.insert(map_.refused.end(), found.begin(), found.end());
      return true;
    }
    map_.refused.clear();
    for (const Closing& each : candidates) {
      const bool is_kept = std::any_of(kept.begin(), kept.end(), [&](const Closing& k) {
        return k.from == each.from && k.to == each.to && k.T_from_to == each.T_from_to;
      });
      if (!is_kept) map_.refused.push_back(each);
    }
    map_.closings = std::move(kept);
    return closeGraph();
  }

  /// Relative poses first, then the landmarks of both visits become one, then everything.
  bool closeGraph() {
    const PoseGraphResult closed = solvePoseGraph(map_.state.poses, ways_, map_.closings,
                                                  RobustKernel::kCauchy, params_.consistency.chain);
    if (!closed.usable) {
      map_.problem = "the closings could not be solved";
      return false;
    }
    map_.state.poses = closed.poses;
    LandmarkMergeParams wide = params_.merge;
    wide.across_m = params_.merge_closed_m;
    merge(wide);
    // Without a kernel first: the landmarks of both visits still pull.
    return solve({.ends = true}) && settle();
  }

  const DriveRecord& record_;
  const DriveMapperParams& params_;
  GraphParams graph_;  ///< with the noise that the solves so far left
  std::vector<double> ways_;
  DriveMap map_;
};

}  // namespace

DriveMap mapDrive(const DriveRecord& record, const std::vector<MemoryUpdate>& updates,
                  const DriveMapperParams& params, const MappingProgress& progress) {
  return Mapping(record, params).run(updates, {}, progress);
}

DriveMap mapDriveAgain(const DriveRecord& record, const std::vector<Closing>& accepted,
                       const DriveMapperParams& params) {
  return Mapping(record, params).run({}, accepted, {});
}

}  // namespace vismem
