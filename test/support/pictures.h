/// @file Pictures on disk for tests of cameras.
#pragma once

#include <string>

namespace vismem {

/// A picture that tells its number by its brightness (red = number), written as the name's ending says.
void writePicture(const std::string& file, int number, int width = 64, int height = 48);
/// An AVI of motion JPEG.
void writeVideo(const std::string& file, int pictures, double rate_hz, int width = 64, int height = 48);

}  // namespace vismem
