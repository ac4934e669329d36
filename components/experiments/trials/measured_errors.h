/// @file Quantiles of the distances between the ends of floor lines in rendered images and in the map. Pure.
/// See E5, E6, E7, E8.
#pragma once

#include <array>

#include "experiments/trials/error_quantiles.h"
#include "experiments/trials/vision_statistics.h"

namespace vismem {

/// Measured with VisionStatistics by `experiment E6 --variant vision --seed 7 --trials 5` in
/// `corridor_irregular` (6005 images), at ErrorQuantiles::kShares [px].
using ErrorsByRange = std::array<ErrorQuantiles, VisionStatistics::kRanges_m.size()>;

inline constexpr ErrorsByRange kMeasuredAcrossFloor{
    {{{-0.471, -0.447, -0.337, -0.203, -0.121, -0.014, 0.028, 0.150, 0.201, 0.288, 0.336}},
     {{-0.416, -0.319, -0.162, -0.130, -0.059, -0.011, 0.032, 0.128, 0.175, 0.250, 0.328}},
     {{-0.188, -0.137, -0.091, -0.070, -0.041, -0.014, 0.012, 0.073, 0.111, 0.173, 0.217}},
     {{-0.155, -0.078, -0.048, -0.036, -0.019, -0.003, 0.021, 0.065, 0.099, 0.152, 0.195}},
     {{-0.209, -0.119, -0.045, -0.029, -0.011, 0.001, 0.013, 0.033, 0.059, 0.111, 0.156}},
     {{-2.435, -2.127, -0.143, -0.076, -0.020, -0.001, 0.014, 0.041, 0.082, 0.531, 0.635}}}};

inline constexpr ErrorsByRange kMeasuredAlongFloor{
    {{{-3.64, -3.24, -2.82, -2.44, -1.22, -0.41, 0.09, 0.28, 0.38, 2.25, 6.09}},
     {{-3.47, -2.67, -1.85, -1.34, -0.66, -0.07, 0.20, 0.40, 0.53, 3.37, 8.08}},
     {{-1.92, -1.46, -1.08, -0.87, -0.51, -0.12, 0.13, 0.30, 0.45, 1.27, 7.26}},
     {{-3.06, -1.44, -0.82, -0.68, -0.43, -0.08, 0.16, 0.54, 1.12, 16.11, 26.60}},
     {{-3.68, -2.85, -1.54, -0.80, -0.40, -0.12, 0.26, 1.92, 5.24, 22.17, 26.44}},
     {{-3.72, -2.74, -1.58, -1.07, -0.30, -0.05, 0.99, 2.68, 4.84, 8.25, 10.10}}}};

inline constexpr ErrorQuantiles kMeasuredHidden{
    {-3.85, -2.20, -1.84, -1.66, -1.23, -0.88, -0.54, -0.30, -0.22, -0.05, 0.51}};

/// Of outlines of walls: the foot and the upper end. --trials 3 (3603 images).
inline constexpr ErrorQuantiles kMeasuredOutlineFoot{
    {-1.32, -1.21, -0.94, -0.81, -0.58, -0.34, -0.07, 0.17, 0.25, 0.40, 0.46}};
inline constexpr ErrorQuantiles kMeasuredOutlineTop{
    {-5.47, -1.71, -1.42, -1.34, -1.09, -0.75, -0.34, -0.08, 0.06, 0.46, 0.50}};

/// Of both, beside it (--seed 8 --trials 2).
inline constexpr ErrorQuantiles kMeasuredOutlineAcross{
    {-1.12, -0.29, -0.07, -0.04, -0.01, -0.00, 0.01, 0.04, 0.07, 0.16, 0.46}};

}  // namespace vismem
