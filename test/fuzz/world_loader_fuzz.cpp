// Any bytes as a world file: a world or a ConfigError, nothing else. The models of the tests' worlds can be
// named.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/config/config_error.h"
#include "simulator/core/world.h"
#include "simulator/core/world_material.h"
#include "support/build_paths.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::string folder = VISMEM_SOURCE_DIR "/test/data/worlds";
  try {
    // Asking about parts of what libsdformat refuses takes seconds here: of a few only, by their length.
    const int tries = size % 16 == 0 ? 20 : 0;
    const auto loaded = vismem::parseWorld(bytes, "fuzz.world", {folder + "/models", folder}, tries);
    if (loaded.world.bodyCount() == 0) std::abort();
    for (const auto& model : loaded.world.models) {
      if (!model.pose.matrix().allFinite()) std::abort();
      for (const auto& body : model.bodies) {
        for (const auto& v : body.vertices) {
          if (!v.allFinite()) std::abort();
        }
        for (const auto& t : body.triangles) {
          if (t.maxCoeff() >= body.vertices.size()) std::abort();
        }
      }
    }
  } catch (const vismem::ConfigError&) {
  }
  vismem::parseOgreScript(bytes);
  return 0;
}
