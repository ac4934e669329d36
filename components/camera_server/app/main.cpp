#include <malloc.h>

#include <opencv2/core/utility.hpp>

#include "camera_server/app/component.h"

int main(int argc, char** argv) {
  // Memory for pictures is kept, not given back to the kernel and taken anew (page by page, and cleared)
  // thirty times a second: it halves what 1280x720 in RGB8 costs.
  constexpr int kLargestKept = 32 << 20;
  constexpr int kKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestKept);
  mallopt(M_TRIM_THRESHOLD, kKept);
  // Each camera has its thread: to wake others for a part of a picture takes longer than the part.
  cv::setNumThreads(1);
  return vismem::runComponent(argc, argv, vismem::cameraServerSpec());
}
