// Broken connections: half a request, a host that disappears.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <list>

#include "common/robot_ice/camera_ice.h"
#include "robot_ice/loopback.h"
#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

int connectTo(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  close(fd);
  return -1;
}

/// @return whether the other side closes the connection within the time.
bool isClosedWithin(int fd, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    pollfd waited{fd, POLLIN, 0};
    if (poll(&waited, 1, 50) <= 0) continue;
    char buffer[256];
    if (recv(fd, buffer, sizeof buffer, 0) <= 0) return true;
  }
  return false;
}

TEST(HalfARequest, ClosesItsConnectionOnly) {
  ComponentProcess probe("probe_component", {"--Ice.Default.Timeout=500"});
  ASSERT_GT(probe.port(), 0);
  const int fd = connectTo(probe.port());
  ASSERT_GE(fd, 0);
  // A request of 1000 bytes by its header: magic, protocol 1.0, encoding 1.0, request, not compressed, size.
  const unsigned char half[] = {'I', 'c', 'e', 'P', 1, 0, 1, 0, 0, 0, 0xe8, 0x03, 0, 0, 1, 2, 3, 4};
  ASSERT_EQ(send(fd, half, sizeof half, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof half));
  ComponentProcess other("probe_component", {"--Probe.Peer.Proxy=" + probe.statusProxy()});
  EXPECT_TRUE(other.waitForLine("Peer is connected", kPatience)) << "others are served meanwhile";
  EXPECT_TRUE(isClosedWithin(fd, 10s));
  close(fd);
  EXPECT_TRUE(probe.running());
}

/// Passes bytes between clients and a server. On request the present connections stay open without any
/// traffic, as when a host loses its network. Later connections work.
class Relay {
 public:
  explicit Relay(int server_port) : server_port_(server_port) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listener_, 16), 0);
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~Relay() {
    thread_.request_stop();
    thread_.join();
    for (const auto& pair : pairs_) {
      close(pair.client);
      close(pair.server);
    }
    close(listener_);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  int port() const { return port_; }
  int connections() const { return connections_; }
  void swallowPresentOnes() { swallow_ = true; }

 private:
  struct Pair {
    int client = -1;
    int server = -1;
    bool dead = false;
  };

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (swallow_.exchange(false)) {
        for (auto& pair : pairs_) pair.dead = true;
      }
      std::vector<pollfd> waited{{listener_, POLLIN, 0}};
      std::vector<Pair*> owners{nullptr};
      for (auto& pair : pairs_) {
        if (pair.dead) continue;
        waited.push_back({pair.client, POLLIN, 0});
        waited.push_back({pair.server, POLLIN, 0});
        owners.insert(owners.end(), {&pair, &pair});
      }
      if (poll(waited.data(), waited.size(), 20) <= 0) continue;
      if (waited[0].revents != 0) {
        pairs_.push_back({accept(listener_, nullptr, nullptr), connectTo(server_port_), false});
        ++connections_;
      }
      for (std::size_t i = 1; i < waited.size(); ++i) {
        if (waited[i].revents != 0 && !swallow_) pass(*owners[i], waited[i].fd);
      }
    }
  }

  static void pass(Pair& pair, int from) {
    std::array<char, 65536> buffer;
    const ssize_t count = recv(from, buffer.data(), buffer.size(), 0);
    const int to = from == pair.client ? pair.server : pair.client;
    if (count <= 0) {
      pair.dead = true;
      shutdown(to, SHUT_RDWR);
      return;
    }
    for (ssize_t sent = 0; sent < count;) {
      const ssize_t now =
          send(to, buffer.data() + sent, static_cast<std::size_t>(count - sent), MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += now;
    }
  }

  const int server_port_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<int> connections_ = 0;
  std::atomic<bool> swallow_ = false;
  std::list<Pair> pairs_;
  std::jthread thread_;
};

TEST(AHostThatGoesWithoutAWord, IsFoundAgainOverANewConnection) {
  FrameBroadcaster frames;
  LoopbackServer server;
  server.add("cameraA", std::make_shared<CameraServant>(frames, "cameraA"));
  server.activate();
  Relay relay(server.port());
  LoopbackClient client;
  std::string failure;
  const auto proxy = client.proxy<avm::CameraPrx>("cameraA", relay.port())->ice_invocationTimeout(400);
  RemoteFrameSource camera(Ice::uncheckedCast<avm::CameraPrx>(proxy), FrameFormat::kRgb8,
                           [&](const std::string& why) { failure = why; });
  Frame frame;
  frame.image = cv::Mat(12, 16, CV_8UC3, cv::Scalar(1, 2, 3));
  const auto sees = [&] {
    return eventually([&] {
      ++frame.seq;
      frames.publish(frame);
      return camera.next(100ms).frame.has_value();
    });
  };
  ASSERT_TRUE(sees());
  const int before = relay.connections();
  relay.swallowPresentOnes();
  ASSERT_TRUE(eventually([&] {
    camera.next(100ms);
    return !failure.empty();
  }));
  EXPECT_THAT(failure, testing::HasSubstr("no answer within 400 ms"));
  EXPECT_TRUE(sees()) << failure;
  EXPECT_EQ(failure, "");
  EXPECT_GT(relay.connections(), before);
  frames.stop();
}

}  // namespace
}  // namespace vismem
