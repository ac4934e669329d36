#include "active_visual_memory/app/config.h"

#include <sstream>
#include <vector>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kFar = 1e4;

Pose3 readPose(ConfigReader& reader, const std::string& name, const std::vector<double>& position_m) {
  const auto p = reader.reals(name + ".Position_m", position_m, -10.0, 10.0);
  const auto r = reader.reals(name + ".Rotation_deg", {0.0, 0.0, 0.0}, -360.0, 360.0);
  return poseFromXyzRpy(p[0], p[1], p[2], degToRad(r[0]), degToRad(r[1]), degToRad(r[2]));
}

void readVision(ConfigReader r, ExtractorParams& p) {
  p.detector = r.choice("Detector", p.detector,
                        {{"solis", std::string("solis")},
                         {"chapter", std::string("chapter")},
                         {"hough", std::string("hough")}});
  p.colour_edges = r.boolean("ColourEdges", p.colour_edges);
  p.minimum_length_px = r.real("MinimumLength_px", p.minimum_length_px, 2.0, 1000.0);
  p.merge.angle_rad = r.angleDeg("Merge.Angle_deg", radToDeg(p.merge.angle_rad), 0.0, 45.0);
  p.merge.offset_px = r.real("Merge.Offset_px", p.merge.offset_px, 0.0, 50.0);
  p.merge.gap_px = r.real("Merge.Gap_px", p.merge.gap_px, 0.0, 200.0);
  p.gaps.enabled = r.boolean("CutAtGaps", p.gaps.enabled);
}

void readGate(ConfigReader r, FrameGate::Params& p) {
  p.enabled = r.boolean("Enabled", p.enabled);
  p.distance_m = r.real("Distance_m", p.distance_m, 0.0, 10.0);
  p.angle_rad = r.angleDeg("Angle_deg", radToDeg(p.angle_rad), 0.0, 180.0);
  p.max_interval_s = r.real("MaximumInterval_s", p.max_interval_s, 0.0, 60.0);
}

void readGround(ConfigReader r, GroundProjector::Params& p) {
  p.max_range_m = r.real("MaximumRange_m", p.max_range_m, 0.2, 50.0);
  p.horizon_margin_px = r.real("HorizonMargin_px", p.horizon_margin_px, 0.1, 500.0);
  p.border_margin_px = r.real("BorderMargin_px", p.border_margin_px, 0.0, 100.0);
  p.end_short_px = r.real("EndShort_px", p.end_short_px, 0.0, 5.0);
  p.min_length_m = r.real("MinimumLength_m", p.min_length_m, 0.001, 5.0);
  std::istringstream labels(r.text("OffFloorLabels", ""));
  for (Label label; labels >> label;) p.off_floor_labels.push_back(label);
  p.across_sigma_px = r.real("Noise.Across_px", p.across_sigma_px, 0.01, 50.0);
  p.along_sigma_px = r.real("Noise.Along_px", p.along_sigma_px, 0.01, 50.0);
  p.height_sigma_m = r.real("Noise.Height_m", p.height_sigma_m, 0.0, 1.0);
  p.pitch_sigma_rad = r.angleDeg("Noise.Pitch_deg", radToDeg(p.pitch_sigma_rad), 0.0, 20.0);
  p.timing_sigma_s = r.real("Noise.Timing_s", p.timing_sigma_s, 0.0, 1.0);
}

void readAssociation(ConfigReader r, AssociationParams& p) {
  p.max_angle_rad = r.angleDeg("Angle_deg", radToDeg(p.max_angle_rad), 0.1, 90.0);
  p.max_normal_px = r.real("Normal_px", p.max_normal_px, 0.1, 200.0);
  p.min_overlap = r.real("Overlap", p.min_overlap, 0.0, 1.0);
  p.use_polarity = r.boolean("Polarity", p.use_polarity);
}

