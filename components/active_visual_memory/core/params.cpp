#include "active_visual_memory/core/attentive_visual_memory.h"
#include "common/geometry/angles.h"

namespace vismem {

AttentiveVisualMemoryParams AttentiveVisualMemoryParams::standard() {
  return {};
}

AttentiveVisualMemoryParams AttentiveVisualMemoryParams::chapter() {
  AttentiveVisualMemoryParams p;
  p.thin_lines.sigma_px = 0.0;
  p.memory.fusion = SegmentMemory::Fusion::kChapter;
  p.memory.align = false;
  p.memory.confirm_by_parallax = false;
  p.memory.min_sightings = 1;
  p.memory.suspect_fading = 1.0;
  // +20 per tick of 200 ms when observed, -1 when not, whatever the reason.
  p.memory.life.tick_us = 200'000;
  p.memory.life.gain_per_s = 100.0;
  p.memory.life.fade_per_s = 5.0;
  p.memory.life.absent_per_s = 5.0;
  p.memory.life.covered_per_s = 5.0;
  p.memory.association.use_polarity = false;
  p.memory.association.fragment_px = p.memory.association.max_normal_px;
  p.kidnap.enabled = false;
  p.shape_edges.enabled = false;
  p.attention.visit_angle_rad = degToRad(5.0);
  p.attention.count_groups = false;
  p.attention.look_around_first = false;
  p.attention.forced_search_s = 5.0;
  p.attention.max_forced_search_s = 20.0;
  p.attention.scanning = AttentionPool::Scanning::kAlternate;
  p.attention.scan_min_tilt_rad = degToRad(-31.0);
  p.attention.scan_max_tilt_rad = degToRad(31.0);
  p.gaze.control = GazeController::Control::kProportional;
  p.gaze.object_min_tilt_rad = p.gaze.min_tilt_rad;
  p.gaze.object_max_tilt_rad = p.gaze.max_tilt_rad;
  p.gaze.analyse_s = 1.0;
  p.gaze.track_s = 3.0;
  p.gaze.client_track_s = 3.0;
  p.gaze.lookahead_s = 0.0;
  p.gaze.max_pan_rate_radps = degToRad(60.0);
  p.gaze.max_tilt_rate_radps = degToRad(30.0);
  // The proportional controllers creep into the dead zone.
  p.gaze.quiet_radps = 1.0;
  return p;
}

}  // namespace vismem
