#include "evaluation/figures/board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

constexpr double kBoardMargin_px = 18.0;
constexpr double kBoardHeader_px = 62.0;
constexpr double kTitle_px = 22.0;
constexpr double kLine_px = 17.0;
constexpr double kBoardLegend_px = 34.0;
constexpr double kLegendText_pt = 9.5;
constexpr double kGridText_px = 8.5;
constexpr double kKey_px = 24.0;
constexpr double kKeyGap_px = 7.0;
constexpr double kRowTitle_px = 24.0;
/// Share of white below segments: lines of any colour stand out.
constexpr double kPaleness = 0.45;

constexpr Rgb kTruthColor{205, 208, 214};
constexpr Rgb kMissedColor{30, 30, 30};
constexpr Rgb kRightColor{20, 150, 70};
constexpr Rgb kPartialColor{235, 140, 20};
constexpr Rgb kFalseColor{215, 35, 35};
constexpr Rgb kUnconfirmedColor{130, 100, 200};

double panelHeight(const BoardPanel& panel, double width) {
  if (panel.plan) {
    const Eigen::Vector2d size = panel.plan->high - panel.plan->low;
    return std::round(width * std::clamp(size.y() / size.x(), 0.2, 2.0));
  }
  if (panel.picture.empty()) return 0.0;
  return std::round(width * panel.picture.rows / panel.picture.cols);
}

void drawPlan(Canvas& canvas, const Plan& plan, const Eigen::Vector2d& low, double width, double height) {
  const Eigen::Vector2d size = plan.high - plan.low;
  const double scale = std::min(width / size.x(), height / size.y());
  const auto px = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(low.x() + (p.x() - plan.low.x()) * scale,
                           low.y() + height - (p.y() - plan.low.y()) * scale);
  };
  canvas.restrictTo(low, low + Eigen::Vector2d(width, height));
  const double step = gridStep(scale);
  for (double x = std::ceil(plan.low.x() / step) * step; x <= plan.high.x(); x += step) {
    canvas.line(px({x, plan.low.y()}), px({x, plan.high.y()}), colors::kGrid);
    canvas.text(metresText(x), px({x, plan.low.y()}) + Eigen::Vector2d(3.0, -4.0), kGridText_px,
                colors::kFaintInk);
  }
  for (double y = std::ceil(plan.low.y() / step) * step; y <= plan.high.y(); y += step) {
    canvas.line(px({plan.low.x(), y}), px({plan.high.x(), y}), colors::kGrid);
    canvas.text(metresText(y), px({plan.low.x(), y}) + Eigen::Vector2d(3.0, -3.0), kGridText_px,
                colors::kFaintInk);
  }
  if (plan.robot && plan.view) {
    const Pose2& robot = *plan.robot;
    std::vector<Eigen::Vector2d> cone{px(robot.position())};
    constexpr int kSteps = 16;
    for (int i = 0; i <= kSteps; ++i) {
      const double a =
          plan.view->heading_rad + plan.view->opening_rad * (static_cast<double>(i) / kSteps - 0.5);
      cone.push_back(px(robot.position() + plan.view->range_m * Eigen::Vector2d(std::cos(a), std::sin(a))));
    }
    canvas.fill(cone, colors::kEstimate, 0.10);
  }
  for (const auto& path : plan.paths) {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector2d& p : path) points.push_back(px(p));
    canvas.polyline(points, colors::kEstimate, 1.4);
  }
  for (const PlanLine& line : plan.lines) {
    if (line.dashed) {
      canvas.dashedLine(px(line.world.a), px(line.world.b), line.color, line.width_px);
    } else {
      canvas.line(px(line.world.a), px(line.world.b), line.color, line.width_px);
    }
  }
  for (const PlanLine& line : plan.lines) {
    const double width = canvas.textWidth(line.name, kGridText_px);
    if (line.name.empty() || line.world.length() * scale < width) continue;
    // A third of the way: the two edges of a painted line run against each other.
    const Eigen::Vector2d at = px(line.world.a + (line.world.b - line.world.a) / 3.0);
    canvas.text(line.name, at + Eigen::Vector2d(0.0, -3.0), kGridText_px, colors::kInk, Align::kCentre);
  }
  if (plan.robot) {
    const Eigen::Vector2d at = px(plan.robot->position());
    const double a = plan.robot->theta;
    canvas.disc(at, std::max(4.0, 0.15 * scale), colors::kEstimate, 0.8);
    canvas.line(at, px(plan.robot->position() + 0.3 * Eigen::Vector2d(std::cos(a), std::sin(a))),
                colors::kEstimate, 2.5);
  }
  canvas.release();
}

