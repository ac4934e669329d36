/// @file The other process of the camera benchmark.
#pragma once

namespace vismem {

/// Serves "camera" (avm::Camera over a FrameBroadcaster), "plain" and "control" at a port of the system's
/// choice, says so with a ready line, and serves until a signal ends it.
[[noreturn]] void runBenchServer();

}  // namespace vismem
