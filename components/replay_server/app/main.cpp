#include "replay_server/app/replay_component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::replayServerSpec());
}
