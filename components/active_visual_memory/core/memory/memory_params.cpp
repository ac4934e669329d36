#include "active_visual_memory/core/memory/memory_params.h"

namespace vismem {

void MemoryGateParams::visit(ParameterVisitor& v) {
  v.real(expert("Near.Distance_m",
                "M3: distance on the floor within which a segment belongs to an element; half of it "
                "within one image (M2)"),
         near_distance_m, 0.001, 5.0);
  v.real(expert("Match.Slack_m", "error of a match on the floor that the covariances do not contain (sigma)"),
         slack_m, 0.0, 5.0);
  v.real(expert("Drift.PerMetre", "drift of an unobserved element per metre driven (sigma)"), drift_per_m,
         0.0, 1.0);
  v.real(expert("Drift.PerRadian", "the same of the heading per radian turned"), drift_per_rad, 0.0, 1.0);
  v.angle(expert("Absence.MaximumTurn_degps", "turn rate of the camera up to which absence is evidence"),
          max_absence_turn_radps, 0.0, 3600.0);
}

void MemoryEstimationParams::visit(ParameterVisitor& v) {
  OdometryErrors& odometry = map_filter.odometry;
  v.angle(expert("Align.Turn_degpm", "lasting heading error of odometry per metre (prior sigma)"),
          odometry.turn_per_m, 0.0, 90.0);
  v.real(expert("Align.Turn_per_rad", "the same per radian turned"), odometry.turn_per_rad, 0.0, 1.0);
  v.angle(expert("Align.TurnNoise_deg",
                 "random heading error after 1 m of the way of wheels or feet (sigma; grows with "
                 "the root of the way)"),
          odometry.turn_noise, 0.0, 90.0);
  v.alias("Align.Compass", "Align.DominantDirection");
  v.flag(basic("Align.DominantDirection",
               "measure the heading against the dominant direction of the lines; for legs"),
         use_dominant_direction);
  v.alias("Lean.Mount_deg", "CameraTilt.Mount_deg");
  v.angle(basic("CameraTilt.Mount_deg",
                "tilt error of the pan-tilt unit on the robot (prior sigma); 0: not estimated"),
          tilt_prior.mount_rad, 0.0, 10.0);
  v.alias("Lean.Camera_deg", "CameraTilt.Camera_deg");
  v.angle(
      basic("CameraTilt.Camera_deg", "tilt error of the camera on the unit (prior sigma); 0: not estimated"),
      tilt_prior.camera_rad, 0.0, 10.0);
  v.alias("Lean.Sway_deg", "CameraTilt.PerFrame_deg");
  v.angle(
      basic("CameraTilt.PerFrame_deg", "further tilt of single images (prior sigma); 1 and more for legs"),
      tilt_prior.per_frame_rad, 0.0, 10.0);
}

void SegmentMemoryParams::visit(ParameterVisitor& v) {
  gates.visit(v);
  estimation.visit(v);
  v.group("Association", association);
  v.alias("TellInCourse", "SnapToDominantDirection");
  v.flag(expert("SnapToDominantDirection",
                "publish lines within a pixel of the dominant direction with that direction; "
                "confirm others from 0.1 m"),
         confirmation.snap_to_dominant_direction);
  v.integer(expert("GapVotes", "images that must see a gap in a line to split it; 0: lines are not split"),
            gap_votes, 0, 1000);
}

SegmentMemoryParams SegmentMemoryParams::chapter() {
  SegmentMemoryParams p;
  p.fusion = Fusion::kChapter;
  p.estimation.enabled = false;
  p.confirmation.by_parallax = false;
  p.retention.min_sightings = 1;
  p.retention.unverified_decay = 1.0;
  // +20 per tick of 200 ms when observed, -1 when not, whatever the reason.
  LifeParams& life = p.retention.life;
  life.tick_us = 200'000;
  life.gain_per_s = 100.0;
  life.fade_per_s = 5.0;
  life.absent_per_s = 5.0;
  life.occluded_per_s = 5.0;
  p.association.use_polarity = false;
  p.association.fragment_px = p.association.max_normal_px;
  return p;
}

}  // namespace vismem
