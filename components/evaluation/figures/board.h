/// @file Figures of experiments: pictures and plans of the floor side by side. Values in, picture out. Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "evaluation/core/memory_score.h"
#include "evaluation/figures/canvas.h"
#include "evaluation/figures/view_cone.h"

namespace vismem {

struct PlanLine {
  Segment2 world;  ///< [m]
  Rgb color;
  double width_px = 1.6;
  bool dashed = false;
  std::string name{};  ///< written beside it, where it is long enough
};

/// The floor from above, in the order in which it is drawn.
struct Plan {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< corner of the shown part of the world [m]
  Eigen::Vector2d high = Eigen::Vector2d::Ones();
  std::vector<PlanLine> lines;
  std::vector<std::vector<Eigen::Vector2d>> paths;  ///< [m]
  std::optional<Pose2> robot;                       ///< in world
  std::optional<ViewCone> view;                     ///< from the robot
};

struct ColoredSegment {
  Segment2 px;  ///< raw pixels of the picture, centres on integers
  Rgb color;
};

struct LegendEntry {
  std::string text;
  Rgb color;
};

/// A picture (CV_8UC3, R G B) or a plan.
struct BoardPanel {
  std::string title;
  std::vector<std::string> caption;  ///< lines below it
  cv::Mat picture;
  std::optional<Plan> plan;
  int columns = 1;  ///< as wide as so many panels
  /// Drawn over the picture, which is paled then; dots mark their ends, so that gaps are visible.
  std::vector<ColoredSegment> segments{};
};

struct Board {
  std::string title;
  std::string subtitle;
  std::vector<std::vector<BoardPanel>> rows;
  std::vector<LegendEntry> legend;
  std::vector<std::string> row_titles{};  ///< above the first rows
};

/// @param panel_width of each panel [px]; heights follow from the contents.
/// @return CV_8UC3 (R, G, B).
cv::Mat drawBoard(const Board& board, int panel_width);

/// A memory's score over the true edges: right green, partial orange, false red, unconfirmed dashed, missed
/// dark.
Plan planOfScore(const MemoryScore& score, const std::vector<RememberedEdge>& memory,
                 const std::vector<TrueEdge>& truth);
/// The colours of planOfScore.
std::vector<LegendEntry> legendOfScore();

}  // namespace vismem
