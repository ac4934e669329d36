/// @file The remembered segments: prediction, matching, fusion, confirmation, life. Pure. SPEC V5, M1-M6, M9.
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "active_visual_memory/core/association.h"
#include "active_visual_memory/core/corners.h"
#include "active_visual_memory/core/drift_alignment.h"
#include "active_visual_memory/core/drift_residuals.h"
#include "active_visual_memory/core/floor_evidence.h"
#include "active_visual_memory/core/floor_line.h"
#include "active_visual_memory/core/ground_projector.h"
#include "active_visual_memory/core/joint_alignment.h"
#include "active_visual_memory/core/kidnap_detector.h"
#include "active_visual_memory/core/life.h"
#include "active_visual_memory/core/memory_element.h"
#include "active_visual_memory/core/parallax.h"
#include "active_visual_memory/core/primitive_memory.h"
#include "active_visual_memory/core/slip_detector.h"
#include "common/robot/observation.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// The memory of floor segments in the odometry frame. *Single-threaded* (owner: the perception loop).
/// Motion prediction (M6) is exact and free: elements rest in odom, and only the camera moves. What the
/// images show of odometry's own drift moves all elements together, so that they stay right relative to the
/// robot. Invariants: life in [threshold, maximum]; at most max_elements; ids are never used twice.
class SegmentMemory {
 public:
  enum class Fusion { kChapter, kCovariance };

  struct Params {
    Fusion fusion = Fusion::kCovariance;
    double cache_radius_m = 4.0;          ///< M5
    double max_range_m = 4.0;             ///< as of the projector: for what an image's sway brings beyond ..
    double range_slack = 1.03;            ///< .. this share of it
    double min_visible_px = 10.0;         ///< shorter visible parts are not expected to be observed
    double view_margin_px = 4.0;          ///< an expectation nearer to the border than this says nothing
    double max_absence_turn_radps = 0.6;  ///< a camera that turns faster proves no absence
    double max_mapping_turn_radps = 3.0;  ///< and faster than this, nothing new is taken in
    double near_angle_rad = 0.12;         ///< gates on the floor (M2, M3)
    double near_distance_m = 0.06;
    double far_distance_share = 0.02;  ///< added to near_distance_m per metre from the camera
    double max_gap_m = 0.06;           ///< between the extents of pieces of one line
    double not_radial = 0.2;           ///< sine of the angle to the viewing ray that no vertical edge shows
    double slack_m = 0.005;            ///< of a match on the floor, for what the covariances do not model
    double slack_share = 0.003;        ///< added to slack_m per metre from the camera
    double gate_sigmas = 3.0;
    double drift_per_m = 0.01;     ///< odometry drift per metre travelled while an element was not seen
    double drift_per_rad = 0.003;  ///< heading drift per radian turned [rad]
    int min_sightings = 3;         ///< seen in fewer images it is on trial: not published, soon forgotten
    double parallax_noise_share = 0.1;  ///< share of an end's variance that changes from view to view; the
                                        ///< rest (camera height, pitch) is common to all and cancels
    int max_elements = 1000;
    bool align = true;  ///< the whole memory follows the drift of odometry that the images show
    DriftAlignment::Params alignment;
    LeanParams lean;      ///< estimated with the drift
    CourseParams course;  ///< of straight lines, which tell of the lean
    /// Where what is remembered has one course, modulo 90 degrees, the lines of each image tell of the
    /// heading against it. For odometry that errs more than the directions of lines: that of feet.
    bool compass = false;
    double align_doubt = 3.0;  ///< and times this for what is not known yet to rest on the floor
    /// Ends are found a pixel or so short, and always the same way: as independent errors they would make a
    /// camera that comes nearer seem to lean. Standard deviations times this.
    double align_end_doubt = 4.0;
    /// A body that sways by this much (`lean.sway_rad`) meets its memory once more, where what it has met
    /// puts the camera: a degree moves a line 3 m away half way to another one 60 cm behind it.
    double sway_to_meet_twice_rad = 0.25 * std::numbers::pi / 180.0;
    /// The sway found in an image, and the drift followed with it, err by more than images can tell: their
    /// standard deviations times this, but never more than what is known beforehand.
    double sway_doubt = 4.0;
    bool joint = false;  ///< for a body that sways: drift, lean and lines in one filter (JointAlignment)
    JointAlignment::Params jointly;  ///< of that filter; `drift` and `together_rad` are taken from here
    SlipDetector::Params slip;
    double align_noise = 2.0;    ///< errors of neighbouring images are alike: standard deviations times this
    double aligned_m = 0.003;    ///< error of the alignment: of places ..
    double aligned_rad = 0.004;  ///< .. and of the heading
    double max_end_shift_m = 0.15;   ///< ends further apart than this are not compared
    double label_share = 0.4;        ///< of the votes that a label needs
    bool confirm_unlabelled = true;  ///< false: what has no label (a shadow, a pattern) is never confirmed
    /// What is confirmed is at least this long: the outline of a smaller mark is not made of straight edges
    /// that a camera tells (ends of painted lines are told by their sides).
    double min_confirmed_m = 0.0;
    /// Where the long lines of a place are parallel or at right angles (`course`), a line that is off by no
    /// more than a pixel on its ends is told in their direction, and may be shorter than min_confirmed_m: the
    /// outline of a mark.
    bool tell_in_course = false;
    bool confirm_by_parallax = true;    ///< false: everything is confirmed at once, as in the chapter
    CornerParams corners;               ///< of confirmed edges, which confirm what lies between them
    double max_anchor_turn_rad = 20.0;  ///< parallax is begun anew after the robot turned this far
    double max_anchor_travel_m = 4.0;
    double suspect_fading = 4.0;       ///< so much faster unseen things fade that may be standing edges
    double new_s = 8.0;                ///< M10: first seen this lately is new
    double well_known_s = 40.0;        ///< elements seen this lately ..
    double well_known_travel_m = 3.0;  ///< .. before this much was driven tell a new place from drift
    int short_votes = 6;               ///< images that must see a line end earlier, with bare floor beyond
    /// Images that must see a gap in a line, and nothing of it there, to make it two; 0: that never happens.
    int gap_votes = 0;
    double gap_contrast_share = 0.35;  ///< of the line's contrast: less of it in the gap is no edge
    double gap_place_m = 0.05;         ///< their ends of it agree within this
    LifeParams life;
    AssociationParams association;
    FloorLine::Params line;
    ParallaxEstimate::Params parallax;
    FloorEvidence::Params evidence;
  };

