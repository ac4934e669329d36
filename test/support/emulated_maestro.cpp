#include "support/emulated_maestro.h"

#include <sys/ioctl.h>
#include <sys/stat.h>
// After sys/ioctl.h, which it needs and does not name.
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <functional>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "support/emulated_node.h"

namespace vismem {
namespace {

std::string hexOf(const std::vector<std::uint8_t>& bytes) {
  std::ostringstream hex;
  hex << std::hex << std::setfill('0');
  for (const std::uint8_t byte : bytes) hex << std::setw(2) << static_cast<unsigned>(byte);
  return hex.str();
}

EmulatedNode::Description describe(std::uint16_t product, const std::string& descriptors, int number) {
  std::ostringstream id;
  id << std::hex << std::setfill('0') << std::setw(4) << product;
  const std::string port = std::to_string(number);
  const std::string address = "00" + std::to_string(number + 1);
  const std::string device = "/devices/usb1/1-" + port;
  const std::string node = "bus/usb/001/" + address;
  return {"/sys" + device, "/dev/" + node,
          "P: " + device + "\nN: " + node +
              "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=" + address +
              "\nE: MAJOR=189\nE: MINOR=" + port + "\nE: DEVNAME=/dev/" + node +
              "\nA: busnum=1\\n\nA: devnum=" + std::to_string(number + 1) +
              "\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\nA: idVendor=1ffb\\n\nA: idProduct=" +
              id.str() + "\\n\nA: dev=189:" + port + "\\n\nH: descriptors=" + descriptors + "\n\n"};
}

}  // namespace

/// The node as usbfs has it: what a transfer's ioctls do.
struct EmulatedMaestro::Node {
  Node(EmulatedMaestro& maestro, std::uint16_t product, int number)
      : node(describe(product, hexOf(maestro.descriptors()), number),
             [this, &maestro](unsigned code, const auto& argument) {
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
    : MaestroModel(product, serial), node_(std::make_unique<Node>(*this, product, number)) {
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

void EmulatedMaestro::forbid(bool forbidden) {
  const std::string node = node_->node.realPath();
  if (chmod(node.c_str(), forbidden ? 0 : 0600) != 0) {
    throw std::runtime_error(node + ": " + std::strerror(errno));
  }
}

}  // namespace vismem
