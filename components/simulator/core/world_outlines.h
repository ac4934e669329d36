/// @file What a shape is to a robot on the floor: outlines in plan view. Pure.
#pragma once

#include <vector>

#include "simulator/core/shapes.h"
#include "simulator/core/world.h"

namespace vismem {

/// Outlines of a shape in the plane z = 0 of its coordinates.
/// @param solid true: one outline, the hull of all, at any height (boxes, balls, ...). False (meshes,
/// polylines): rectangles that cover what of the surface lies between the heights, so that a house is not one
/// block. Shapes under 30 cm are solid.
std::vector<ModelOutline> outlinesOf(const TriangleMesh& mesh, bool solid, double low_m, double high_m);

}  // namespace vismem