void drawPicture(Canvas& canvas, const BoardPanel& panel, const Eigen::Vector2d& low, double width,
                 double height) {
  cv::Mat fitted;
  const bool larger = panel.picture.cols < width;
  cv::resize(panel.picture, fitted, {static_cast<int>(width), static_cast<int>(height)}, 0, 0,
             larger ? cv::INTER_LINEAR : cv::INTER_AREA);
  if (!panel.segments.empty()) fitted.convertTo(fitted, -1, 1.0 - kPaleness, 255.0 * kPaleness);
  canvas.picture(fitted, low);
  const double scale = width / panel.picture.cols;
  // The centre of pixel 0 lies half a pixel inside the picture.
  const auto at = [&](const Eigen::Vector2d& px) {
    return Eigen::Vector2d(low + (px + Eigen::Vector2d::Constant(0.5)) * scale);
  };
  canvas.restrictTo(low, low + Eigen::Vector2d(width, height));
  for (const ColoredSegment& segment : panel.segments) {
    canvas.line(at(segment.px.a), at(segment.px.b), segment.color, 1.5);
    for (const Eigen::Vector2d& end : {segment.px.a, segment.px.b}) canvas.disc(at(end), 2.0, segment.color);
  }
  canvas.release();
}

/// Where the entries begin, from the top of the legend, in as many lines as it takes.
std::vector<Eigen::Vector2d> legendPlaces(const std::vector<LegendEntry>& legend, double width) {
  const Canvas ruler(1, 1);
  std::vector<Eigen::Vector2d> places;
  Eigen::Vector2d at(kBoardMargin_px, 0.0);
  for (const LegendEntry& entry : legend) {
    const double entry_px = kKey_px + kKeyGap_px + ruler.textWidth(entry.text, kLegendText_pt);
    if (at.x() > kBoardMargin_px && at.x() + entry_px > width - kBoardMargin_px)
      at = {kBoardMargin_px, at.y() + kLine_px};
    places.push_back(at);
    at.x() += entry_px + kKey_px;
  }
  return places;
}

void drawLegend(Canvas& canvas, const std::vector<LegendEntry>& legend,
                const std::vector<Eigen::Vector2d>& places, double top) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d at = places[i] + Eigen::Vector2d(0.0, top);
    canvas.line(at + Eigen::Vector2d(0.0, 12.0), at + Eigen::Vector2d(kKey_px, 12.0), legend[i].color, 3.0);
    canvas.text(legend[i].text, at + Eigen::Vector2d(kKey_px + kKeyGap_px, 16.0), kLegendText_pt);
  }
}

/// Sizes of the rows of a board [px].
struct RowSize {
  int columns = 0;
  double pictures = 0.0;  ///< height of the highest picture
  double head = kTitle_px;
  double height = 0.0;  ///< of the whole row
};

double widthOf(const BoardPanel& panel, int panel_width) {
  return panel.columns * (panel_width + kBoardMargin_px) - kBoardMargin_px;
}

RowSize sizeOf(const std::vector<BoardPanel>& row, int panel_width, bool has_title) {
  RowSize size;
  std::size_t captions = 0;
  for (const BoardPanel& panel : row) {
    size.columns += panel.columns;
    size.pictures = std::max(size.pictures, panelHeight(panel, widthOf(panel, panel_width)));
    captions = std::max(captions, panel.caption.size());
  }
  if (has_title) size.head += kRowTitle_px;
  size.height = size.head + size.pictures + kLine_px * static_cast<double>(captions) + kBoardMargin_px;
  return size;
}

