#include "recorder/app/recorder_component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::recorderSpec());
}
