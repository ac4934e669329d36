/// @file Pictures on disk for tests of cameras.
#pragma once

#include <string>

namespace vismem {

/// An image whose brightness is its number (red = number), in the format of the name's ending.
void writePicture(const std::string& file, int number, int width = 64, int height = 48);
/// An AVI of motion JPEG.
void writeVideo(const std::string& file, int pictures, double rate_hz, int width = 64, int height = 48);

}  // namespace vismem
