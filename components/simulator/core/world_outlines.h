/// @file Outlines of a shape in plan view, as obstacles of a robot on the floor. Pure.
#pragma once

#include <vector>

#include "simulator/core/shapes.h"
#include "simulator/core/world.h"

namespace vismem {

/// Outlines of a shape in the plane z = 0 of its coordinates.
/// @param solid true: one outline, the hull of all, at any height (boxes, balls, ...). False (meshes,
/// polylines): rectangles that cover the part of the surface between the heights, so that a house has free
/// rooms. Shapes under 30 cm are solid.
std::vector<ModelOutline> outlinesOf(const TriangleMesh& mesh, bool solid, double low_m, double high_m);

}  // namespace vismem
