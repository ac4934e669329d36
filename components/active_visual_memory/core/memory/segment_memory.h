/// @file Memory of floor segments: prediction, association, fusion, confirmation, life.
/// Pure. Implements M5, M6. See V5, M1-M4.
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "active_visual_memory/core/estimation/map_filter.h"
#include "active_visual_memory/core/estimation/measurement_models.h"
#include "active_visual_memory/core/estimation/slip.h"
#include "active_visual_memory/core/ground/floor_evidence.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/ground/floor_segment.h"
#include "active_visual_memory/core/memory/data_association.h"
#include "active_visual_memory/core/memory/kidnap_detector.h"
#include "active_visual_memory/core/memory/life.h"
#include "active_visual_memory/core/memory/memory_element.h"
#include "active_visual_memory/core/memory/parallax.h"
#include "active_visual_memory/core/memory/plane_confirmation.h"
#include "active_visual_memory/core/memory/side_completion.h"
#include "common/robot/observation.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Memory of floor segments in the odometry frame. *Single-threaded* (owner: the perception loop).
/// Motion prediction (M6): elements rest in odom and only the camera moves; the estimated odometry drift
/// moves all elements together, so that they stay right relative to the robot. Elements within
/// `cache_radius_m` serve matching and fusion (M5). Invariants: life in [threshold, maximum]; at most
/// max_elements; ids are never used twice.
class SegmentMemory {
 public:
  enum class Fusion { kChapter, kCovariance };

  struct Params {
    Fusion fusion = Fusion::kCovariance;
    double cache_radius_m = 4.0;   ///< M5
    double max_range_m = 4.0;      ///< as of the projector: segments that a frame tilt moved further out ..
    double range_slack = 1.03;     ///< .. than this times it are cut again
    double min_visible_px = 10.0;  ///< shorter visible parts are not expected to be observed
    double view_margin_px = 4.0;   ///< expectations nearer to the border are no evidence of absence
    double max_absence_turn_radps = 0.6;  ///< turn rate of the camera up to which absence is evidence
    double max_mapping_turn_radps = 3.0;  ///< turn rate up to which new elements are added
    double near_angle_rad = 0.12;  ///< gates on the floor (M3; M2 multiplies them by kDuplicateGateShare)
    double near_distance_m = 0.06;
    double far_distance_share = 0.02;  ///< added to near_distance_m per metre from the camera
    double max_gap_m = 0.06;           ///< between the extents of pieces of one line
    double not_radial = 0.2;     ///< least sine of the angle to the viewing ray that excludes a vertical edge
    double slack_m = 0.005;      ///< sigma of a match on the floor that the covariances do not model
    double slack_share = 0.003;  ///< added to slack_m per metre from the camera
    double gate_sigmas = 3.0;
    double drift_per_m = 0.01;          ///< odometry drift per metre driven while an element was not seen
    double drift_per_rad = 0.003;       ///< heading drift per radian turned [rad]
    int min_sightings = 3;              ///< an element seen in fewer images is tentative: not published
    double parallax_noise_share = 0.1;  ///< share of the variance of an end that is independent between views
    int max_elements = 1000;
    bool align = true;  ///< estimate odometry drift, camera tilt and lines in one filter
    TiltPrior tilt_prior;                        ///< of the camera tilt, estimated with the drift
    DominantDirectionParams dominant_direction;  ///< of long lines, which measure the camera tilt
    /// Lines also measure the heading against the dominant direction of the memory. For odometry whose heading
    /// errs more than the directions of lines: legs.
    bool use_dominant_direction = false;
    double unconfirmed_inflation = 5.0;  ///< factor of sigmas against elements not known to lie on the floor
    /// Factor of the sigmas of ends along their line. The detector ends short by a pixel in every image: as
    /// independent errors that would bias the tilt of an approaching camera and the scale of its way.
    double end_inflation = 16.0;
    /// A per-frame tilt of at least this makes the robot legged: association and update are iterated once. A
    /// tilt of 1 degree moves a line 3 m away half way to another one 0.6 m behind it.
    double min_legged_tilt_rad = 0.25 * std::numbers::pi / 180.0;
    MapFilter::Params map_filter;  ///< `together_rad` is taken from dominant_direction
    SlipDetector::Params slip;
    double correlation_inflation = 2.0;  ///< factor of sigmas: errors of successive images are correlated
    double alignment_sigma_m = 0.003;    ///< error of the alignment: of places ..
    double alignment_sigma_rad = 0.004;  ///< .. and of the heading
    double max_end_shift_m = 0.15;       ///< ends further apart are not compared
    double label_share = 0.4;            ///< of the votes that a label needs
    bool confirm_unlabelled =
        true;  ///< false: elements without label (a shadow, a pattern) are never confirmed
    /// Least length of a confirmed element. The outline of a smaller spot has no straight edges in the image;
    /// ends of line markings follow from their edges.
    double min_confirmed_m = 0.0;
    /// Publishes lines that deviate from the dominant direction by at most a pixel at their ends with that
    /// direction; such lines may be shorter than min_confirmed_m.
    bool snap_to_dominant_direction = false;
    bool confirm_by_parallax = true;    ///< false: all is confirmed at once, as in the chapter
    CornerParams corners;               ///< of confirmed edges, which confirm the edges between them
    double max_anchor_turn_rad = 20.0;  ///< turn of the robot after which parallax begins anew
    double max_anchor_travel_m = 4.0;
    double unverified_decay =
        4.0;                     ///< factor of the decay out of view of elements that may be vertical edges
    double new_s = 8.0;          ///< age up to which an element is new (M10)
    double well_known_s = 40.0;  ///< an element is well known if seen within this time ..
    double well_known_travel_m = 3.0;  ///< .. and this way (M10)
    int short_votes = 6;               ///< images that must see an end further in, with free floor behind it
    int gap_votes = 0;  ///< images that must see a gap in a line to split it; 0: lines are not split
    double gap_contrast_share = 0.35;  ///< of the contrast of the line: less in the gap is no edge
    double gap_place_m = 0.05;         ///< distance within which votes are for one gap
    LifeParams life;
    AssociationParams association;
    FloorLine::Params line;
    ParallaxEstimate::Params parallax;
    FloorEvidence::Params evidence;

