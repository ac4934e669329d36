#include "gui/server/component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::guiServerSpec());
}
