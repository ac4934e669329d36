/// @file The other process of the camera benchmark.
#pragma once

namespace vismem {

/// Serves "camera" (avm::Camera over a FrameBroadcaster), "plain" and "control" at an ephemeral port, prints
/// a ready line, and serves until a signal.
[[noreturn]] void runBenchServer();

}  // namespace vismem
