#include "support/emulated_maestro.h"

#include <sys/ioctl.h>
// After sys/ioctl.h, which it needs and does not name.
#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace vismem {
namespace {

constexpr char kDevice[] = "/sys/devices/usb1/1-1";
constexpr char kNode[] = "/dev/bus/usb/001/002";

/// The handler of the node's ioctls, as GObject wants it.
struct Handler {
  UMockdevIoctlBase parent;
  EmulatedMaestro* maestro;
  std::deque<gulong>* done;
  UMockdevIoctlData* unanswered;  ///< a transfer that waits until it is given up
};
struct HandlerClass {
  UMockdevIoctlBaseClass parent;
};
gboolean handleIoctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client);
void initialiseClass(gpointer handlers, gpointer) {
  static_cast<HandlerClass*>(handlers)->parent.handle_ioctl = handleIoctl;
}
GType handlerType() {
  static const GType type =
      g_type_register_static_simple(UMOCKDEV_TYPE_IOCTL_BASE, "VismemMaestroHandler", sizeof(HandlerClass),
                                    initialiseClass, sizeof(Handler), nullptr, G_TYPE_FLAG_NONE);
  return type;
}

UMockdevIoctlData* resolve(UMockdevIoctlData* from, gsize offset, gsize size) {
  GError* error = nullptr;
  UMockdevIoctlData* data =
      umockdev_ioctl_data_resolve(from, static_cast<gint>(offset), static_cast<gint>(size), &error);
  if (error != nullptr) {
    const std::string what = error->message;
    g_error_free(error);
    throw std::runtime_error(what);
  }
  return data;
}

gboolean handleIoctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client) {
  auto* handler = reinterpret_cast<Handler*>(base);
  const auto request = static_cast<unsigned>(umockdev_ioctl_client_get_request(client) & 0xFFFFFFFFU);
  const auto complete = [client](long result, int error) {
    umockdev_ioctl_client_complete(client, result, error);
    return TRUE;
  };
  if (!handler->maestro->plugged()) return complete(-1, ENODEV);
  UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* capabilities = resolve(arg, 0, sizeof(std::uint32_t));
      const std::uint32_t none = 0;
      std::memcpy(capabilities->data, &none, sizeof none);
      umockdev_ioctl_data_update(capabilities, 0, capabilities->data, static_cast<gint>(sizeof none));
      g_object_unref(capabilities);
      return complete(0, 0);
    }
    case USBDEVFS_SUBMITURB: {
      UMockdevIoctlData* urb_data = resolve(arg, 0, sizeof(usbdevfs_urb));
      auto* urb = reinterpret_cast<usbdevfs_urb*>(urb_data->data);
      UMockdevIoctlData* buffer =
          resolve(urb_data, offsetof(usbdevfs_urb, buffer), static_cast<gsize>(urb->buffer_length));
      const gulong address = urb_data->client_addr;
      if (handler->maestro->silent()) {
        handler->unanswered = static_cast<UMockdevIoctlData*>(g_object_ref(urb_data));
      } else {
        std::array<std::uint8_t, 8> setup{};
        std::memcpy(setup.data(), buffer->data, setup.size());
        const auto transfer = handler->maestro->control(setup);
        urb->status = transfer.status;
        urb->actual_length = static_cast<int>(transfer.data.size());
        std::copy(transfer.data.begin(), transfer.data.end(), buffer->data + 8);
        umockdev_ioctl_data_update(buffer, 0, buffer->data, buffer->data_len);
        umockdev_ioctl_data_update(urb_data, 0, urb_data->data, static_cast<gint>(sizeof(usbdevfs_urb)));
        handler->done->push_back(address);
      }
      g_object_unref(buffer);
      g_object_unref(urb_data);
      return complete(0, 0);
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: {
      if (handler->done->empty()) return complete(-1, EAGAIN);
      const gulong address = handler->done->front();
      handler->done->pop_front();
      UMockdevIoctlData* pointer = resolve(arg, 0, sizeof(void*));
      std::memcpy(pointer->data, &address, sizeof address);
      umockdev_ioctl_data_update(pointer, 0, pointer->data, static_cast<gint>(sizeof address));
      g_object_unref(pointer);
      return complete(0, 0);
    }
    case USBDEVFS_DISCARDURB: {
      if (handler->unanswered == nullptr) return complete(-1, EINVAL);
      UMockdevIoctlData* given_up = std::exchange(handler->unanswered, nullptr);
      reinterpret_cast<usbdevfs_urb*>(given_up->data)->status = -ENOENT;
      umockdev_ioctl_data_update(given_up, 0, given_up->data, static_cast<gint>(sizeof(usbdevfs_urb)));
      handler->done->push_back(given_up->client_addr);
      g_object_unref(given_up);
      return complete(0, 0);
    }
    default:
      return complete(0, 0);
  }
}

}  // namespace