void readLife(ConfigReader r, LifeParams& p) {
  p.maximum = r.real("Maximum", p.maximum, 1.0, 1e6);
  p.initial = r.real("Initial", p.initial, 0.0, 1e6);
  p.threshold = r.real("Threshold", p.threshold, 0.0, 1e6);
  p.gain_per_s = r.real("Gain_per_s", p.gain_per_s, 0.0, 1e6);
  p.fade_per_s = r.real("OutOfView_per_s", p.fade_per_s, 0.0, 1e6);
  p.absent_per_s = r.real("Absent_per_s", p.absent_per_s, 0.0, 1e6);
  r.alias("Covered_per_s", "Occluded_per_s");
  p.occluded_per_s = r.real("Occluded_per_s", p.occluded_per_s, 0.0, 1e6);
  p.tick_us = toStampUs(r.real("Tick_s", toSeconds(p.tick_us), 0.0, 10.0));
  if (p.initial > p.maximum) r.problem("Initial", "must not be more than " + r.key("Maximum"));
  if (p.threshold > p.initial) r.problem("Threshold", "must not be more than " + r.key("Initial"));
}

void readMemory(ConfigReader r, SegmentMemory::Params& p) {
  using Fusion = SegmentMemory::Fusion;
  p.fusion =
      r.choice("Fusion", p.fusion, {{"chapter", Fusion::kChapter}, {"covariance", Fusion::kCovariance}});
  p.cache_radius_m = r.real("CacheRadius_m", p.cache_radius_m, 0.1, kFar);
  p.max_elements = static_cast<int>(r.integer("MaximumElements", p.max_elements, 1, 1'000'000));
  p.min_sightings = static_cast<int>(r.integer("MinimumSightings", p.min_sightings, 1, 1000));
  p.near_angle_rad = r.angleDeg("Near.Angle_deg", radToDeg(p.near_angle_rad), 0.1, 90.0);
  p.near_distance_m = r.real("Near.Distance_m", p.near_distance_m, 0.001, 5.0);
  p.max_gap_m = r.real("Near.Gap_m", p.max_gap_m, 0.0, 5.0);
  p.slack_m = r.real("Match.Slack_m", p.slack_m, 0.0, 5.0);
  p.gate_sigmas = r.real("Match.Sigmas", p.gate_sigmas, 0.5, 100.0);
  p.drift_per_m = r.real("Drift.PerMetre", p.drift_per_m, 0.0, 1.0);
  p.drift_per_rad = r.real("Drift.PerRadian", p.drift_per_rad, 0.0, 1.0);
  p.align = r.boolean("Align.Enabled", p.align);
  OdometryErrors& odometry = p.map_filter.odometry;
  odometry.shift_per_m = r.real("Align.Shift_per_m", odometry.shift_per_m, 0.0, 1.0);
  odometry.turn_per_rad = r.real("Align.Turn_per_rad", odometry.turn_per_rad, 0.0, 1.0);
  odometry.turn_per_m = r.angleDeg("Align.Turn_degpm", radToDeg(odometry.turn_per_m), 0.0, 90.0);
  odometry.travel_scale = r.real("Align.TravelScale", odometry.travel_scale, 0.0, 0.5);
  odometry.turn_noise = r.angleDeg("Align.TurnNoise_deg", radToDeg(odometry.turn_noise), 0.0, 90.0);
  r.alias("Align.Compass", "Align.DominantDirection");
  p.use_dominant_direction = r.boolean("Align.DominantDirection", p.use_dominant_direction);
  for (const char* name : {"Align.MapFilter", "Align.Joint"}) {
    r.retired(name, "every robot's drift, camera tilt and lines are estimated in one filter");
  }
  p.slip.least_images = static_cast<int>(r.integer("Align.Slip.LeastImages", p.slip.least_images, 1, 1000));
  p.slip.images = static_cast<int>(r.integer("Align.Slip.Images", p.slip.images, 1, 1000));
  p.slip.sigmas = r.real("Align.Slip.Sigmas", p.slip.sigmas, 0.5, 100.0);
  p.slip.least_rad = r.angleDeg("Align.Slip.Least_deg", radToDeg(p.slip.least_rad), 0.0, 45.0);
  if (p.slip.least_images > p.slip.images) {
    r.problem("Align.Slip.LeastImages", "must not be more than " + r.key("Align.Slip.Images"));
  }
  r.alias("Lean.Mount_deg", "CameraTilt.Mount_deg");
  p.tilt_prior.mount_rad = r.angleDeg("CameraTilt.Mount_deg", radToDeg(p.tilt_prior.mount_rad), 0.0, 10.0);
  r.alias("Lean.Camera_deg", "CameraTilt.Camera_deg");
  p.tilt_prior.camera_rad = r.angleDeg("CameraTilt.Camera_deg", radToDeg(p.tilt_prior.camera_rad), 0.0, 10.0);
  r.alias("Lean.Sway_deg", "CameraTilt.PerFrame_deg");
  p.tilt_prior.per_frame_rad =
      r.angleDeg("CameraTilt.PerFrame_deg", radToDeg(p.tilt_prior.per_frame_rad), 0.0, 10.0);
  for (const char* name : {"CameraTilt.PerFrameInflation", "Lean.SwayDoubt"}) {
    r.retired(name, "the filter knows how the errors of lines depend on each other");
  }
  r.alias("Lean.Course_deg", "CameraTilt.DominantDirection_deg");
  p.dominant_direction.sigma_rad =
      r.angleDeg("CameraTilt.DominantDirection_deg", radToDeg(p.dominant_direction.sigma_rad), 0.0, 20.0);
  p.confirm_by_parallax = r.boolean("Confirm.ByParallax", p.confirm_by_parallax);
  p.min_confirmed_m = r.real("Confirm.LeastLength_m", p.min_confirmed_m, 0.0, 2.0);
  r.alias("TellInCourse", "SnapToDominantDirection");
  p.snap_to_dominant_direction = r.boolean("SnapToDominantDirection", p.snap_to_dominant_direction);
  p.gap_votes = static_cast<int>(r.integer("GapVotes", p.gap_votes, 0, 1000));
  p.parallax.least_height_m = r.real("Confirm.LeastHeight_m", p.parallax.least_height_m, 0.005, 2.0);
  p.parallax.min_baseline_m = r.real("Confirm.Baseline_m", p.parallax.min_baseline_m, 0.01, 10.0);
  p.max_absence_turn_radps =
      r.angleDeg("Absence.MaximumTurn_degps", radToDeg(p.max_absence_turn_radps), 0.0, 3600.0);
  p.max_mapping_turn_radps =
      r.angleDeg("New.MaximumTurn_degps", radToDeg(p.max_mapping_turn_radps), 0.0, 3600.0);
  readLife(r.group("Life"), p.life);
  readAssociation(r.group("Association"), p.association);
}

