#include "simulator/app/render_view.h"

int main(int argc, char** argv) {
  return vismem::runRenderCommand(argc, argv);
}
