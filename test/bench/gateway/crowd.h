/// @file Many simulated viewers behind the viewers' router.
#pragma once

#include <Ice/Ice.h>
#include <avm/camera.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "remote_access/gateway.h"

namespace vismem {

/// What all viewers got since the last look.
struct CrowdCount {
  std::int64_t images = 0;
  std::int64_t bytes = 0;
  std::int64_t least_images = 0;  ///< of one viewer
};

/// Each viewer has a connection and a session of its own, and asks for the next JPEG as soon as it has one,
/// as the page does. All of them live in this process; their calls are asynchronous.
class Crowd {
 public:
  /// Logs in all viewers and begins to ask.
  /// @param endpoint of the robot's camera: "tcp -h 127.0.0.1 -p 41233".
  Crowd(const test::Gateway& gateway, const std::string& endpoint, int viewers);
  /// Ends all sessions.
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  CrowdCount take();
  /// The first thing that went wrong; empty.
  std::string failure() const;

 private:
  class Viewer;

  Ice::CommunicatorHolder communicator_;
  std::vector<std::shared_ptr<Viewer>> viewers_;
};

}  // namespace vismem