void readPrimitives(ConfigReader r, PrimitiveTracker::Params& p) {
  p.interval_us = toStampUs(r.real("Interval_s", toSeconds(p.interval_us), 0.0, 60.0));
  p.published_life = r.real("PublishedLife", p.published_life, 0.0, p.max_life);
  p.finder.confirmed_only = r.boolean("ConfirmedOnly", p.finder.confirmed_only);
  PolygonParams& polygons = p.finder.polygons;
  polygons.min_side_m = r.real("Side.Minimum_m", polygons.min_side_m, 0.01, 100.0);
  polygons.max_side_m = r.real("Side.Maximum_m", polygons.max_side_m, 0.01, 100.0);
  polygons.corner_gap_m = r.real("Corner.Gap_m", polygons.corner_gap_m, 0.001, 5.0);
  polygons.parallel_rad = r.angleDeg("Parallel_deg", radToDeg(polygons.parallel_rad), 0.1, 45.0);
  StripeParams& stripes = p.finder.stripes;
  stripes.min_width_m = r.real("Stripe.MinimumWidth_m", stripes.min_width_m, 0.001, 5.0);
  stripes.max_width_m = r.real("Stripe.MaximumWidth_m", stripes.max_width_m, 0.001, 5.0);
  CircleParams& circles = p.finder.circles;
  circles.min_radius_m = r.real("Circle.MinimumRadius_m", circles.min_radius_m, 0.01, 100.0);
  circles.max_radius_m = r.real("Circle.MaximumRadius_m", circles.max_radius_m, 0.01, 100.0);
  circles.tolerance_m = r.real("Circle.Tolerance_m", circles.tolerance_m, 0.001, 5.0);
  const auto ordered = [&](const char* low, double low_value, const char* high, double high_value) {
    if (low_value >= high_value) r.problem(low, "must be less than " + r.key(high));
  };
  ordered("Side.Minimum_m", polygons.min_side_m, "Side.Maximum_m", polygons.max_side_m);
  ordered("Stripe.MinimumWidth_m", stripes.min_width_m, "Stripe.MaximumWidth_m", stripes.max_width_m);
  ordered("Circle.MinimumRadius_m", circles.min_radius_m, "Circle.MaximumRadius_m", circles.max_radius_m);
}

