#include <malloc.h>

#include <opencv2/core/utility.hpp>

#include "camera_server/app/component.h"

int main(int argc, char** argv) {
  // Memory of images is kept. Returning it to the kernel and allocating it again thirty times a second (page
  // by page, cleared) would double the load of 1280x720 in RGB8.
  constexpr int kLargestKept = 32 << 20;
  constexpr int kKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestKept);
  mallopt(M_TRIM_THRESHOLD, kKept);
  // Each camera has its own thread: distributing the work on one image takes longer than the work.
  cv::setNumThreads(1);
  return vismem::runComponent(argc, argv, vismem::cameraServerSpec());
}
