#include "hwkernel/uvc_model.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace vismem {
namespace {

constexpr std::uint32_t kInterval_100ns = 333'333;
constexpr std::size_t kPictureBytes = std::size_t{2} * UvcModel::kWidth * UvcModel::kHeight;
constexpr std::size_t kHeader = 2;
/// Units of the video function.
constexpr int kCamera = 1, kOutput = 2, kExtension = 3;
constexpr std::int32_t kDegree = 3600;

enum Request {
  kSetCurrent = 0x01,
  kGetCurrent = 0x81,
  kGetMinimum,
  kGetMaximum,
  kGetStep,
  kGetLength,
  kGetInfo,
  kGetDefault
};

class Bytes {
 public:
  Bytes& u8(int value) {
    all_.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Bytes& u16(int value) { return u8(value & 0xFF).u8((value >> 8) & 0xFF); }
  Bytes& u32(std::uint32_t value) {
    return u16(static_cast<int>(value & 0xFFFFU)).u16(static_cast<int>(value >> 16U));
  }
  Bytes& add(std::initializer_list<int> values) {
    for (const int value : values) u8(value);
    return *this;
  }
  Bytes& add(const std::vector<std::uint8_t>& bytes) {
    all_.insert(all_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  std::vector<std::uint8_t> take() const { return all_; }
  std::size_t size() const { return all_.size(); }

 private:
  std::vector<std::uint8_t> all_;
};

std::int32_t numberIn(std::span<const std::uint8_t> data, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size && at + i < data.size(); ++i) {
    value |= static_cast<std::uint32_t>(data[at + i]) << (8 * i);
  }
  return size == 2 ? static_cast<std::int16_t>(value) : static_cast<std::int32_t>(value);
}

Bytes frame(int kind) {
  // Class-specific, of this kind, number 1, no still pictures.
  return Bytes()
      .add({30, 0x24, kind, 1, 0})
      .u16(UvcModel::kWidth)
      .u16(UvcModel::kHeight)
      .u32(8 * kPictureBytes * 30)
      .u32(8 * kPictureBytes * 30)
      .u32(kPictureBytes)
      .u32(kInterval_100ns)
      .u8(1)
      .u32(kInterval_100ns);
}

}  // namespace

std::vector<std::uint8_t> UvcModel::deviceDescriptor() const {
  // USB 2.0, functions by association, 64 bytes, an Orbit's numbers.
  return Bytes()
      .add({18, 1})
      .u16(0x0200)
      .add({0xEF, 2, 1, 64})
      .u16(0x046d)
      .u16(0x0994)
      .u16(0x0100)
      .add({0, 2, 0, 1})
      .take();
}

std::vector<std::uint8_t> UvcModel::configuration() const {
  const bool orbit = motors_ == Motors::kOrbit;
  Bytes units;
  // Camera terminal; bit 11 of its controls: pan and tilt, absolute.
  units.add({18, 0x24, 2, kCamera})
      .u16(0x0201)
      .add({0, 0})
      .u16(0)
      .u16(0)
      .u16(0)
      .add({3, 0, orbit ? 0 : 0x08, 0});
  if (orbit) {
    units.add({26,   0x24, 6,    kExtension, 0x82, 0x06, 0x61, 0x63, 0x70, 0x50,    0xab, 0x49, 0xb8,
               0xcc, 0xb3, 0x85, 0x5e,       0x8d, 0x22, 0x56, 2,    1,    kCamera, 1,    0x03, 0});
  }
  units.add({9, 0x24, 3, kOutput}).u16(0x0101).add({0, orbit ? kExtension : kCamera, 0});

  Bytes formats;
  // YUY2, 16 bits a pixel.
  formats.add({27, 0x24, 4,    1, 1,    'Y',  'U',  'Y', '2', 0, 0, 0x10, 0, 0x80,
               0,  0,    0xaa, 0, 0x38, 0x9b, 0x71, 16,  1,   0, 0, 0,    0});
  formats.add(frame(5).take()).add({6, 0x24, 0x0D, 1, 1, 4});
  formats.add({11, 0x24, 6, 2, 1, 1, 1, 0, 0, 0, 0});
  formats.add(frame(7).take()).add({6, 0x24, 0x0D, 1, 1, 4});

  Bytes rest;
  rest.add({8, 11, 0, 2, 0x0E, 3, 0, 0});
  rest.add({9, 4, 0, 0, 0, 0x0E, 1, 0, 0});
  rest.add({13, 0x24, 1}).u16(0x0100).u16(static_cast<int>(13 + units.size())).u32(48'000'000).add({1, 1});
  rest.add(units.take());
  rest.add({9, 4, 1, 0, 1, 0x0E, 2, 0, 0});
  rest.add({15, 0x24, 1, 2})
      .u16(static_cast<int>(15 + formats.size()))
      .add({0x81, 0, kOutput, 0, 0, 0, 1, 0, 0});
  rest.add(formats.take());
  rest.add({7, 5, 0x81, 2}).u16(512).u8(0);
  return Bytes()
      .add({9, 2})
      .u16(static_cast<int>(9 + rest.size()))
      .add({2, 1, 0, 0x80, 250})
      .add(rest.take())
      .take();
}

UsbModel::Answer UvcModel::standard(const Setup& setup) const {
  constexpr int kGetDescriptor = 6;
  if ((setup[0] & 0x80) == 0) return {};  // SET_CONFIGURATION, SET_INTERFACE, CLEAR_FEATURE
  if (setup[1] == kGetDescriptor) {
    if (setup[3] == 1) return {0, deviceDescriptor()};
    if (setup[3] == 2) return {0, configuration()};
    if (setup[3] == 3) {
      if (setup[2] == 0) return {0, {4, 3, 9, 4}};
      const std::string name = "Turning Camera";
      Bytes text;
      text.add({static_cast<int>(2 + 2 * name.size()), 3});
      for (const char c : name) text.u16(c);
      return {0, text.take()};
    }
    return {-EPIPE, {}};
  }
  return {0, {0, 0}};  // GET_STATUS, GET_INTERFACE
}

UsbModel::Answer UvcModel::streaming(const Setup& setup, std::span<const std::uint8_t> data) {
  if (setup[1] == kSetCurrent) {
    if (data.size() > 2) format_ = data[2] == 2 ? 2 : 1;
    // A commit begins a new stream.
    payload_.clear();
    sent_ = 0;
    return {};
  }
  if (setup[1] == kGetInfo) return {0, {3}};
  if (setup[1] == kGetLength) return {0, {26, 0}};
  return {0, Bytes()
                 .u16(1)
                 .u8(format_)
                 .u8(1)
                 .u32(kInterval_100ns)
                 .u16(0)
                 .u16(0)
                 .u16(0)
                 .u16(0)
                 .u16(0)
                 .u32(kPictureBytes)
                 .u32(kPictureBytes + kHeader)
                 .take()};
}

UsbModel::Answer UvcModel::entity(const Setup& setup, std::span<const std::uint8_t> data) {
  const int unit = setup[5];
  const int selector = setup[3];
  if (motors_ == Motors::kAbsolute && unit == kCamera && selector == 0x0D) {
    const auto both = [](std::int32_t pan, std::int32_t tilt) {
      return Answer{
          0, Bytes().u32(static_cast<std::uint32_t>(pan)).u32(static_cast<std::uint32_t>(tilt)).take()};
    };
    switch (setup[1]) {
      case kSetCurrent:
        pan_ = numberIn(data, 0, 4);
        tilt_ = numberIn(data, 4, 4);
        return {};
      case kGetCurrent:
        return both(pan_, tilt_);
      case kGetMinimum:
        return both(-70 * kDegree, -30 * kDegree);
      case kGetMaximum:
        return both(70 * kDegree, 30 * kDegree);
      case kGetStep:
        return both(kDegree / 10, kDegree / 10);
      case kGetDefault:
        return both(0, 0);
      case kGetInfo:
        return {0, {3}};
      case kGetLength:
        return {0, {8, 0}};
      default:
        return {-EPIPE, {}};
    }
  }
  if (motors_ == Motors::kOrbit && unit == kExtension && (selector == 1 || selector == 2)) {
    const std::size_t size = selector == 1 ? 4 : 1;
    switch (setup[1]) {
      case kSetCurrent:
        if (selector == 1) {
          pan_ += numberIn(data, 0, 2);
          tilt_ += numberIn(data, 2, 2);
        } else if (!data.empty()) {
          ++resets_;
          if ((data[0] & 1U) != 0) pan_ = 0;
          if ((data[0] & 2U) != 0) tilt_ = 0;
        }
        return {};
      case kGetInfo:
        return {0, {2}};
      case kGetLength:
        return {0, {static_cast<std::uint8_t>(size), 0}};
      case kGetMinimum:
        return {0, selector == 1 ? Bytes().u16(-32768).u16(-32768).take() : std::vector<std::uint8_t>{0}};
      case kGetMaximum:
        return {0, selector == 1 ? Bytes().u16(32767).u16(32767).take() : std::vector<std::uint8_t>{3}};
      case kGetStep:
        return {0, selector == 1 ? Bytes().u16(1).u16(1).take() : std::vector<std::uint8_t>{1}};
      case kGetDefault:
      case kGetCurrent:
        return {0, std::vector<std::uint8_t>(size, 0)};
      default:
        return {-EPIPE, {}};
    }
  }
  return {-EPIPE, {}};
}

UsbModel::Answer UvcModel::control(const Setup& setup, std::span<const std::uint8_t> data) {
  if ((setup[0] & 0x60) == 0) return standard(setup);
  // Class requests: the interface is the low byte of the index, the unit the high one.
  return setup[4] == 1 ? streaming(setup, data) : entity(setup, data);
}

std::optional<std::vector<std::uint8_t>> UvcModel::bulkIn(std::size_t most) {
  if (payload_.empty()) {
    const auto now = Clock::now();
    if (now < due_) return std::nullopt;
    due_ = std::max(now, due_ + std::chrono::nanoseconds(100L * kInterval_100ns));
    toggle_ = !toggle_;
    // Length of the header; bit 0 changes from picture to picture, bit 1 is the end of one, bit 7 of the
    // header.
    payload_ = {kHeader, static_cast<std::uint8_t>(0x82 | (toggle_ ? 1 : 0))};
    if (format_ == 2) {
      payload_.insert(payload_.end(), jpeg_.begin(), jpeg_.end());
    } else {
      payload_.resize(kHeader + kPictureBytes, 128);
      for (std::size_t i = kHeader; i < payload_.size(); i += 2) payload_[i] = kGrey;
    }
    sent_ = 0;
  }
  const std::size_t size = std::min(most, payload_.size() - sent_);
  const auto begin = payload_.begin() + static_cast<std::ptrdiff_t>(sent_);
  std::vector<std::uint8_t> part(begin, begin + static_cast<std::ptrdiff_t>(size));
  sent_ += size;
  if (sent_ == payload_.size()) payload_.clear();
  return part;
}

std::string UvcModel::state() {
  return std::to_string(pan_) + " " + std::to_string(tilt_) + " " + std::to_string(resets_);
}

}  // namespace vismem
