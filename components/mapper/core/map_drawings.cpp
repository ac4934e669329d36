// Maps as drawings of other programs: SVG and DXF.
#include <array>
#include <cmath>
#include <cstdio>

#include "common/config/text_format.h"
#include "mapper/core/map_output.h"

namespace vismem {
namespace {

constexpr double kMargin_mm = 500.0;
constexpr double kPen_mm = 10.0;

/// A colour by label, the same in every drawing.
std::string colourOf(const Label& label) {
  constexpr std::array<const char*, 8> kColours{"#1f5fd0", "#c0392b", "#1e8449", "#8e44ad",
                                                "#d68910", "#117a8b", "#7b241c", "#34495e"};
  unsigned hash = 2166136261U;
  for (const char c : label) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return kColours[hash % kColours.size()];
}

}  // namespace

std::string svgOf(const SegmentMap& map) {
  const auto millimetres = [](double metres) { return std::round(metres * 1e3); };
  const Eigen::Vector2d low = map.low() * 1e3;
  const Eigen::Vector2d high = map.high() * 1e3;
  const double left = std::floor(low.x()) - kMargin_mm;
  const double top = std::ceil(high.y()) + kMargin_mm;
  const double width = std::ceil(high.x()) + kMargin_mm - left;
  const double height = top - std::floor(low.y()) + kMargin_mm;
  std::string svg = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0fmm\" height=\"%.0fmm\" viewBox=\"0 0 %.0f "
      "%.0f\" "
      "data-origin=\"%.0f %.0f\">\n",
      width, height, width, height, -left, top);
  for (const MapSegment& segment : map.segments) {
    if (segment.world.a.z() != 0.0 || segment.world.b.z() != 0.0) continue;
    const double pen = segment.width_m > 0.0 ? millimetres(segment.width_m) : kPen_mm;
    svg += formatted("<line data-label=\"%s\" x1=\"%.0f\" y1=\"%.0f\" x2=\"%.0f\" y2=\"%.0f\" ",
                     segment.label.c_str(), millimetres(segment.world.a.x()) - left,
                     top - millimetres(segment.world.a.y()), millimetres(segment.world.b.x()) - left,
                     top - millimetres(segment.world.b.y()));
    svg += formatted("stroke=\"%s\" stroke-width=\"%.0f\"/>\n", colourOf(segment.label).c_str(), pen);
  }
  return svg + "</svg>\n";
}

std::string dxfOf(const SegmentMap& map) {
  std::string dxf = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  for (const MapSegment& segment : map.segments) {
    dxf += formatted("0\nLINE\n8\n%s\n", segment.label.c_str());
    if (segment.width_m > 0.0) dxf += formatted("39\n%.3f\n", segment.width_m);
    const Eigen::Vector3d& a = segment.world.a;
    const Eigen::Vector3d& b = segment.world.b;
    dxf += formatted("10\n%.3f\n20\n%.3f\n30\n%.3f\n", a.x(), a.y(), a.z());
    dxf += formatted("11\n%.3f\n21\n%.3f\n31\n%.3f\n", b.x(), b.y(), b.z());
  }
  return dxf + "0\nENDSEC\n0\nEOF\n";
}

}  // namespace vismem
