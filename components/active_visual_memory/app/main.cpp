#include "active_visual_memory/app/component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::activeVisualMemorySpec());
}
