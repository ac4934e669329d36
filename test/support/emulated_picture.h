/// @file Pictures of one shade in the formats that a camera gives.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vismem {

/// @param fourcc of V4L2: MJPG, YUYV, UYVY, NV12, GREY, else three bytes a pixel.
/// @param bare  a JPEG without the tables of the standard, and with what is left from a longer picture before
/// it.
std::vector<std::uint8_t> paintPicture(const std::string& fourcc, int width, int height, std::uint8_t shade,
                                       bool bare);

}  // namespace vismem
