/// @file Ground truth of an image as frames of three bytes per pixel, with the transport of images. Pure.
#pragma once

#include "common/robot/samples.h"
#include "simulator/core/renderer.h"

namespace vismem {

/// Depth along the optical axis [mm], 256 R + G, at most 65534; 0 without a surface, 65535 for farther ones;
/// B is 0.
Frame depthFrame(const TruthImages& truth, const Frame& image);
/// Model: 256 R + G is its index + 1 in SimulationControl::models(), B the index of its body + 1 (255 for the
/// 255th and later ones); all 0 without a surface.
Frame objectFrame(const TruthImages& truth, const Frame& image);

}  // namespace vismem
