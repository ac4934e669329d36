/// @file A page on which a person names colours by clicks, for learn_palette. Pure. See V3, B5.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace vismem {

struct ClickableImage {
  std::string name;  ///< by which a file of clicks finds it
  cv::Mat image;     ///< CV_8UC3 (R, G, B)
};

/// A document in one file, for a browser without a server: the images, a field for the name of a class, and a
/// button that saves the clicks as learn_palette reads them.
/// @param classes that the palette has, offered as names.
/// @param clicks  the lines of a file of clicks, to go on with.
std::string clicksPage(const std::vector<ClickableImage>& images, const std::vector<std::string>& classes,
                       const std::vector<std::string>& clicks);

}  // namespace vismem
