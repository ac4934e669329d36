#include "drivers/pololu_maestro/maestro_usb.h"

#include <libusb.h>

#include <array>
#include <set>
#include <sstream>

namespace vismem::maestro {
namespace {

constexpr unsigned kTimeout_ms = 500;

std::string place(libusb_device* device) {
  std::ostringstream text;
  text << "bus " << static_cast<int>(libusb_get_bus_number(device)) << " device "
       << static_cast<int>(libusb_get_device_address(device));
  return text.str();
}

}  // namespace

struct Usb::Handles {
  libusb_context* context = nullptr;
  libusb_device_handle* device = nullptr;
};

Usb::Usb() : handles_(std::make_unique<Handles>()) {}

Usb::~Usb() {
  close();
}

bool Usb::isOpen() const {
  return handles_->device != nullptr;
}

void Usb::close() {
  if (handles_->device != nullptr) libusb_close(handles_->device);
  if (handles_->context != nullptr) libusb_exit(handles_->context);
  *handles_ = {};
}

std::string Usb::open(const std::string& serial) {
  close();
  // A new context each time: a context updates its list of devices by events of udev, which some machines do
  // not have.
  if (const int error = libusb_init(&handles_->context); error != 0) {
    handles_->context = nullptr;
    return std::string("no USB here: ") + libusb_strerror(error);
  }
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(handles_->context, &list);
  std::string why;
  std::set<std::string> all_serials;
  int found = 0;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    const Model* model = modelOf(descriptor.idVendor, descriptor.idProduct);
    if (model == nullptr) continue;
    libusb_device_handle* device = nullptr;
    const int error = libusb_open(list[i], &device);
    if (error != 0) {
      const std::string what = std::string(model->name) + " (" + place(list[i]) + ")";
      why = error == LIBUSB_ERROR_ACCESS
                ? "no permission for the " + what + ": a udev rule gives it (docs/hardware.md)"
                : "the " + what + " does not open: " + libusb_strerror(error);
      continue;
    }
    std::array<unsigned char, 64> text{};
    const int length = libusb_get_string_descriptor_ascii(device, descriptor.iSerialNumber, text.data(),
                                                          static_cast<int>(text.size()));
    const std::string its(text.begin(), text.begin() + std::max(0, length));
    all_serials.insert(its);
    const bool wanted = serial.empty() || its == serial;
    found += wanted ? 1 : 0;
    if (wanted && handles_->device == nullptr) {
      handles_->device = device;
      model_ = model;
    } else {
      libusb_close(device);
    }
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  if (found == 1) return {};
  std::string serials;
  for (const std::string& its : all_serials) serials += (serials.empty() ? "" : ", ") + its;
  if (found > 1) {
    why = "several Maestros are connected: set Serial to one of " + serials;
  } else if (why.empty()) {
    why = serials.empty()
              ? "no Maestro is connected"
              : "no Maestro with the serial number " + serial + " is connected (there are: " + serials + ")";
  }
  close();
  return why;
}

std::string Usb::transfer(const Request& request, std::vector<std::uint8_t>& answer) {
  answer.assign(request.length, 0);
  const int done = libusb_control_transfer(handles_->device, request.type, request.request, request.value,
                                           request.index, answer.data(), request.length, kTimeout_ms);
  if (done >= 0) {
    answer.resize(static_cast<std::size_t>(done));
    return {};
  }
  std::ostringstream why;
  switch (done) {
    case LIBUSB_ERROR_NO_DEVICE:
      return "the Maestro was unplugged";
    case LIBUSB_ERROR_TIMEOUT:
      return "the Maestro says nothing any more";
    case LIBUSB_ERROR_PIPE:
      why << "the Maestro refuses request 0x" << std::hex << static_cast<int>(request.request);
      return why.str();
    default:
      return std::string("the Maestro does not answer: ") + libusb_strerror(done);
  }
}

std::string Usb::transfer(const Request& request) {
  std::vector<std::uint8_t> none;
  return transfer(request, none);
}

}  // namespace vismem::maestro
