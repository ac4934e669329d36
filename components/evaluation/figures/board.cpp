#include "evaluation/figures/board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

constexpr double kMargin_px = 18.0;
constexpr double kHeader_px = 62.0;
constexpr double kTitle_px = 22.0;
constexpr double kLine_px = 17.0;
constexpr double kLegend_px = 34.0;
constexpr double kLegendText_pt = 9.5;
constexpr double kKey_px = 24.0;
constexpr double kKeyGap_px = 7.0;

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
  for (double x = std::ceil(plan.low.x()); x <= plan.high.x(); x += 1.0) {
    canvas.line(px({x, plan.low.y()}), px({x, plan.high.y()}), colors::kGrid);
  }
  for (double y = std::ceil(plan.low.y()); y <= plan.high.y(); y += 1.0) {
    canvas.line(px({plan.low.x(), y}), px({plan.high.x(), y}), colors::kGrid);
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
  if (plan.robot) {
    const Eigen::Vector2d at = px(plan.robot->position());
    const double a = plan.robot->theta;
    canvas.disc(at, std::max(4.0, 0.15 * scale), colors::kEstimate, 0.8);
    canvas.line(at, px(plan.robot->position() + 0.3 * Eigen::Vector2d(std::cos(a), std::sin(a))),
                colors::kEstimate, 2.5);
  }
  canvas.release();
}

/// Where the entries begin, from the top of the legend, in as many lines as it takes.
std::vector<Eigen::Vector2d> legendPlaces(const std::vector<LegendEntry>& legend, double width) {
  const Canvas ruler(1, 1);
  std::vector<Eigen::Vector2d> places;
  Eigen::Vector2d at(kMargin_px, 0.0);
  for (const LegendEntry& entry : legend) {
    const double entry_px = kKey_px + kKeyGap_px + ruler.textWidth(entry.text, kLegendText_pt);
    if (at.x() > kMargin_px && at.x() + entry_px > width - kMargin_px) at = {kMargin_px, at.y() + kLine_px};
    places.push_back(at);
    at.x() += entry_px + kKey_px;
  }
  return places;
}

}  // namespace

cv::Mat drawBoard(const Board& board, int panel_width) {
  const auto widthOf = [&](const BoardPanel& panel) {
    return panel.columns * (panel_width + kMargin_px) - kMargin_px;
  };
  int columns = 1;
  double height = kHeader_px;
  std::vector<double> row_heights;
  std::vector<double> picture_heights;
  for (const auto& row : board.rows) {
    int columns_here = 0;
    double pictures = 0.0;
    std::size_t captions = 0;
    for (const BoardPanel& panel : row) {
      columns_here += panel.columns;
      pictures = std::max(pictures, panelHeight(panel, widthOf(panel)));
      captions = std::max(captions, panel.caption.size());
    }
    columns = std::max(columns, columns_here);
    picture_heights.push_back(pictures);
    row_heights.push_back(kTitle_px + pictures + kLine_px * static_cast<double>(captions) + kMargin_px);
    height += row_heights.back();
  }
  const double width = kMargin_px + columns * (panel_width + kMargin_px);
  const auto places = legendPlaces(board.legend, width);
  height += kLegend_px + (places.empty() ? 0.0 : places.back().y());
  Canvas canvas(static_cast<int>(width), static_cast<int>(height));
  canvas.text(board.title, {kMargin_px, 28.0}, 13.0, colors::kInk, Align::kLeft, true);
  canvas.text(board.subtitle, {kMargin_px, 47.0}, 9.5, colors::kFaintInk);
  double v = kHeader_px;
  for (std::size_t r = 0; r < board.rows.size(); ++r) {
    double u = kMargin_px;
    for (const BoardPanel& panel : board.rows[r]) {
      const double panel_px = widthOf(panel);
      const Eigen::Vector2d low(u, v + kTitle_px);
      u += panel_px + kMargin_px;
      canvas.text(panel.title, low - Eigen::Vector2d(0.0, 7.0), 10.0, colors::kInk);
      const double h = panelHeight(panel, panel_px);
      if (panel.plan) {
        drawPlan(canvas, *panel.plan, low, panel_px, h);
        canvas.rectangle(low, low + Eigen::Vector2d(panel_px, h), colors::kGrid);
      } else if (!panel.picture.empty()) {
        cv::Mat fitted;
        const bool larger = panel.picture.cols < panel_px;
        cv::resize(panel.picture, fitted, {static_cast<int>(panel_px), static_cast<int>(h)}, 0, 0,
                   larger ? cv::INTER_LINEAR : cv::INTER_AREA);
        canvas.picture(fitted, low);
      }
      double line = low.y() + picture_heights[r] + kLine_px - 3.0;
      for (const std::string& text : panel.caption) {
        canvas.text(text, {low.x(), line}, 9.5, colors::kFaintInk);
        line += kLine_px;
      }
    }
    v += row_heights[r];
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LegendEntry& entry = board.legend[i];
    const Eigen::Vector2d at = places[i] + Eigen::Vector2d(0.0, v);
    canvas.line(at + Eigen::Vector2d(0.0, 12.0), at + Eigen::Vector2d(kKey_px, 12.0), entry.color, 3.0);
    canvas.text(entry.text, at + Eigen::Vector2d(kKey_px + kKeyGap_px, 16.0), kLegendText_pt);
  }
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
