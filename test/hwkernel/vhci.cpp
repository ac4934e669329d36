// The USB/IP protocol as the kernel's vhci speaks it (drivers/usb/usbip): headers of 48 bytes, big-endian.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "hwkernel/usb_model.h"

namespace vismem {
namespace {

constexpr std::uint32_t kSubmit = 1;
constexpr std::uint32_t kUnlink = 2;
constexpr std::uint32_t kSubmitAnswer = 3;
constexpr std::uint32_t kUnlinkAnswer = 4;
constexpr std::size_t kHeaderWords = 12;
constexpr char kAttach[] = "/sys/devices/platform/vhci_hcd.0/attach";

using Header = std::array<std::uint32_t, kHeaderWords>;

/// A transfer from the device that waits for its data.
struct Waiting {
  std::uint32_t number = 0;
  std::size_t length = 0;
};

class Session {
 public:
  Session(UsbModel& model, int socket, std::string state_file)
      : model_(model), socket_(socket), state_file_(std::move(state_file)) {}

  void run() {
    while (true) {
      pollfd wait{socket_, POLLIN, 0};
      const int ready = poll(&wait, 1, waiting_.empty() ? 200 : 2);
      if (ready < 0 && errno != EINTR) return;
      if (ready > 0 && !handle()) return;
      while (!waiting_.empty()) {
        const auto data = model_.bulkIn(waiting_.front().length);
        if (!data) break;
        answer(waiting_.front().number, 0, *data, data->size());
        waiting_.pop_front();
      }
      writeState();
    }
  }

 private:
  bool readAll(void* to, std::size_t size) const {
    auto* at = static_cast<char*>(to);
    while (size > 0) {
      const ssize_t got = ::read(socket_, at, size);
      if (got <= 0) return false;
      at += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }
  void send(const std::vector<std::uint8_t>& bytes) const {
    std::size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t put = ::send(socket_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (put <= 0) return;
      at += static_cast<std::size_t>(put);
    }
  }
  static void put(std::vector<std::uint8_t>& bytes, const Header& header) {
    bytes.resize(4 * kHeaderWords);
    for (std::size_t i = 0; i < kHeaderWords; ++i) {
      const std::uint32_t word = htonl(header[i]);
      std::memcpy(bytes.data() + 4 * i, &word, 4);
    }
  }
  void answer(std::uint32_t number, int status, std::span<const std::uint8_t> data,
              std::size_t length) const {
    Header header{kSubmitAnswer,
                  number,
                  0,
                  0,
                  0,
                  static_cast<std::uint32_t>(status),
                  static_cast<std::uint32_t>(length)};
    std::vector<std::uint8_t> bytes;
    put(bytes, header);
    bytes.insert(bytes.end(), data.begin(), data.end());
    send(bytes);
  }

  /// @return false when the kernel let go.
  bool handle() {
    Header header{};
    if (!readAll(header.data(), 4 * 10)) return false;
    for (std::size_t i = 0; i < 10; ++i) header[i] = ntohl(header[i]);
    UsbModel::Setup setup{};
    if (!readAll(setup.data(), setup.size())) return false;
    if (header[0] == kUnlink) {
      const std::uint32_t wanted = header[5];
      bool found = false;
      for (auto at = waiting_.begin(); at != waiting_.end(); ++at) {
        if (at->number != wanted) continue;
        waiting_.erase(at);
        found = true;
        break;
      }
      std::vector<std::uint8_t> bytes;
      put(bytes, {kUnlinkAnswer, header[1], 0, 0, 0, found ? static_cast<std::uint32_t>(-ECONNRESET) : 0U});
      send(bytes);
      return true;
    }
    if (header[0] != kSubmit) return false;
    const bool to_host = header[3] == 1;
    const std::size_t length = header[6];
    std::vector<std::uint8_t> data;
    if (!to_host) {
      data.resize(length);
      if (!readAll(data.data(), length)) return false;
    }
    if (header[4] != 0) {
      waiting_.push_back({header[1], length});
      return true;
    }
    const UsbModel::Answer result = model_.control(setup, data);
    const std::size_t size = to_host ? std::min(result.data.size(), length) : length;
    const std::span<const std::uint8_t> bytes(result.data.data(), to_host ? size : 0);
    answer(header[1], result.status, bytes, result.status == 0 ? size : 0);
    return true;
  }

  void writeState() {
    const std::string state = model_.state();
    if (state == last_state_) return;
    last_state_ = state;
    // Atomic for readers.
    std::ofstream(state_file_ + ".new") << state << "\n";
    std::filesystem::rename(state_file_ + ".new", state_file_);
  }

  UsbModel& model_;
  const int socket_;
  const std::string state_file_;
  std::string last_state_ = "none";
  std::deque<Waiting> waiting_;
};

}  // namespace

void serveOnVhci(UsbModel& model, int port, const std::string& state_file) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) throw std::runtime_error("no socket");
  std::thread server([&] { Session(model, ends[0], state_file).run(); });
  {
    std::ofstream attach(kAttach);
    // The kernel's numbers of speeds: 2 full, 3 high.
    attach << port << " " << ends[1] << " " << (port + 2) << " " << (model.isHighSpeed() ? 3 : 2)
           << std::flush;
    if (!attach) {
      ::shutdown(ends[0], SHUT_RDWR);
      server.join();
      throw std::runtime_error(std::string(kAttach) + ": not taken (is vhci-hcd loaded?)");
    }
  }
  // The kernel holds its own reference.
  ::close(ends[1]);
  server.join();
}

}  // namespace vismem
