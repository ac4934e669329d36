/// @file PDF files of black rectangles and texts in true size (PDF 1.4, ISO 32000-1). Pure.
#pragma once

#include <string>
#include <vector>

#include "calibration/core/target/board_drawing.h"

namespace vismem {

/// The bytes of a PDF file. It asks viewers not to scale when they print. Texts are ASCII, in Helvetica.
std::string writePdf(const std::vector<PrintedPage>& pages, const std::string& title);

}  // namespace vismem