void readShapeEdges(ConfigReader r, ShapeEdges::Params& p) {
  p.enabled = r.boolean("Enabled", p.enabled);
  LineWidthRange& width = p.line_width;
  width.min_m = r.real("Line.MinimumWidth_m", width.min_m, 0.001, 5.0);
  width.max_m = r.real("Line.MaximumWidth_m", width.max_m, 0.001, 5.0);
  p.circles.sagitta_m = r.real("Circle.Sagitta_m", p.circles.sagitta_m, 0.0001, 1.0);
  if (r.boolean("FarLines", false)) {
    // Distant ends are uncertain by two pixels instead of one.
    p.short_sigmas = p.corners.reach_sigmas = p.junctions.reach_sigmas = 2.0;
    p.corners.most_reach_m = p.junctions.most_reach_m = 0.25;
    p.line_widths.blur_px = 1.0;
    p.junctions.by_one_side = true;
    p.crosses.enabled = true;
  }
  r.alias("PartAtJunctions", "SplitAtJunctions");
  p.junctions.enabled = r.boolean("SplitAtJunctions", p.junctions.enabled);
  p.line_widths.enabled = r.boolean("EvenLineWidths", p.line_widths.enabled);
  if (width.min_m >= width.max_m) {
    r.problem("Line.MinimumWidth_m", "must be less than " + r.key("Line.MaximumWidth_m"));
  }
}

