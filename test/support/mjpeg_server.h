/// @file A network camera of a test: motion JPEG over HTTP, at an ephemeral port.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace vismem {

/// Serves one client after the other. *Thread-safe*.
class MjpegServer {
 public:
  enum class Manner {
    kSteady,   ///< a picture each period
    kSilent,   ///< accepts connections and sends nothing
    kStalls,   ///< some pictures, then nothing more
    kHangsUp,  ///< some pictures, then closes the connection
    kGarbage,  ///< an answer that is no stream
  };

  explicit MjpegServer(Manner manner, int port = 0, double period_s = 0.02);
  /// Ends at once, as an unplugged camera.
  ~MjpegServer();
  MjpegServer(const MjpegServer&) = delete;
  MjpegServer& operator=(const MjpegServer&) = delete;

  int port() const { return port_; }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/stream.mjpg"; }
  void setManner(Manner manner) { manner_ = manner; }
  int connections() const { return connections_; }

 private:
  void serve();
  void serveClient(int client);
  bool pause(double seconds) const;

  std::atomic<Manner> manner_;
  const double period_s_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> ending_ = false;
  std::atomic<int> connections_ = 0;
  std::vector<unsigned char> jpeg_;
  std::thread thread_;
};

}  // namespace vismem
