/// @file Ground truth of an image as frames of three bytes a pixel, so that it travels like an image. Pure.
#pragma once

#include "common/robot/samples.h"
#include "simulator/core/renderer.h"

namespace vismem {

/// Millimetres along the optical axis, 256 R + G, at most 65534; 0 where nothing is, 65535 for farther; B is 0.
Frame depthFrame(const TruthImages& truth, const Frame& image);
/// Model: 256 R + G is its index + 1 in SimulationControl::models(), B the index of its body + 1 (255 for the 255th
/// and later ones); all 0 where nothing is.
Frame objectFrame(const TruthImages& truth, const Frame& image);

}  // namespace vismem