void readAttention(ConfigReader r, AttentionPool::Params& p) {
  using Scanning = AttentionPool::Scanning;
  p.segment_rate = r.real("SegmentRate", p.segment_rate, 0.0, 1000.0);
  p.primitive_rate = r.real("PrimitiveRate", p.primitive_rate, 0.0, 1000.0);
  p.hypothesis_rate = r.real("HypothesisRate", p.hypothesis_rate, 0.0, 1000.0);
  p.client_rate = r.real("ClientRate", p.client_rate, 0.0, 1000.0);
  p.visit_angle_rad = r.angleDeg("VisitAngle_deg", radToDeg(p.visit_angle_rad), 0.0, 180.0);
  p.forced_search_s = r.real("ForcedSearch_s", p.forced_search_s, 0.1, 3600.0);
  p.max_forced_search_s = r.real("ForcedSearchMaximum_s", p.max_forced_search_s, 0.1, 3600.0);
  p.forced_search_objects = r.real("ForcedSearchObjects", p.forced_search_objects, 0.1, 1e6);
  p.look_around_first = r.boolean("LookAroundFirst", p.look_around_first);
  p.count_groups = r.boolean("CountGroups", p.count_groups);
  p.scanning = r.choice("Scanning", p.scanning,
                        {{"random", Scanning::kRandom},
                         {"systematic", Scanning::kSystematic},
                         {"alternate", Scanning::kAlternate}});
  p.pan_step_rad = r.angleDeg("Step.Pan_deg", radToDeg(p.pan_step_rad), 1.0, 360.0);
  p.tilt_step_rad = r.angleDeg("Step.Tilt_deg", radToDeg(p.tilt_step_rad), 1.0, 180.0);
  p.scan_min_tilt_rad = r.angleDeg("ScanTilt.Minimum_deg", radToDeg(p.scan_min_tilt_rad), -90.0, 90.0);
  p.scan_max_tilt_rad = r.angleDeg("ScanTilt.Maximum_deg", radToDeg(p.scan_max_tilt_rad), -90.0, 90.0);
  p.focus_distance_m = r.real("FocusDistance_m", p.focus_distance_m, 0.1, 100.0);
  p.seed = static_cast<std::uint64_t>(r.integer("Seed", static_cast<long>(p.seed), 0, 2'000'000'000));
  if (p.scan_min_tilt_rad > p.scan_max_tilt_rad) {
    r.problem("ScanTilt.Minimum_deg", "must not be more than " + r.key("ScanTilt.Maximum_deg"));
  }
}

void readJointLimits(ConfigReader r, Rig& rig) {
  rig.min_pan_rad = r.angleDeg("Pan.Minimum_deg", radToDeg(rig.min_pan_rad), -360.0, 360.0);
  rig.max_pan_rad = r.angleDeg("Pan.Maximum_deg", radToDeg(rig.max_pan_rad), -360.0, 360.0);
  rig.min_tilt_rad = r.angleDeg("Tilt.Minimum_deg", radToDeg(rig.min_tilt_rad), -90.0, 90.0);
  rig.max_tilt_rad = r.angleDeg("Tilt.Maximum_deg", radToDeg(rig.max_tilt_rad), -90.0, 90.0);
  if (rig.min_pan_rad >= rig.max_pan_rad) {
    r.problem("Pan.Minimum_deg", "must be less than " + r.key("Pan.Maximum_deg"));
  }
  if (rig.min_tilt_rad >= rig.max_tilt_rad) {
    r.problem("Tilt.Minimum_deg", "must be less than " + r.key("Tilt.Maximum_deg"));
  }
}

void readGaze(ConfigReader r, GazeController::Params& p) {
  using Control = GazeController::Control;
  p.initial_mode =
      r.choice("Mode", p.initial_mode,
               {{"attend", GazeMode::kAttend}, {"hold", GazeMode::kHold}, {"off", GazeMode::kOff}});
  p.control = r.choice("Control", p.control,
                       {{"proportional", Control::kProportional}, {"position", Control::kPosition}});
  p.object_min_tilt_rad = r.angleDeg("ObjectTilt.Minimum_deg", radToDeg(p.object_min_tilt_rad), -90.0, 90.0);
  p.object_max_tilt_rad = r.angleDeg("ObjectTilt.Maximum_deg", radToDeg(p.object_max_tilt_rad), -90.0, 90.0);
  if (p.object_min_tilt_rad > p.object_max_tilt_rad) {
    r.problem("ObjectTilt.Minimum_deg", "must not be more than " + r.key("ObjectTilt.Maximum_deg"));
  }
  p.max_pan_rate_radps = r.angleDeg("Rate.Pan_degps", radToDeg(p.max_pan_rate_radps), 1.0, 2000.0);
  p.max_tilt_rate_radps = r.angleDeg("Rate.Tilt_degps", radToDeg(p.max_tilt_rate_radps), 1.0, 2000.0);
  p.max_pan_acceleration_radps2 =
      r.angleDeg("Acceleration.Pan_degps2", radToDeg(p.max_pan_acceleration_radps2), 10.0, 50'000.0);
  p.max_tilt_acceleration_radps2 =
      r.angleDeg("Acceleration.Tilt_degps2", radToDeg(p.max_tilt_acceleration_radps2), 10.0, 50'000.0);
  p.saccade_slowdown = r.real("Saccade.Slowdown", p.saccade_slowdown, 1.0, 10.0);
  p.gain_per_s = r.real("Gain_per_s", p.gain_per_s, 0.01, 100.0);
  p.pan_dead_zone_rad = r.angleDeg("DeadZone.Pan_deg", radToDeg(p.pan_dead_zone_rad), 0.0, 45.0);
  p.tilt_dead_zone_rad = r.angleDeg("DeadZone.Tilt_deg", radToDeg(p.tilt_dead_zone_rad), 0.0, 45.0);
  p.arrived_rad = r.angleDeg("Arrived_deg", radToDeg(p.arrived_rad), 0.05, 45.0);
  p.saccade_timeout_s = r.real("SaccadeTimeout_s", p.saccade_timeout_s, 0.1, 60.0);
  p.analyse_s = r.real("Analyse_s", p.analyse_s, 0.0, 60.0);
  p.track_s = r.real("Track_s", p.track_s, 0.0, 60.0);
  p.client_track_s = r.real("ClientTrack_s", p.client_track_s, 0.0, 60.0);
  p.lookahead_s = r.real("Lookahead_s", p.lookahead_s, 0.0, 2.0);
}

}  // namespace

CameraMount readCameraMount(ConfigReader& reader) {
  CameraMount mount;
  mount.T_robot_pantilt = readPose(reader, "Mount.PanTilt", {0.0, 0.0, 0.45});
  mount.T_head_camera_body = readPose(reader, "Mount.Camera", {0.0, 0.0, 0.0});
  return mount;
}

MemoryPipelineParams readMemoryPipeline(ConfigReader& reader) {
  const bool chapter = reader.choice("Mode", false, {{"default", false}, {"chapter", true}});
  MemoryPipelineParams p = chapter ? MemoryPipelineParams::chapter() : MemoryPipelineParams::standard();
  p.memory.rig.mount = readCameraMount(reader);
  readJointLimits(reader.group("Gaze"), p.memory.rig);
  readVision(reader.group("Vision"), p.vision);
  readGate(reader.group("FrameGate"), p.memory.gate);
  readGround(reader.group("Ground"), p.memory.projector);
  reader.alias("Ground.ThinLineBlur_px", "Ground.LineBlur_px");
  p.memory.edge_blur.sigma_px = reader.real("Ground.LineBlur_px", p.memory.edge_blur.sigma_px, 0.0, 10.0);
  readMemory(reader.group("Memory"), p.memory.memory);
  ConfigReader kidnap = reader.group("Kidnap");
  p.memory.kidnap.enabled = kidnap.boolean("Enabled", p.memory.kidnap.enabled);
  p.memory.kidnap.duration_s = kidnap.real("Duration_s", p.memory.kidnap.duration_s, 0.0, 60.0);
  readPrimitives(reader.group("Primitives"), p.memory.primitives);
  readShapeEdges(reader.group("ShapeEdges"), p.memory.shape_edges);
  readAttention(reader.group("Attention"), p.memory.attention);
  readGaze(reader.group("Gaze"), p.memory.gaze);
  return p;
}

ActiveVisualMemoryConfig readActiveVisualMemoryConfig(ConfigReader& reader) {
  ActiveVisualMemoryConfig config;
  config.camera_proxy = reader.requiredText("Camera.Proxy", "the proxy of an avm::Camera");
  config.odometry_proxy = reader.requiredText("Odometry.Proxy", "the proxy of an avm::Odometry");
  config.pan_tilt_proxy = reader.text("PanTilt.Proxy", "");
  config.palette = reader.existingFile("Palette", "a palette, such as cfg/maps/corridor.palette");
  config.every_frame = reader.boolean("EveryFrame", config.every_frame);
  config.images_lost_s = reader.real("ImagesLost_s", config.images_lost_s, 0.05, 60.0);
  config.overlay = reader.boolean("Overlay.Enabled", config.overlay);
  config.overlay_rate_hz = reader.real("Overlay.Rate_hz", config.overlay_rate_hz, 0.1, 120.0);
  config.overlay_scale = static_cast<int>(reader.integer("Overlay.Scale", config.overlay_scale, 1, 8));
  config.pipeline = readMemoryPipeline(reader);
  config.assembler.mount = config.pipeline.memory.rig.mount;
  config.assembler.has_pan_tilt = config.hasPanTilt();
  config.assembler.max_gap_us = toStampUs(reader.real("History.MaximumGap_s", 0.5, 0.01, 10.0));
  config.assembler.max_jump_m =
      reader.real("History.MaximumJump_m", config.assembler.max_jump_m, 0.01, 100.0);
  config.assembler.max_jump_rad =
      reader.angleDeg("History.MaximumJump_deg", radToDeg(config.assembler.max_jump_rad), 0.5, 180.0);
  if (!config.hasPanTilt()) config.pipeline.memory.gaze.initial_mode = GazeMode::kOff;
  return config;
}

}  // namespace vismem