void drawPanel(Canvas& canvas, const BoardPanel& panel, const Eigen::Vector2d& low, double width,
               double caption_top) {
  canvas.text(panel.title, low - Eigen::Vector2d(0.0, 7.0), 10.0, colors::kInk);
  const double height = panelHeight(panel, width);
  if (panel.plan) {
    drawPlan(canvas, *panel.plan, low, width, height);
    canvas.rectangle(low, low + Eigen::Vector2d(width, height), colors::kGrid);
  } else if (!panel.picture.empty()) {
    drawPicture(canvas, panel, low, width, height);
  }
  for (const std::string& text : panel.caption) {
    caption_top += kLine_px;
    canvas.text(text, {low.x(), caption_top - 3.0}, 9.5, colors::kFaintInk);
  }
}

}  // namespace

cv::Mat drawBoard(const Board& board, int panel_width) {
  int columns = 1;
  double height = kBoardHeader_px;
  std::vector<RowSize> sizes;
  for (const auto& row : board.rows) {
    sizes.push_back(sizeOf(row, panel_width, sizes.size() < board.row_titles.size()));
    columns = std::max(columns, sizes.back().columns);
    height += sizes.back().height;
  }
  const double width = kBoardMargin_px + columns * (panel_width + kBoardMargin_px);
  const auto places = legendPlaces(board.legend, width);
  height += kBoardLegend_px + (places.empty() ? 0.0 : places.back().y());
  Canvas canvas(static_cast<int>(width), static_cast<int>(height));
  canvas.text(board.title, {kBoardMargin_px, 28.0}, 13.0, colors::kInk, Align::kLeft, true);
  canvas.text(board.subtitle, {kBoardMargin_px, 47.0}, 9.5, colors::kFaintInk);
  double v = kBoardHeader_px;
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    if (r < board.row_titles.size())
      canvas.text(board.row_titles[r], {kBoardMargin_px, v + 14.0}, 10.0, colors::kEstimate, Align::kLeft,
                  true);
    double u = kBoardMargin_px;
    for (const BoardPanel& panel : board.rows[r]) {
      const double panel_px = widthOf(panel, panel_width);
      drawPanel(canvas, panel, {u, v + sizes[r].head}, panel_px, v + sizes[r].head + sizes[r].pictures);
      u += panel_px + kBoardMargin_px;
    }
    v += sizes[r].height;
  }
  drawLegend(canvas, board.legend, places, v);
  return canvas.finish();
}

Plan planOfScore(const MemoryScore& score, const std::vector<RememberedEdge>& memory,
                 const std::vector<TrueEdge>& truth) {
  Plan plan;
  plan.low = Eigen::Vector2d::Constant(1e9);
  plan.high = -plan.low;
  for (std::size_t e = 0; e < truth.size(); ++e) {
    const bool missed =
        std::find(score.missed.begin(), score.missed.end(), static_cast<int>(e)) != score.missed.end();
    for (const Segment2& piece : truth[e].pieces) {
      plan.low = plan.low.cwiseMin(piece.a).cwiseMin(piece.b);
      plan.high = plan.high.cwiseMax(piece.a).cwiseMax(piece.b);
      plan.lines.push_back({piece, missed ? kMissedColor : kTruthColor, missed ? 3.0 : 4.5, false});
    }
  }
  plan.low -= Eigen::Vector2d::Constant(0.4);
  plan.high += Eigen::Vector2d::Constant(0.4);
  for (const RememberedEdge& edge : memory) {
    if (!edge.confirmed) plan.lines.push_back({edge.world, kUnconfirmedColor, 1.4, true});
  }
  for (const auto& judgement : score.judged) {
    const Rgb color = judgement.verdict == MemoryScore::Verdict::kRight     ? kRightColor
                      : judgement.verdict == MemoryScore::Verdict::kPartial ? kPartialColor
                                                                            : kFalseColor;
    plan.lines.push_back({judgement.edge.world, color, 1.8, false});
  }
  return plan;
}

std::vector<LegendEntry> legendOfScore() {
  return {{"true edge", kTruthColor}, {"shown in full, not remembered", kMissedColor},
          {"right", kRightColor},     {"on an edge, an end wrong", kPartialColor},
          {"false", kFalseColor},     {"not confirmed", kUnconfirmedColor}};
}

}  // namespace vismem
