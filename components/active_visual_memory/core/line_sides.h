/// @file Both sides of painted lines, and their width. Pure. SPEC M9.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/memory_element.h"
#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Two edges that run side by side, against each other.
struct SideBySide {
  double from_m = 0.0;  ///< what both have, along the first one from its end a ..
  double to_m = 0.0;    ///< .. to here
  double left_m = 0.0;  ///< how far each lies to the left of the other, beside the middle of that; < 0: right
};

/// @return empty when they do not run against each other within the angle, or have nothing in common.
std::optional<SideBySide> sideBySide(const Segment2& one, const Segment2& other, double max_angle_rad);

/// Painted lines of one kind have one width. Far lines are thinner than the blur of the image, and nothing in
/// an image tells how far apart their sides are; near ones tell.
struct LineWidthParams {
  bool enabled = true;
  double min_width_m = 0.02;
  double max_width_m = 0.13;
  double max_angle_rad = 0.10;       ///< between both sides
  double min_overlap = 0.5;          ///< of the shorter side
  double near_sigma_m = 0.02;        ///< an end of each side was seen so well: such lines tell the width ..
  double least_length_widths = 3.0;  ///< .. which are so many times longer than wide, at least ..
  double agree_m = 0.015;            ///< .. if most of them agree within this
  double agree_share = 0.7;
  double most_shift_m = 0.04;  ///< no end of a side is moved further ..
  /// .. or than so many pixels of its best view; so much further apart than lines are wide, at most, sides of
  /// a line may seem from afar.
  double blur_px = 0.0;
  // A side that is not confirmed lies on the floor when all of it runs beside a confirmed one of its kind, at
  // the width of a line: an edge that stands up would show there from one place alone.
  double partner_overlap = 0.8;
  double partner_least_m = 0.15;  ///< shorter ones are not confirmed by it
};

/// Signed widths by label: > 0 where the paint lies to the left of both sides (a bright line), < 0 to the
/// right.
using LineWidths = std::map<Label, double>;

/// @return the widths that near lines tell; none when disabled. Nothing is moved.
LineWidths nearLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          const LineWidthParams& params);

/// Puts the sides of lines that were only seen from afar as far apart as near lines of the same label have
/// theirs, and confirms the second side of a line. @param elements what the segments were taken from.
/// @return the widths that near lines tell.
LineWidths evenLineWidths(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          const LineWidthParams& params);

}  // namespace vismem
