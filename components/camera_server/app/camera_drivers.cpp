#include "camera_server/app/camera_drivers.h"

#include "drivers/camera_files/file_camera.h"
#include "drivers/camera_v4l2/v4l2_camera.h"
#include "drivers/example_camera/pattern_camera.h"

namespace vismem {

void registerCameraDrivers(DriverRegistry<FrameSource>& registry) {
  registry.add("files", "a folder of images, an image, a video file or a network stream", makeFileCamera);
  registry.add("pattern", "a test pattern; simulated", makePatternCamera);
  registry.add("v4l2", "a camera of the Linux kernel, such as those by USB", makeV4l2Camera);
}

}  // namespace vismem
