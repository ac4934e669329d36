#include "support/mjpeg_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace vismem {
namespace {

bool send(int client, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = ::send(client, at, size, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    at += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool send(int client, const std::string& text) {
  return send(client, text.data(), text.size());
}

}  // namespace

MjpegServer::MjpegServer(Manner manner, int port, double period_s) : manner_(manner), period_s_(period_s) {
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(60, 120, 200)), jpeg_);
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 || listen(listener_, 8) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("no port for the test's camera");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

MjpegServer::~MjpegServer() {
  ending_ = true;
  thread_.join();
  close(listener_);
}

bool MjpegServer::pause(double seconds) const {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ending_ && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return !ending_;
}

void MjpegServer::serve() {
  while (!ending_) {
    pollfd waiting{listener_, POLLIN, 0};
    if (poll(&waiting, 1, 10) <= 0) continue;
    const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    ++connections_;
    serveClient(client);
    close(client);
  }
}

void MjpegServer::serveClient(int client) {
  char request[2048];
  // The request is ignored, but it must be read: otherwise closing would reset the connection.
  pollfd asked{client, POLLIN, 0};
  while (!ending_ && poll(&asked, 1, 10) == 0) continue;
  if (ending_ || recv(client, request, sizeof request, 0) <= 0) return;
  if (manner_ == Manner::kGarbage) {
    send(client, "HTTP/1.0 200 OK\r\nContent-Type: text/html\r\n\r\n<html>not here</html>\n");
    return;
  }
  bool greeted = false;
  for (int i = 0; !ending_; ++i) {
    // A closed end shows that the client is gone.
    pollfd gone{client, POLLIN, 0};
    if (poll(&gone, 1, 0) > 0 && recv(client, request, sizeof request, MSG_DONTWAIT) == 0) return;
    if (manner_ == Manner::kSilent || (manner_ == Manner::kStalls && i >= 30)) {
      if (!pause(0.005)) return;
      continue;
    }
    if (manner_ == Manner::kHangsUp && i == 15) return;
    if (!greeted &&
        !send(client, "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n")) {
      return;
    }
    greeted = true;
    const std::string head =
        "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg_.size()) + "\r\n\r\n";
    if (!send(client, head) || !send(client, jpeg_.data(), jpeg_.size()) || !send(client, "\r\n")) return;
    if (!pause(period_s_)) return;
  }
}

}  // namespace vismem
