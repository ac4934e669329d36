#include "support/emulated_maestro.h"

#include <sys/ioctl.h>
// After sys/ioctl.h, which it needs and does not name.
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <functional>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "support/emulated_node.h"

namespace vismem {
namespace {

/// The device and configuration descriptors.
std::string descriptorsOf(std::uint16_t product) {
  std::ostringstream hex;
  hex << std::hex << std::setfill('0');
  // Device: USB 2.0, vendor-specific, 64 bytes, vendor, product, release 1.00, strings 1, 2, 3, one
  // configuration; configuration: 9 + 9 bytes, one interface of vendor class without endpoints.
  const std::string low_high{static_cast<char>(product & 0xFFU), static_cast<char>(product >> 8U)};
  using namespace std::string_literals;
  const std::string bytes = "\x12\x01\x00\x02\xff\x00\x00\x40\xfb\x1f"s + low_high +
                            "\x00\x01\x01\x02\x03\x01"s +
                            "\x09\x02\x12\x00\x01\x01\x00\xc0\x32\x09\x04\x00\x00\x00\xff\x00\x00\x00"s;
  for (const char c : bytes) hex << std::setw(2) << (static_cast<unsigned>(c) & 0xFFU);
  return hex.str();
}

EmulatedNode::Description describe(std::uint16_t product, int number) {
  std::ostringstream id;
  id << std::hex << std::setfill('0') << std::setw(4) << product;
  const std::string port = std::to_string(number);
  const std::string address = "00" + std::to_string(number + 1);
  const std::string device = "/devices/usb1/1-" + port;
  const std::string node = "bus/usb/001/" + address;
  return {
      "/sys" + device, "/dev/" + node,
      "P: " + device + "\nN: " + node +
          "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=" + address +
          "\nE: MAJOR=189\nE: MINOR=" + port + "\nE: DEVNAME=/dev/" + node +
          "\nA: busnum=1\\n\nA: devnum=" + std::to_string(number + 1) +
          "\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\nA: idVendor=1ffb\\n\nA: idProduct=" + id.str() +
          "\\n\nA: dev=189:" + port + "\\n\nH: descriptors=" + descriptorsOf(product) + "\n\n"};
}

}  // namespace

/// The node as usbfs has it: what a transfer's ioctls do.
struct EmulatedMaestro::Node {
  Node(EmulatedMaestro& maestro, std::uint16_t product, int number)
      : node(describe(product, number), [this, &maestro](unsigned code, const auto& argument) {
          return handle(maestro, code, argument);
        }) {}

  IoctlAnswer handle(EmulatedMaestro& maestro, unsigned code,
                     const std::function<IoctlMemory(std::size_t)>& argument);