  explicit SegmentMemory(const Params& params);

  /// Takes in one image. @param floor the observed segments placed on the floor, with their indices.
  /// @param observation with the camera where its lean puts it (`lean`).
  ImageAnalysis update(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
                       std::vector<FloorSegment> floor, double turn_rate_radps);

  /// What is believed of the camera's lean, and how well it is known [rad^2].
  const Lean& lean() const { return joint() ? joint_.lean() : drift_.lean(); }
  LeanCovariance leanCovariance() const {
    return joint() ? joint_.leanCovariance() : drift_.leanCovariance();
  }

  /// How the last image met what was well remembered (M10).
  const SceneAgreement& agreement() const { return agreement_; }

  /// M10: what was found after this may belong to another place, and is no old acquaintance.
  void doubtSince(std::optional<StampUs> stamp_us) { doubt_since_us_ = stamp_us; }

  /// Only lets time pass: an image that was not analysed.
  void age(StampUs stamp_us);

  /// M9: the pieces of one side of a shape become one segment, with the id of the oldest.
  void complete(const std::vector<SideCompletion>& sides);

  /// For an edge that is told of, not remembered: an id that no element has or will have.
  std::uint64_t newId() { return next_id_++; }

  /// Sets everything aside (M10, a new epoch). Ids go on.
  void clear();

  const std::vector<MemoryElement>& elements() const { return elements_; }
  bool onTrial(const MemoryElement& element) const { return element.sightings < params_.min_sightings; }

