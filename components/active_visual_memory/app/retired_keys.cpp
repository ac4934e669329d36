#include "active_visual_memory/app/retired_keys.h"

namespace vismem {
namespace {

constexpr const char* kFixed = "its value is fixed by the mode";

}  // namespace

void acceptRetiredMemoryKeys(ConfigReader& reader) {
  reader.group("Vision").retired("Merge.Angle_deg Merge.Offset_px Merge.Gap_px", kFixed);
  reader.group("Vision").retired("CutAtGaps", "the memory finds the gaps of a line: Memory.GapVotes");
  reader.group("FrameGate").retired("Distance_m Angle_deg MaximumInterval_s", kFixed);
  reader.group("Ground").retired(
      "HorizonMargin_px BorderMargin_px EndShort_px Noise.Across_px Noise.Along_px Noise.Timing_s", kFixed);
  reader.group("Ground").retired("LineBlur_px ThinLineBlur_px", "edges are taken as detected");
  reader.group("Ground").retired("Noise.Pitch_deg",
                                 "it is what Memory.CameraTilt.PerFrame_deg says, at least 0.34");
  reader.group("Memory").retired(
      "Association.Overlap Association.Polarity Life.Maximum Life.Initial Life.Threshold "
      "Life.Gain_per_s Life.OutOfView_per_s Life.Absent_per_s Life.Occluded_per_s Life.Tick_s "
      "Life.Covered_per_s Fusion CacheRadius_m MaximumElements MinimumSightings Near.Angle_deg "
      "Near.Gap_m Match.Sigmas Align.Enabled Align.Shift_per_m Align.TravelScale "
      "Align.Slip.LeastImages Align.Slip.Images Align.Slip.Sigmas Align.Slip.Least_deg "
      "CameraTilt.DominantDirection_deg Confirm.ByParallax Confirm.LeastHeight_m "
      "Confirm.Baseline_m New.MaximumTurn_degps Lean.Course_deg",
      kFixed);
  reader.group("Primitives")
      .retired(
          "Interval_s PublishedLife Side.Minimum_m Side.Maximum_m Corner.Gap_m Parallel_deg "
          "Stripe.MinimumWidth_m Stripe.MaximumWidth_m Circle.MinimumRadius_m Circle.MaximumRadius_m "
          "Circle.Tolerance_m",
          kFixed);
  reader.group("ShapeEdges").retired("Enabled Circle.Sagitta_m", kFixed);
  reader.group("ShapeEdges").retired("EvenLineWidths", "distant lines stay where they are measured");
  reader.group("Attention")
      .retired(
          "VisitAngle_deg ForcedSearchMaximum_s ForcedSearchObjects LookAroundFirst CountGroups "
          "Scanning ScanTilt.Minimum_deg ScanTilt.Maximum_deg Step.Pan_deg Step.Tilt_deg FocusDistance_m "
          "Seed",
          kFixed);
  reader.group("Gaze").retired(
      "Control ObjectTilt.Minimum_deg ObjectTilt.Maximum_deg Saccade.Slowdown Gain_per_s "
      "DeadZone.Pan_deg DeadZone.Tilt_deg Arrived_deg SaccadeTimeout_s Analyse_s Track_s "
      "ClientTrack_s Lookahead_s Acceleration.Pan_degps2 Acceleration.Tilt_degps2",
      kFixed);
  reader.group("Kidnap").retired("Enabled Duration_s", kFixed);
  reader.retired("ImagesLost_s", kFixed);
  reader.group("Overlay").retired("Scale", kFixed);
  reader.group("History").retired("MaximumGap_s MaximumJump_m MaximumJump_deg", kFixed);
  reader.group("Memory").retired("Align.MapFilter Align.Joint",
                                 "every robot's drift, camera tilt and lines are estimated in one filter");
  reader.group("Memory").retired("Confirm.LeastLength_m", "SnapToDominantDirection sets it");
  reader.group("Memory").retired("CameraTilt.PerFrameInflation Lean.SwayDoubt",
                                 "the filter knows how the errors of lines depend on each other");
}

}  // namespace vismem