    /// Newest orientation, every absence alike, no confirmation, life in ticks of 200 ms.
    static Params chapter();
  };

  explicit SegmentMemory(const Params& params);

  /// Processes one image.
  /// @param observation      with the camera pose corrected by cameraTilt().
  /// @param floor            the observed segments on the floor, with their indices.
  /// @param turn_rate_radps  of the camera, >= 0.
  ImageAnalysis update(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
                       std::vector<FloorSegment> floor, double turn_rate_radps);

  const CameraTilt& cameraTilt() const { return map_filter_.cameraTilt(); }
  CameraTiltCovariance cameraTiltCovariance() const { return map_filter_.cameraTiltCovariance(); }

  /// Agreement of the last image with the well-known elements (M10).
  const SceneAgreement& agreement() const { return agreement_; }

  /// Elements first seen after this stamp are new: they may belong to another place (M10).
  void suspectSince(std::optional<StampUs> stamp_us) { suspect_since_us_ = stamp_us; }

  /// Advances time for an image that is not analysed.
  void advanceLife(StampUs stamp_us);

  /// Joins the pieces of one side of a shape into one segment with the id of the oldest (M9).
  void complete(const std::vector<SideCompletion>& sides);

  /// An id that no element has or will have, for a derived edge.
  std::uint64_t newId() { return next_id_++; }

  /// Drops all elements (M10, a new epoch). Ids go on.
  void clear();

  const std::vector<MemoryElement>& elements() const { return elements_; }
  bool isTentative(const MemoryElement& element) const { return element.sightings < params_.min_sightings; }