 private:
  struct View;
  struct Meeting;
  std::vector<int> cache(const Pose2& T_odom_robot) const;
  void travel(const Pose2& T_odom_robot);
  void moveAll(const SmallMotion& motion);
  std::optional<double> courseOfAll() const;
  bool sways() const { return params_.align && params_.lean.sway_rad >= params_.sway_to_meet_twice_rad; }
  bool joint() const { return params_.joint && sways(); }
  JointAlignment::Params jointParams() const;
  /// @param joint that learns of it; null: only what it would return.
  std::optional<Correction> tellJointly(const Meeting& meeting, const View& view,
                                        JointAlignment* joint) const;
  void followLines();
  void followSlip(const View& view, const std::vector<FloorSegment>& floor);
  void forgetLines();
  void join(MemoryElement& element, const MemoryElement& other);
  Meeting meet(const View& view, const std::vector<ImageSegment>& observed,
               const std::vector<FloorSegment>& floor, const std::vector<FloorSegment>& placed) const;
  Meeting meetSwaying(const View& view, const std::vector<ImageSegment>& observed,
                      const std::vector<FloorSegment>& floor) const;
  std::optional<Correction> tellDrift(const Meeting& meeting, const std::vector<FloorSegment>& floor,
                                      const View& view, DriftAlignment& drift) const;
  static void placeAnew(const Correction& correction, std::vector<FloorSegment>& floor, View& view);
  void alignTo(const Meeting& meeting, std::vector<FloorSegment>& floor, View& view);
  std::vector<Expectation> expect(const View& view, std::vector<int>& index_of) const;
  bool fitsOnFloor(const MemoryElement& element, const FloorSegment& observed, double distance_m) const;
  void take(MemoryElement& element, const FloorSegment& observed, const View& view);
  void confirm(MemoryElement& element, const FloorSegment& observed, const View& view);
  void vote(MemoryElement& element, const Label& label, double distance_m) const;
  void begin(const FloorSegment& observed, const View& view);
  void look(MemoryElement& element, const View& view) const;
  Sighting judgeUnobserved(MemoryElement& element, const Segment2& px, const View& view);
  void reviewEnds(MemoryElement& element, const std::vector<const FloorSegment*>& seen,
                  const std::vector<FloorSegment>& floor, const View& view);
  void reviewGaps(MemoryElement& element, const std::vector<const FloorSegment*>& seen,
                  const std::vector<ImageSegment>& observed, const View& view);
  /// Where an edge ends and another one begins behind it in its line, each seen as often as a gap needs, a
  /// view that runs across does not make them one.
  void keepParted(const std::vector<int>& cached);
  /// @param place of the gap on the floor, along the element. @param before, behind what was seen beside it.
  /// @param hidden by what may stand before it. @return whether the element is parted now.
  bool voteForGap(MemoryElement& element, const Segment2& place, const FloorSegment& before,
                  const FloorSegment& behind, bool hidden, const View& view);
  bool isNew(const MemoryElement& element, StampUs stamp_us) const {
    return toSeconds(stamp_us - element.value.first_seen_us) < params_.new_s;
  }
  bool isNewHere(const MemoryElement& element, StampUs stamp_us) const {
    return isNew(element, stamp_us) || (doubt_since_us_ && element.value.first_seen_us > *doubt_since_us_);
  }
  bool isWellKnown(const MemoryElement& element, StampUs stamp_us) const;
  bool isBare(const Segment2& place, const MemoryElement& element, const View& view) const;
  bool isOfAnotherKind(const Segment2& place, const MemoryElement& element,
                       const std::vector<FloorSegment>& floor) const;
  void mergeDuplicates(const std::vector<int>& cached);
  void countLife(StampUs stamp_us);
  void publish(MemoryElement& element) const;
  void publishAll();

  Params params_;
  LifeClock clock_;
  std::vector<MemoryElement> elements_;
  std::optional<double> course_rad_;
  std::vector<MemoryElement> parted_;  ///< further pieces of elements, until the image is done
  std::uint64_t next_id_ = 1;
  std::optional<Pose2> last_pose_;
  double camera_height_m_ = 0.0;  ///< of the last image
  double travel_m_ = 0.0;
  double turn_rad_ = 0.0;
  DriftAlignment drift_;
  JointAlignment joint_;
  SlipDetector slips_;
  SceneAgreement agreement_;
  std::optional<StampUs> doubt_since_us_;
};

}  // namespace vismem
