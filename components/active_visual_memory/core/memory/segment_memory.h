/// @file Memory of floor segments: prediction, association, fusion, confirmation, life.
/// Pure. Implements M5, M6. See V5, M1-M4.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/estimation/measurement_models.h"
#include "active_visual_memory/core/ground/floor_segment.h"
#include "active_visual_memory/core/memory/kidnap_detector.h"
#include "active_visual_memory/core/memory/memory_element.h"
#include "active_visual_memory/core/memory/memory_params.h"
#include "active_visual_memory/core/memory/plane_confirmation.h"
#include "common/memory/scratch.h"
#include "common/robot/observation.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Memory of floor segments in the odometry frame. *Single-threaded* (owner: the perception loop).
/// Motion prediction (M6): elements rest in odom and only the camera moves; the estimated odometry drift
/// moves all elements together, so that they stay right relative to the robot. Elements within
/// `cache_radius_m` serve matching and fusion (M5). Invariants: life in [threshold, maximum]; at most
/// max_elements; ids are never used twice and ascend.
class SegmentMemory {
 public:
  using Params = SegmentMemoryParams;
  using Fusion = Params::Fusion;

  explicit SegmentMemory(const Params& params);

  /// Processes one image.
  /// @param observation      with the camera pose corrected by cameraTilt().
  /// @param floor            the observed segments on the floor, with their indices.
  /// @param turn_rate_radps  of the camera, >= 0.
  /// @return until the next call.
  const ImageAnalysis& update(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
                              std::span<const FloorSegment> floor, double turn_rate_radps);

  const CameraTilt& cameraTilt() const { return map_filter_.cameraTilt(); }
  CameraTiltCovariance cameraTiltCovariance() const { return map_filter_.cameraTiltCovariance(); }

  /// Agreement of the last image with the well-known elements (M10).
  const SceneAgreement& agreement() const { return agreement_; }

  /// Elements first seen after this stamp are new: they may belong to another place (M10).
  void suspectSince(std::optional<StampUs> stamp_us) { suspect_since_us_ = stamp_us; }

  /// Advances time for an image that is not analysed.
  void advanceLife(StampUs stamp_us);

  /// Joins the pieces of one side of a shape into one segment with the id of the oldest (M9).
  void complete(std::span<const SideCompletion> sides);

  /// An id that no element has or will have, for a derived edge.
  std::uint64_t newId() { return next_id_++; }

  /// Drops all elements (M10, a new epoch). Ids go on.
  void clear();

  const std::vector<MemoryElement>& elements() const { return elements_; }
  bool isTentative(const MemoryElement& element) const {
    return element.sightings < params_.retention.min_sightings;
  }

 private:
  struct View;
  struct Associations;
  /// A stretch of a remembered edge without it.
  struct Interruption {
    Segment2 odom;  ///< on the floor, in the direction of the edge [m]
    const FloorSegment* before;
    const FloorSegment* behind;  ///< may be `before`
    bool may_be_hidden;          ///< by an occluder: seen from one place it is no gap
  };
  bool isCached(const MemoryElement& element, const Pose2& T_odom_robot) const;
  std::pmr::vector<int> cache(const Pose2& T_odom_robot) const;
  // The steps of update(), in their order.
  void predict(const Pose2& T_odom_robot);
  View viewOf(const RobotObservation& observation, double turn_rate_radps);
  /// The observed segments of each expected element; for a legged robot after a first correction of the
  /// frame's tilt.
  Associations associate(const View& view, const std::vector<ImageSegment>& observed,
                         const std::vector<FloorSegment>& floor) const;
  /// Updates the filter and moves memory, segments and view by its correction.
  void correct(const Associations& associations, std::vector<FloorSegment>& floor, View& view);
  /// Fuses the matched elements (line: FloorLine or MapFilter; ends: fuseEnds, updateEndpoints) and judges
  /// the others that were expected.
  void updateExpected(const Associations& associations, const std::vector<FloorSegment>& floor,
                      const View& view);
  /// Fuses unmatched segments with an element near them on the floor (M3), or adds them; duplicates first
  /// (M2).
  void insert(const Associations& associations, const std::vector<FloorSegment>& floor, const View& view);
  /// Splits elements at gaps that enough images saw.
  void split(const Associations& associations, const std::vector<ImageSegment>& observed, const View& view);
  /// Joins elements that are copies or pieces of one edge.
  void merge(const View& view);
  /// Counts life and forgets (M4).
  void age(StampUs stamp_us);
  void publishAll();