 private:
  struct View;
  struct Associations;
  std::vector<int> cache(const Pose2& T_odom_robot) const;
  void predict(const Pose2& T_odom_robot);
  void transformAll(const PlanarIncrement& motion);
  std::optional<double> dominantDirection() const;
  bool isLegged() const {
    return params_.align && params_.tilt_prior.per_frame_rad >= params_.min_legged_tilt_rad;
  }
  /// Whether the filter estimates an element's line. One that may stand, or was long unseen, may be out of it.
  bool inFilter(const MemoryElement& element) const {
    return params_.align && map_filter_.contains(element.value.id);
  }
  MapFilter::Params mapFilterParams() const;
  /// @param filter  that is updated; null: preview only.
  std::optional<Correction> updateMapFilter(const Associations& associations, const View& view,
                                            MapFilter* filter) const;
  void applyLineCorrections();
  void correctSlip(const View& view, const std::vector<FloorSegment>& floor);
  void removeStaleLines();
  void merge(MemoryElement& element, const MemoryElement& other);
  Associations associate(const View& view, const std::vector<ImageSegment>& observed,
                         const std::vector<FloorSegment>& floor,
                         const std::vector<FloorSegment>& placed) const;
  Associations associateIterated(const View& view, const std::vector<ImageSegment>& observed,
                                 const std::vector<FloorSegment>& floor) const;
  static void reproject(const Correction& correction, std::vector<FloorSegment>& floor, View& view);
  void applyCorrection(const Associations& associations, std::vector<FloorSegment>& floor, View& view);
  std::vector<Expectation> expect(const View& view, std::vector<int>& index_of) const;
  void cutBeyondRange(std::vector<FloorSegment>& floor, const Eigen::Vector2d& camera) const;
  /// Fuses the matched elements and judges the others that were expected.
  void updateExpected(const Associations& associations, const std::vector<ImageSegment>& observed,
                      const std::vector<FloorSegment>& floor, const View& view);
  /// Fuses unmatched segments with an element near them on the floor (M3), or adds them; duplicates first
  /// (M2).
  void addUnmatched(const Associations& associations, const std::vector<FloorSegment>& floor,
                    const View& view);
  /// @return the element of the cache that a segment belongs to on the floor; null if there is none.
  MemoryElement* nearest(const FloorSegment& segment, const View& view);
  bool fitsOnFloor(const MemoryElement& element, const FloorSegment& observed, double distance_m) const;
  void fuse(MemoryElement& element, const FloorSegment& observed, const View& view);
  /// Begins parallax anew when the anchor is too old, and improves it while the camera is at its place.
  void renewAnchor(MemoryElement& element, const FloorSegment& observed, const View& view);
  void verifyOnFloor(MemoryElement& element, const FloorSegment& observed, const View& view);
  void vote(MemoryElement& element, const Label& label, double distance_m) const;
  void addElement(const FloorSegment& observed, const View& view);
  void updateColours(MemoryElement& element, const View& view) const;
  Sighting judgeUnobserved(MemoryElement& element, const Segment2& px, const View& view);
  void updateEndpoints(MemoryElement& element, const std::vector<const FloorSegment*>& seen,
                       const std::vector<FloorSegment>& floor, const View& view);
  void updateGaps(MemoryElement& element, const std::vector<const FloorSegment*>& seen,
                  const std::vector<ImageSegment>& observed, const View& view);
  /// Marks the facing ends of two edges in one line as split if each was seen often enough: a blurred view
  /// across both does not merge them.
  void preventMerge(const std::vector<int>& cached);
  /// @param place   of the gap on the floor, along the element.
  /// @param before  piece before the gap. @param behind the piece behind it.
  /// @param hidden  the gap may be an occlusion.
  /// @return whether the element was split.
  bool voteForGap(MemoryElement& element, const Segment2& place, const FloorSegment& before,
                  const FloorSegment& behind, bool hidden, const View& view);
  bool isNew(const MemoryElement& element, StampUs stamp_us) const {
    return toSeconds(stamp_us - element.value.first_seen_us) < params_.new_s;
  }
  bool isNewHere(const MemoryElement& element, StampUs stamp_us) const {
    return isNew(element, stamp_us) ||
           (suspect_since_us_ && element.value.first_seen_us > *suspect_since_us_);
  }
  bool isWellKnown(const MemoryElement& element, StampUs stamp_us) const;
  bool isFree(const Segment2& place, const MemoryElement& element, const View& view) const;
  bool isOfAnotherKind(const Segment2& place, const MemoryElement& element,
                       const std::vector<FloorSegment>& floor) const;
  void mergeDuplicates(const std::vector<int>& cached);
  void countLife(StampUs stamp_us);
  void publish(MemoryElement& element) const;
  void publishAll();

  Params params_;
  LifeClock clock_;
  std::vector<MemoryElement> elements_;
  std::optional<double> dominant_direction_rad_;
  std::vector<MemoryElement> split_off_;  ///< elements split off while the image is processed
  std::uint64_t next_id_ = 1;
  std::optional<Pose2> last_pose_;
  double camera_height_m_ = 0.0;  ///< of the last image
  double travel_m_ = 0.0;
  double turn_rad_ = 0.0;
  MapFilter map_filter_;
  SlipDetector slips_;
  SceneAgreement agreement_;
  std::optional<StampUs> suspect_since_us_;
};

}  // namespace vismem
