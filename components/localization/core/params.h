/// @file Tuning of the localization core, and its two presets. Pure. SPEC L1-L9, L12; DESIGN 9.
#pragma once

#include <numbers>
#include <string>
#include <vector>

namespace vismem {

/// What the chapter's health looks at: the analysed image (L4), the memory (L5), or the mean of both.
enum class HealthSource { kMemory, kImage, kBoth };

/// L7, L8: the table of races. Shared by both modes; the thresholds differ.
struct RaceParams {
  int maximum = 10;
  double same_place_m = 0.20;  ///< in x and in y each
  double same_place_rad = 30.0 * std::numbers::pi / 180.0;
  double create_health = 0.6;    ///< a candidate below this makes no race
  double delete_health = 0.6;    ///< a race with no victories below this goes
  int protected_age = 3;         ///< iterations after birth without deletion or replacement
  int protected_after_best = 9;  ///< iterations after having been the best without them
  int maximum_victories = 20;
  /// Default mode: a race that is ahead of a candidate by more evidence than this [nats] keeps its place,
  /// whatever one image says of both.
  double spared_ahead = 0.5;
};

/// L6.
struct ExplorerParams {
  int count_lost = 1000;
  int count_reliable = 200;
  int period_reliable = 4;      ///< iterations between searches when reliable; every one when not
  double reliable_above = 0.6;  ///< reliability from which the robot counts as located
  int candidates = 6;           ///< M
  double list_health = 0.3;     ///< explorers below this are no candidates
  double margin_m = 0.0;        ///< the search goes this far beyond the map's bounding box
};

/// L9, chapter mode.
struct EvolutionParams {
  int individuals = 30;
  double elitism = 0.2;
  double crossover = 0.2;  ///< the rest is mutation
  double noise_m = 0.10;   ///< thermal noise, uniform +-
  double noise_rad = 15.0 * std::numbers::pi / 180.0;
};

/// L3-L5, chapter mode.
struct HealthParams {
  /// L5 needs a memory without false elements: one off-floor edge in the wrong place costs as much as a wrong
  /// pose. L4 is the default because its points are cut to what the camera sees now.
  HealthSource source = HealthSource::kImage;
  bool use_field = true;         ///< false: brute force over the map, the reference
  double memory_scale_m = 0.5;   ///< M of L5
  double image_scale_px = 50.0;  ///< M of L4 at 320 columns; scaled with the image's width
  double memory_range_m = 4.0;   ///< segments further away than this are not used (M5)
  double grid_top_px = 10.0;     ///< cells of the sampling grid at the top of a 240-row image
  double grid_bottom_px = 40.0;  ///< and at its bottom
};

/// Default mode: every part can be switched off alone.
struct RobustParams {
  HealthSource source = HealthSource::kBoth;
  double image_share =
      0.85;  ///< of the effective points where both have some: what is seen now is not yet bent
  /// The memory counts where the image is worth less than so many points, the more the less it is worth.
  double memory_below_points = 6.0;
  double image_range_m = 4.0;       ///< floor points of the image further away than this are not used
  double camera_sigma_rad = 0.003;  ///< of the camera's direction, each floor point by itself
  /// How far the camera may lean from where the kinematics put it, about the robot's x and y axes: for good
  /// (calibration), and in one image (bumps, a walking body). Both are estimated with the pose; 0 takes one
  /// as known.
  double lean_bias_rad = 0.5 * std::numbers::pi / 180.0;
  double lean_sway_rad = 0.2 * std::numbers::pi / 180.0;
  /// How far the memory as a whole may lie beside what is seen now (odometry's error since). 0: not at all.
  double memory_shift_m = 0.03;
  double memory_turn_rad = 2.0 * std::numbers::pi / 180.0;
  double point_step_m = 0.10;       ///< spacing of sampling points along remembered segments
  int maximum_points = 100;         ///< per observation; only every n-th where there would be more
  double range_m = 5.0;             ///< remembered points further away than this are not used
  double half_life_s = 4.0;         ///< weight of what was not seen for this long is halved; 0: never
  double unconfirmed_weight = 0.4;  ///< of elements not yet seen from a second viewpoint (M1)
  double effective_points = 30.0;   ///< the points of one observation are worth at most this many
  double points_per_metre = 5.0;    ///< what a metre of fresh, confirmed segment is worth
  /// An end of a segment of the image that is no cut by the image's border counts as so many metres of it:
  /// nothing else says how far along a wall the robot is. 0: ends are not looked at.
  double end_metres = 0.2;
  /// Least standard deviations of a point across its line: of one that is seen now (what the camera errs by
  /// comes on top), and of a remembered one, as odometry erred since.
  double sigma_m = 0.012;
  double remembered_sigma_m = 0.033;
  double maximum_sigma_m = 0.25;
  double drift_sigma_mps = 0.01;       ///< growth of it with time unseen (odometry drift)
  double outlier_share = 0.10;         ///< eps of the bounded likelihood
  bool bounded = true;                 ///< false: squared distances, every point pulls with full force
  bool negative_information = true;    ///< places that promise more than the image shows lose evidence
  double detection_probability = 0.7;  ///< of a map segment near the camera and fully in view
  bool direction_gate = true;          ///< points are compared with map segments of similar direction only
  double direction_gate_rad = 20.0 * std::numbers::pi / 180.0;
  bool use_field = true;              ///< false: brute force, the reference
  int refinement_steps = 3;           ///< Gauss-Newton steps per race and iteration; 0: none
  bool kalman = true;                 ///< false: refinement without the motion prior
  double odometry_share = 0.04;       ///< standard deviation per metre travelled
  double odometry_turn_share = 0.10;  ///< per radian turned
  double odometry_turn_per_m = 0.10;  ///< heading, per metre travelled
  double walk_m = 0.004;  ///< of the pose per square root of an iteration: what odometry does not know
  double walk_rad = 0.01;
  double information_share = 1.0;  ///< of one observation that is new since the last iteration
  /// Evidence is the mean of some 1 / (1 - forgetting) observations, of which this share is news: so many
  /// times it counts when shares of belief are made of it (but at least once).
  double news_share = 0.15;
  double forgetting = 0.95;  ///< of evidence per iteration; 0: the last observation alone
  /// Evidence [nats] by which a newcomer must lead to become the winner; one that lived long needs a third.
  double lead = 1.5;
  /// What was seen so often at one place counts half as evidence; 0: every time in full. Of what was seen
  /// repeat_time_s ago, a third of the times still counts.
  double repeats = 3.0;
  double repeat_time_s = 10.0;
  double birth_penalty = 2.5;      ///< evidence [nats] that a jump of the robot costs (PastObservations)
  double delete_behind = 12.0;     ///< evidence [nats] behind the best that ends a race
  double constructed_share = 0.5;  ///< of explorers placed by matching what is seen to the map
  /// Uniform explorers are fewer in a larger map, in proportion: one finds a place from some 0.3 m and 15
  /// degrees, so that 250 at each iteration search this much in half a minute. 0: as many in every map.
  double uniform_area_m2 = 1000.0;
  double landmark_share = 0.7;  ///< of those: by landmarks, where any match; the rest by single segments
  bool corners = true;          ///< kinds of landmark: junctions of two directions,
  bool doors = true;            ///< segments known by their length and changes of label along a line,
  bool parallelograms = true;   ///< remembered primitives
  double kld_error = 0.05;      ///< explorers stop when more would hardly find more places; 0: never
  double kld_place_m = 0.5;     ///< size of a place for it
  double kld_place_rad = 30.0 * std::numbers::pi / 180.0;
  int kld_least = 100;              ///< explorers sent out in any case
  int refined_explorers = 24;       ///< the best explorers are refined before candidates are chosen
  bool validity = true;             ///< false: reliability is the winner's share of belief alone
  double reliability_time_s = 2.0;  ///< filter of the explained fraction
  double enough_points = 12.0;      ///< observations worth less cannot make the pose reliable
  /// What lies within this of its map segment is explained all the same: a map and a calibration may err by
  /// more than the points of one image do, which makes the place no less true.
  double explained_sigma_m = 0.025;
  double explained_low = 0.35;   ///< explained fraction that counts nothing
  double explained_high = 0.75;  ///< and that counts fully
  /// False: an image counts as taken when it arrives (Localizer::step with the odometry of that moment).
  bool rate_at_image_stamp = true;
};

/// What odometry may do wrong all the time, and how surely a piece of the way tells (LearntOdometry).
struct LearntOdometryParams {
  bool enabled = true;
  /// Standard deviations before anything was learnt: per metre [rad/m], per radian turned, and of the way.
  double turn_per_m = 0.05;
  double turn_share = 0.03;
  double travel_share = 0.03;
  double walk_share = 0.02;  ///< of these, by which they change per root of a metre
  double piece_m = 0.5;      ///< a piece of the way is so long, or turns so far
  double piece_rad = 0.8;
  double pose_std_m = 0.01;  ///< of the pose at its ends
  double pose_std_rad = 0.5 * std::numbers::pi / 180.0;
  double noise_rad_per_root_m = 0.03;  ///< of odometry, by chance
  double noise_rad_per_root_rad = 0.02;
  double noise_m_per_root_m = 0.01;
  double gate_sigmas = 3.0;
  double trust = 0.7;  ///< reliability of a pose that tells
};

enum class LocalizationMode { kDefault, kChapter };

/// B4: how directions of gaze are rated.
struct GazeAdvisorParams {
  double minimum_pan_rad = -159.0 * std::numbers::pi / 180.0;  ///< of the camera's axis
  double maximum_pan_rad = 159.0 * std::numbers::pi / 180.0;
  double minimum_tilt_rad = -20.0 * std::numbers::pi / 180.0;
  double maximum_tilt_rad = -10.0 * std::numbers::pi / 180.0;  ///< what localizes lies on the floor
  double step_rad = 15.0 * std::numbers::pi / 180.0;
  double range_m = 4.0;  ///< floor further away than this is not expected to be seen well
  double aim_m = 3.0;    ///< distance of the place that is looked at where the axis meets no floor before
  double sigma_m = 0.1;  ///< races that differ by less than this about a line agree about it
  /// Least belief in "none of these races": it makes all lines count, not only those that tell races apart.
  double none_share = 0.2;
  double horizon_s = 1.5;   ///< what is seen within this time counts, also on the way ..
  double patience_s = 0.8;  ///< .. a third of it when it is seen so late
  /// A place that was in view for so long tells half as much as a new one: three iterations, as
  /// RobustParams::repeats counts them.
  double repeat_s = 0.6;
  double forget_s = 8.0;  ///< and is nearly new again after two or three times this
  double head_speed_radps = 150.0 * std::numbers::pi / 180.0;
  double head_acceleration_radps2 = 1000.0 * std::numbers::pi / 180.0;
  double delay_s = 0.02;  ///< from the image until a new wish turns the head
};

/// B4: when localization asks for gaze.
struct GazePlannerParams {
  GazeAdvisorParams advisor;
  double doubt_above = 0.3;  ///< asks while the pose is less sure than 1 - this
  double confirm_s = 1.0;    ///< and for so long afterwards: a plain wall agrees with many places
  /// Of the wishes, from little doubt to full doubt (see GazeRequest::priority; kUrgentPriority).
  double least_priority = 50.0;
  double most_priority = 100.0;
  double deadline_s = 2.0;  ///< a place that the camera does not reach within this is given up for a while
  double seen_rad = 20.0 * std::numbers::pi / 180.0;  ///< the camera has reached what lies this near its axis
  double move_rad = 10.0 * std::numbers::pi / 180.0;  ///< a wish is moved when the best lies so far beside it
};

struct LocalizerParams {
  LocalizationMode mode = LocalizationMode::kDefault;
  /// Labels of map segments that stand up and hide the floor behind them; "*_foot": all that end so.
  std::vector<std::string> opaque_labels{"skirting", "*_foot"};
  double tick_s = 0.2;  ///< of stamps between iterations; odometry moves the races with every update
  /// Default mode: the same for `doubt_s` after an observation contradicted a winner that nothing had
  /// contradicted for long, or until nothing disputes one any more. Then every image counts.
  double doubt_tick_s = 0.1;
  double doubt_s = 3.0;
  double cell_m = 0.5;  ///< of the grid over the map; changes speed alone
  RaceParams races;
  ExplorerParams explorers;
  EvolutionParams evolution;
  HealthParams health;
  RobustParams robust;
  LearntOdometryParams odometry;  ///< of the default mode
};

/// The presets: `chapter` as published (with DESIGN 9 where it is silent), `default` ours.
LocalizerParams localizerPreset(LocalizationMode mode);

}  // namespace vismem
