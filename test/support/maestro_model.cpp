#include "support/maestro_model.h"

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace vismem {
namespace {

constexpr std::ptrdiff_t kDeviceDescriptor = 18;

}  // namespace

std::vector<std::uint8_t> MaestroModel::descriptors() const {
  // Device: USB 2.0, vendor-specific, 64 bytes, vendor, product, release 1.00, strings 1, 2, 3, one
  // configuration; configuration: 9 + 9 bytes, one interface of vendor class without endpoints.
  const auto low = static_cast<std::uint8_t>(product_ & 0xFFU);
  const auto high = static_cast<std::uint8_t>(product_ >> 8U);
  // clang-format off
  return {18, 1, 0, 2, 0xff, 0, 0, 64, 0xfb, 0x1f, low, high, 0, 1, 1, 2, 3, 1,
          9, 2, 18, 0, 1, 1, 0, 0xc0, 50, 9, 4, 0, 0, 0, 0xff, 0, 0, 0};
  // clang-format on
}

bool MaestroModel::silent() {
  const std::lock_guard lock(mutex_);
  return silent_;
}

void MaestroModel::moveLocked() {
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

MaestroModel::Transfer MaestroModel::control(const std::array<std::uint8_t, 8>& setup) {
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
  } else if (type == 0x80 && request == 6 &&
             setup[3] != 3) {  // descriptors of the device (1) or configuration (2)
    const auto all = descriptors();
    if (setup[3] == 1) {
      data.assign(all.begin(), all.begin() + kDeviceDescriptor);
    } else if (setup[3] == 2) {
      data.assign(all.begin() + kDeviceDescriptor, all.end());
    } else {
      transfer.status = -EPIPE;
    }
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

void MaestroModel::refuse(int request) {
  const std::lock_guard lock(mutex_);
  refused_ = request;
}
void MaestroModel::setSilent(bool silent) {
  const std::lock_guard lock(mutex_);
  silent_ = silent;
}
void MaestroModel::setErrors(unsigned bits) {
  const std::lock_guard lock(mutex_);
  errors_ = bits;
}
void MaestroModel::setShortAnswers(bool shorter) {
  const std::lock_guard lock(mutex_);
  short_ = shorter;
}
void MaestroModel::switchOff(int channel) {
  const std::lock_guard lock(mutex_);
  servos_[static_cast<std::size_t>(channel)].target = 0;
}
int MaestroModel::position_qus(int channel) {
  const std::lock_guard lock(mutex_);
  moveLocked();
  return static_cast<int>(std::lround(servos_[static_cast<std::size_t>(channel)].position));
}
int MaestroModel::target_qus(int channel) {
  const std::lock_guard lock(mutex_);
  return servos_[static_cast<std::size_t>(channel)].target;
}
int MaestroModel::speed(int channel) {
  const std::lock_guard lock(mutex_);
  return servos_[static_cast<std::size_t>(channel)].speed;
}

}  // namespace vismem
