#include "mapper/app/component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::mapperSpec());
}
