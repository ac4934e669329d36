#include <algorithm>
#include <string_view>

#include "simulator/app/component.h"
#include "simulator/app/render_view.h"

int main(int argc, char** argv) {
  const bool render = std::any_of(argv + 1, argv + argc, [](const char* argument) {
    const std::string_view text(argument);
    return text == "--render" || text.starts_with("--render=");
  });
  if (render) return vismem::runRenderCommand(argc, argv);
  return vismem::runComponent(argc, argv, vismem::simulatorSpec());
}
