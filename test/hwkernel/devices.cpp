// Devices for the kernel of the test machine (hwkernel_test), each until it is killed, which is an unplug:
//   hwkernel_devices maestro PORT STATE_FILE
//   hwkernel_devices camera|orbit PORT STATE_FILE JPEG
//   hwkernel_devices robot SERIAL_LINE
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>

#include "hwkernel/usb_model.h"
#include "hwkernel/uvc_model.h"
#include "support/maestro_model.h"
#include "support/p2os_robot.h"

namespace vismem {
namespace {

class UsbMaestro : public UsbModel {
 public:
  Answer control(const Setup& setup, std::span<const std::uint8_t>) override {
    // SET_CONFIGURATION and the like.
    if ((setup[0] & 0x60) == 0 && (setup[0] & 0x80) == 0) return {};
    auto transfer = model_.control(setup);
    return {transfer.status, std::move(transfer.data)};
  }
  bool isHighSpeed() const override { return false; }
  std::string state() override {
    return std::to_string(model_.target_qus(0)) + " " + std::to_string(model_.target_qus(1));
  }

 private:
  MaestroModel model_;
};

std::vector<std::uint8_t> readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int openRaw(const std::string& path) {
  const int line = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (line < 0) throw std::runtime_error(path + ": cannot be opened");
  termios raw{};
  tcgetattr(line, &raw);
  cfmakeraw(&raw);
  tcsetattr(line, TCSANOW, &raw);
  return line;
}

/// The robot lives on a pseudo terminal; here its bytes go over the other end of a USB serial line.
void serveRobot(const std::string& path) {
  const P2osRobot robot;
  const std::array<int, 2> lines{openRaw(path), openRaw(robot.path())};
  while (true) {
    std::array<pollfd, 2> waits{{{lines[0], POLLIN, 0}, {lines[1], POLLIN, 0}}};
    if (poll(waits.data(), waits.size(), -1) < 0) return;
    for (std::size_t i = 0; i < 2; ++i) {
      if ((waits[i].revents & (POLLHUP | POLLERR)) != 0) return;
      if ((waits[i].revents & POLLIN) == 0) continue;
      std::array<char, 512> bytes;
      const ssize_t got = ::read(lines[i], bytes.data(), bytes.size());
      if (got <= 0) return;
      if (::write(lines[1 - i], bytes.data(), static_cast<std::size_t>(got)) < 0) return;
    }
  }
}

int run(const std::vector<std::string>& arguments) {
  const std::string kind = arguments.empty() ? "" : arguments[0];
  if (kind == "maestro" && arguments.size() == 3) {
    UsbMaestro maestro;
    serveOnVhci(maestro, std::stoi(arguments[1]), arguments[2]);
  } else if ((kind == "camera" || kind == "orbit") && arguments.size() == 4) {
    UvcModel camera(kind == "orbit" ? UvcModel::Motors::kOrbit : UvcModel::Motors::kAbsolute,
                    readFile(arguments[3]));
    serveOnVhci(camera, std::stoi(arguments[1]), arguments[2]);
  } else if (kind == "robot" && arguments.size() == 2) {
    serveRobot(arguments[1]);
  } else {
    std::cerr << "hwkernel_devices: maestro PORT STATE, camera|orbit PORT STATE JPEG, or robot LINE\n";
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace vismem

int main(int argc, char** argv) {
  try {
    return vismem::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "hwkernel_devices: " << error.what() << std::endl;
    return 1;
  }
}