  std::deque<std::uint64_t> done;         ///< transfers that are to be reaped
  std::optional<IoctlMemory> unanswered;  ///< a transfer that waits until it is given up
  EmulatedNode node;                      ///< last: ends before what it uses
};

IoctlAnswer EmulatedMaestro::Node::handle(EmulatedMaestro& maestro, unsigned code,
                                          const std::function<IoctlMemory(std::size_t)>& argument) {
  switch (code) {
    case USBDEVFS_GET_CAPABILITIES: {
      const IoctlMemory capabilities = argument(sizeof(std::uint32_t));
      capabilities.as<std::uint32_t>() = 0;
      capabilities.commit();
      return {};
    }
    case USBDEVFS_SUBMITURB: {
      const IoctlMemory transfer = argument(sizeof(usbdevfs_urb));
      auto& urb = transfer.as<usbdevfs_urb>();
      if (maestro.silent()) {
        unanswered.emplace(transfer);
        return {};
      }
      const IoctlMemory buffer =
          transfer.at(offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(urb.buffer_length));
      std::array<std::uint8_t, 8> setup{};
      std::memcpy(setup.data(), buffer.bytes(), setup.size());
      const Transfer answer = maestro.control(setup);
      urb.status = answer.status;
      urb.actual_length = static_cast<int>(answer.data.size());
      std::copy(answer.data.begin(), answer.data.end(), buffer.bytes() + setup.size());
      buffer.commit();
      transfer.commit();
      done.push_back(transfer.address());
      return {};
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: {
      if (done.empty()) return IoctlAnswer::failed(EAGAIN);
      const IoctlMemory pointer = argument(sizeof(void*));
      pointer.as<std::uint64_t>() = done.front();
      pointer.commit();
      done.pop_front();
      return {};
    }
    case USBDEVFS_DISCARDURB: {
      if (!unanswered) return IoctlAnswer::failed(EINVAL);
      unanswered->as<usbdevfs_urb>().status = -ENOENT;
      unanswered->commit();
      done.push_back(unanswered->address());
      unanswered.reset();
      return {};
    }
    default:
      return {};
  }
}

EmulatedMaestro::EmulatedMaestro(std::uint16_t product, const std::string& serial, int number)
    : product_(product),
      serial_(serial),
      servos_(product == 0x0089 ? 6U : 12U),
      node_(std::make_unique<Node>(*this, product, number)) {
  plugIn();
}

EmulatedMaestro::~EmulatedMaestro() {
  unplug();
}

void EmulatedMaestro::plugIn() {
  node_->node.plugIn();
}

void EmulatedMaestro::unplug() {
  node_->node.unplug();
}

bool EmulatedMaestro::silent() {
  const std::lock_guard lock(mutex_);
  return silent_;
}

void EmulatedMaestro::moveLocked() {
  const auto now = Clock::now();
  const double dt_s = std::chrono::duration<double>(now - moved_until_).count();
  moved_until_ = now;
  for (Servo& servo : servos_) {
    const double way = servo.target - servo.position;
    // A quarter of a microsecond each 10 ms for one unit of speed.
    const double step = servo.speed == 0 || servo.position == 0.0 || servo.target == 0
                            ? std::abs(way)
                            : 100.0 * servo.speed * dt_s;
    servo.position += std::copysign(std::min(std::abs(way), step), way);
  }
}

EmulatedMaestro::Transfer EmulatedMaestro::control(const std::array<std::uint8_t, 8>& setup) {
  const std::lock_guard lock(mutex_);
  moveLocked();
  const int type = setup[0];
  const int request = setup[1];
  const int value = setup[2] + 256 * setup[3];
  const int index = setup[4] + 256 * setup[5];
  const auto length = static_cast<std::size_t>(setup[6] + 256 * setup[7]);
  Transfer transfer;
  auto& data = transfer.data;
  const auto word = [&](int number) {
    data.push_back(static_cast<std::uint8_t>(number & 0xFF));
    data.push_back(static_cast<std::uint8_t>((number >> 8) & 0xFF));
  };
  const bool channel = index >= 0 && index < static_cast<int>(servos_.size());
  transfer.status = 0;
  if (request == refused_ && refused_ != 0) {
    transfer.status = -EPIPE;
  } else if (type == 0x80 && request == 6) {  // a string: languages, or the serial number
    const std::string text = (value & 0xFF) == 0 ? "" : serial_;
    data = {static_cast<std::uint8_t>(text.empty() ? 4 : 2 + 2 * text.size()), 3};
    if (text.empty()) word(0x0409);
    for (const char c : text) word(c);
  } else if (type == 0x40 && request == 0x85 && channel) {
    servos_[static_cast<std::size_t>(index)].target = value;
  } else if (type == 0x40 && request == 0x84 && channel) {
    servos_[static_cast<std::size_t>(index)].speed = value;
  } else if (type == 0x40 && request == 0x86) {
    errors_ = 0;
  } else if (type == 0xC0 && request == (micro() ? 0x83 : 0x87)) {
    if (micro()) {
      data.assign(98, 0);
      data[2] = static_cast<std::uint8_t>(errors_ & 0xFFU);
      data[3] = static_cast<std::uint8_t>(errors_ >> 8U);
    }
    for (const Servo& servo : servos_) {
      word(static_cast<int>(std::lround(servo.position)));
      word(servo.target);
      word(servo.speed);
      data.push_back(0);
    }
    if (short_) data.resize(data.size() / 2);
  } else {
    transfer.status = -EPIPE;
  }
  data.resize(std::min(data.size(), length));
  return transfer;
}

void EmulatedMaestro::refuse(int request) {
  const std::lock_guard lock(mutex_);
  refused_ = request;
}
void EmulatedMaestro::setSilent(bool silent) {
  const std::lock_guard lock(mutex_);
  silent_ = silent;
}
void EmulatedMaestro::setErrors(unsigned bits) {
  const std::lock_guard lock(mutex_);
  errors_ = bits;
}
void EmulatedMaestro::setShortAnswers(bool shorter) {
  const std::lock_guard lock(mutex_);
  short_ = shorter;
}
void EmulatedMaestro::switchOff(int channel) {
  const std::lock_guard lock(mutex_);
  servos_[static_cast<std::size_t>(channel)].target = 0;
}
int EmulatedMaestro::position_qus(int channel) {
  const std::lock_guard lock(mutex_);
  moveLocked();
  return static_cast<int>(std::lround(servos_[static_cast<std::size_t>(channel)].position));
}
int EmulatedMaestro::target_qus(int channel) {
  const std::lock_guard lock(mutex_);
  return servos_[static_cast<std::size_t>(channel)].target;
}
int EmulatedMaestro::speed(int channel) {
  const std::lock_guard lock(mutex_);
  return servos_[static_cast<std::size_t>(channel)].speed;
}

}  // namespace vismem