struct EmulatedMaestro::Node {
  UMockdevTestbed* testbed = umockdev_testbed_new();
  Handler* handler = nullptr;
  std::deque<gulong> done;
  std::atomic<bool> plugged = false;
  ~Node() {
    if (handler != nullptr) g_object_unref(handler);
    g_object_unref(testbed);
  }
};

EmulatedMaestro::EmulatedMaestro(std::uint16_t product, const std::string& serial)
    : product_(product),
      serial_(serial),
      servos_(product == 0x0089 ? 6U : 12U),
      node_(std::make_unique<Node>()) {
  if (umockdev_in_mock_environment() == FALSE) {
    throw std::runtime_error("not under umockdev: run this test by ctest, or behind umockdev-wrapper");
  }
  plugIn();
}

EmulatedMaestro::~EmulatedMaestro() {
  unplug();
}

void EmulatedMaestro::plugIn() {
  if (node_->plugged) return;
  std::ostringstream hex;
  hex << std::hex << std::setfill('0');
  const auto byte = [&](unsigned value) { hex << std::setw(2) << (value & 0xFFU); };
  // Device: USB 2.0, vendor-specific, 64 bytes, vendor, product, release 1.00, strings 1, 2, 3, one
  // configuration; configuration: 9 + 9 bytes, one interface of vendor class without endpoints.
  const std::array<unsigned, 36> descriptors{0x12,
                                             1,
                                             0,
                                             2,
                                             0xff,
                                             0,
                                             0,
                                             64,
                                             0xfb,
                                             0x1f,
                                             product_ & 0xFFU,
                                             static_cast<unsigned>(product_) >> 8U,
                                             0,
                                             1,
                                             1,
                                             2,
                                             3,
                                             1,
                                             9,
                                             2,
                                             18,
                                             0,
                                             1,
                                             1,
                                             0,
                                             0xc0,
                                             50,
                                             9,
                                             4,
                                             0,
                                             0,
                                             0,
                                             0xff,
                                             0,
                                             0,
                                             0};
  for (const unsigned value : descriptors) byte(value);
  std::ostringstream product;
  product << std::hex << std::setfill('0') << std::setw(4) << product_;
  const std::string description =
      "P: /devices/usb1/1-1\nN: bus/usb/001/002\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\n"
      "E: BUSNUM=001\nE: DEVNUM=002\nE: MAJOR=189\nE: MINOR=1\n"
      "E: DEVNAME=/dev/bus/usb/001/002\n"
      "A: busnum=1\\n\nA: devnum=2\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n"
      "A: idVendor=1ffb\\n\nA: idProduct=" +
      product.str() + "\\n\nA: dev=189:1\\n\nH: descriptors=" + hex.str() + "\n\n";
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(node_->testbed, description.c_str(), &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  if (node_->handler == nullptr) {
    node_->handler = static_cast<Handler*>(g_object_new(handlerType(), nullptr));
    node_->handler->maestro = this;
    node_->handler->done = &node_->done;
    node_->handler->unanswered = nullptr;
  }
  if (umockdev_testbed_attach_ioctl(node_->testbed, kNode,
                                    reinterpret_cast<UMockdevIoctlBase*>(node_->handler), &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  node_->plugged = true;
}

void EmulatedMaestro::unplug() {
  if (!node_->plugged.exchange(false)) return;
  GError* error = nullptr;
  umockdev_testbed_detach_ioctl(node_->testbed, kNode, &error);
  if (error != nullptr) g_error_free(error);
  umockdev_testbed_uevent(node_->testbed, kDevice, "remove");
  umockdev_testbed_remove_device(node_->testbed, kDevice);
}

bool EmulatedMaestro::plugged() const {
  return node_->plugged;
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