  void transformAll(const PlanarIncrement& motion);
  /// Whether an element may have the dominant direction.
  bool hasDirection(const MemoryElement& element) const {
    return !isTentative(element) && !element.plane.stands && element.plane.not_vertical;
  }
  std::optional<double> dominantDirection() const;
  bool isLegged() const {
    return params_.estimation.enabled &&
           params_.estimation.tilt_prior.per_frame_rad >= params_.estimation.min_legged_tilt_rad;
  }
  /// Whether the filter estimates an element's line. One that may stand, or was long unseen, may be out of
  /// it.
  bool inFilter(const MemoryElement& element) const {
    return params_.estimation.enabled && map_filter_.contains(element.value.id);
  }
  /// @param filter  that is updated; null: preview only.
  std::optional<Correction> updateMapFilter(const Associations& associations, const View& view,
                                            MapFilter* filter) const;
  void removeStaleLines();
  void join(MemoryElement& element, const MemoryElement& other);
  /// @param placed  the segments where a preliminary correction puts them.
  Associations associatePlaced(const View& view, const std::vector<ImageSegment>& observed,
                               const std::vector<FloorSegment>& floor,
                               std::span<const FloorSegment> placed) const;
  static void reproject(const Correction& correction, std::span<FloorSegment> floor, View& view);
  void applyCorrection(const Correction& correction, std::vector<FloorSegment>& floor, View& view);
  /// Sets the expected elements of an image.
  void expect(const View& view, Associations& associations) const;
  /// @return the element of the cache that a segment belongs to on the floor; null if there is none.
  /// @param cached  indices of the elements near the robot.
  MemoryElement* nearest(const FloorSegment& segment, std::span<const int> cached, const View& view);
  bool fitsOnFloor(const MemoryElement& element, const FloorSegment& observed, double distance_m) const;
  void fuse(MemoryElement& element, const FloorSegment& observed, const View& view);
  PlaneView planeView(const View& view) const;
  /// Compares an observation with the anchor (M1). @param observed in the direction of the element.
  void observePlane(MemoryElement& element, const FloorSegment& observed, const View& view) const;
  void vote(MemoryElement& element, const Label& label, double distance_m) const;
  void addElement(const FloorSegment& observed, const View& view);
  void updateColours(MemoryElement& element, const View& view) const;
  Sighting judgeUnobserved(MemoryElement& element, const Segment2& px, const std::vector<FloorSegment>& floor,
                           const View& view);
  /// Moves ends inwards that enough images saw further in.
  /// @param seen  all pieces of the element in this image.
  void updateEndpoints(MemoryElement& element, std::span<const FloorSegment* const> seen,
                       const std::vector<FloorSegment>& floor, const View& view);
  /// The one place that decides where an image shows that an edge does not go on between its ends: between
  /// its pieces, which are in order and direction of the edge, and inside them.
  std::pmr::vector<Interruption> interruptionsOf(const MemoryElement& element,
                                                 std::span<const FloorSegment> pieces,
                                                 const std::vector<ImageSegment>& observed,
                                                 const View& view) const;
  /// Collects votes for gaps between pieces, or inside one, and splits the element at a gap with enough.
  void updateGaps(MemoryElement& element, std::span<const FloorSegment* const> seen,
                  const std::vector<ImageSegment>& observed, const View& view);
  /// @return whether the element was split.
  bool voteForGap(MemoryElement& element, const Interruption& seen, const View& view);
  bool isNewHere(const MemoryElement& element, StampUs stamp_us) const;
  bool isWellKnown(const MemoryElement& element, StampUs stamp_us) const;
  bool isFree(const Segment2& place, const MemoryElement& element, const View& view) const;
  bool isOfAnotherKind(const Segment2& place, const MemoryElement& element,
                       const std::vector<FloorSegment>& floor) const;
  static bool areDuplicates(const MemoryElement& a, const MemoryElement& b, double reach_m);
  /// Joins pairs within the gates, except across ends marked as split.
  void mergeDuplicates(std::span<const int> cached);
  void publish(MemoryElement& element) const;

  Params params_;
  LifeClock clock_;
  std::vector<MemoryElement> elements_;
  std::optional<double> dominant_direction_rad_;
  std::vector<MemoryElement> split_off_;           ///< elements split off while the image is processed
  std::vector<FloorSegment> floor_;                ///< of this image, moved by its correction
  ImageAnalysis analysis_;                         ///< of this image
  mutable std::vector<LineResidual> residuals_;    ///< workspace of updateMapFilter
  mutable std::vector<LineDirection> directions_;  ///< the same
  mutable Scratch scratch_;                        ///< of this image
  std::uint64_t next_id_ = 1;
  std::optional<Pose2> last_pose_;
  double camera_height_m_ = 0.0;  ///< of the last image
  double travel_m_ = 0.0;
  double turn_rad_ = 0.0;
  MapFilter map_filter_;
  SceneAgreement agreement_;
  std::optional<StampUs> suspect_since_us_;
};

}  // namespace vismem
