// camera_server with the driver "template" beside the built-in ones. vismem::pantilt_server_component and
// vismem::base_server_component take drivers of the other two ports in the same way.
#include <camera_server/app/component.h>

#include "template_camera.h"

int main(int argc, char** argv) {
  return vismem::runComponent(
      argc, argv, vismem::cameraServerSpec([](vismem::DriverRegistry<vismem::FrameSource>& drivers) {
        drivers.add("template", "an image of one brightness; simulated", makeTemplateCamera);
      }));
}
