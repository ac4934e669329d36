#include "drivers/pioneer_p2os/p2os_codec.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem::p2os {
namespace {

constexpr std::uint8_t kHeader0 = 0xFA;
constexpr std::uint8_t kHeader1 = 0xFB;
constexpr std::size_t kBeforeData = 3;
constexpr std::size_t kChecksumBytes = 2;
constexpr std::uint8_t kPositive = 0x3B;
constexpr std::uint8_t kNegative = 0x1B;
constexpr double kHeadingUnit_rad = 2.0 * std::numbers::pi / 4096.0;
constexpr unsigned kCounterMask = 0x7FFF;

/// Reads little-endian fields in sequence; a missing field is 0 and marks the packet as incomplete.
class Fields {
 public:
  explicit Fields(BytesView data) : data_(data) {}
  bool complete() const { return complete_; }
  std::size_t left() const { return data_.size() - at_; }
  int byte() {
    if (at_ >= data_.size()) {
      complete_ = false;
      return 0;
    }
    return data_[at_++];
  }
  int word() {
    const int low = byte();
    return low + 256 * byte();
  }
  std::int16_t signedWord() { return static_cast<std::int16_t>(word()); }
  /// Text up to a NUL, which is required.
  std::string text() {
    std::string text;
    for (int c = byte(); complete_ && c != 0; c = byte()) text.push_back(static_cast<char>(c));
    return text;
  }
  void skip(std::size_t bytes) {
    complete_ = complete_ && bytes <= left();
    at_ += std::min(bytes, left());
  }

 private:
  BytesView data_;
  std::size_t at_ = 0;
  bool complete_ = true;
};

/// Difference of a counter of 15 bits, the shorter way round.
int counted(std::uint16_t to, std::uint16_t from) {
  const int up = static_cast<int>((static_cast<unsigned>(to) - static_cast<unsigned>(from)) & kCounterMask);
  return up > static_cast<int>(kCounterMask / 2) ? up - static_cast<int>(kCounterMask) - 1 : up;
}

}  // namespace

std::uint16_t checksum(BytesView data) {
  unsigned sum = 0;
  std::size_t i = 0;
  for (; i + 1 < data.size(); i += 2) sum += (static_cast<unsigned>(data[i]) << 8U) | data[i + 1];
  if (i < data.size()) sum = (sum & 0xFFFFU) ^ data[i];
  return static_cast<std::uint16_t>(sum & 0xFFFFU);
}

Bytes packet(BytesView data) {
  assert(!data.empty() && data.size() <= kMaxData);
  Bytes bytes{kHeader0, kHeader1, static_cast<std::uint8_t>(data.size() + kChecksumBytes)};
  bytes.insert(bytes.end(), data.begin(), data.end());
  const std::uint16_t sum = checksum(data);
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8U));
  bytes.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  return bytes;
}

Bytes command(Command command) {
  return packet(std::array{static_cast<std::uint8_t>(command)});
}

Bytes command(Command command, int argument) {
  const auto magnitude = static_cast<unsigned>(std::abs(std::clamp(argument, -65535, 65535)));
  return packet(std::array{static_cast<std::uint8_t>(command), argument < 0 ? kNegative : kPositive,
                           static_cast<std::uint8_t>(magnitude & 0xFFU),
                           static_cast<std::uint8_t>(magnitude >> 8U)});
}

Bytes sync(int step) {
  return packet(std::array{static_cast<std::uint8_t>(step)});
}

void PacketReader::add(BytesView bytes) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
}

std::optional<Bytes> PacketReader::next() {
  const auto drop = [this](std::size_t bytes) {
    garbage_ += bytes;
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(bytes));
  };
  while (true) {
    const auto header = std::find(pending_.begin(), pending_.end(), kHeader0);
    drop(static_cast<std::size_t>(header - pending_.begin()));
    if (pending_.size() < kBeforeData) return std::nullopt;
    const std::size_t length = pending_[2];
    if (pending_[1] != kHeader1 || length <= kChecksumBytes || length > kMaxData + kChecksumBytes) {
      drop(1);
      continue;
    }
    if (pending_.size() < kBeforeData + length) return std::nullopt;
    const BytesView data(pending_.data() + kBeforeData, length - kChecksumBytes);
    const unsigned sum = 256U * pending_[kBeforeData + data.size()] + pending_[kBeforeData + data.size() + 1];
    if (sum != checksum(data)) {
      // The length field may be damaged: the next packet may begin within this one.
      ++wrong_checksums_;
      drop(1);
      continue;
    }
    Bytes found(data.begin(), data.end());
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(kBeforeData + length));
    return found;
  }
}

void PacketReader::reset() {
  *this = {};
}

std::optional<Identity> parseIdentity(BytesView data) {
  Fields fields(data);
  if (fields.byte() != kSyncSteps - 1) return std::nullopt;
  Identity identity;
  identity.name = fields.text();
  identity.robot_class = fields.text();
  identity.subclass = fields.text();
  if (!fields.complete()) return std::nullopt;
  return identity;
}

std::optional<Sip> parseSip(BytesView data) {
  Fields fields(data);
  const int type = fields.byte();
  if (type != kStandingType && type != kMovingType) return std::nullopt;
  Sip sip;
  sip.moving = type == kMovingType;
  sip.x = static_cast<std::uint16_t>(static_cast<unsigned>(fields.word()) & kCounterMask);
  sip.y = static_cast<std::uint16_t>(static_cast<unsigned>(fields.word()) & kCounterMask);
  sip.heading = fields.signedWord();
  sip.left_mmps = fields.signedWord();
  sip.right_mmps = fields.signedWord();
  sip.battery_V = 0.1 * fields.byte();
  const auto left = static_cast<unsigned>(fields.byte());
  const auto right = static_cast<unsigned>(fields.byte());
  sip.left_stalled = (left & 1U) != 0;
  sip.right_stalled = (right & 1U) != 0;
  sip.left_bumpers = static_cast<std::uint8_t>(left & ~1U);
  sip.right_bumpers = static_cast<std::uint8_t>(right & ~1U);
  fields.word();  // the servo's set point
  const auto flags = static_cast<unsigned>(fields.word());
  sip.motors_on = (flags & 1U) != 0;
  sip.stop_button = (flags & 32U) != 0;
  fields.byte();  // compass
  fields.skip(3 * static_cast<std::size_t>(fields.byte()));
  if (!fields.complete()) return std::nullopt;
  // Gripper and digital inputs; then, with ARCOS, the battery as a 16-bit value, for more than 25.5 V.
  constexpr std::size_t kInputs = 5;
  if (fields.left() >= kInputs + 2) {
    fields.skip(kInputs);
    if (const int exact = fields.word(); exact > 0) sip.battery_V = 0.1 * exact;
  }
  return sip;
}

std::optional<RobotConfig> parseConfig(BytesView data) {
  Fields fields(data);
  if (fields.byte() != kConfigType) return std::nullopt;
  RobotConfig config;
  config.type = fields.text();
  config.subtype = fields.text();
  config.serial_number = fields.text();
  fields.byte();
  config.max_turn_rate_degps = fields.word();
  config.max_speed_mmps = fields.word();
  fields.skip(3 * 2);  // highest accelerations, pulse width
  config.name = fields.text();
  config.sip_cycle_ms = fields.byte();
  fields.skip(2 + 2 + 2 + 1);  // baud rates, gripper, sonars
  config.low_battery_V = 0.1 * fields.word();
  fields.word();  // ticks a turn
  config.watchdog_ms = fields.word();
  if (!fields.complete()) return std::nullopt;
  return config;
}

std::optional<Scale> scaleOf(std::string_view subclass) {
  static const std::map<std::string_view, Scale> kScales{
      {"p2dx", {0.84, 0.0056}}, {"p2at", {1.32, 0.0034}}, {"p3dx-sh", {1.0, 0.0056}}};
  const auto found = kScales.find(subclass);
  if (found == kScales.end()) return std::nullopt;
  return found->second;
}

Pose2 Odometry::add(const Sip& sip) {
  const Counters now{sip.x, sip.y, sip.heading};
  if (last_) {
    // The step in the robot's own frame, so that it does not depend on the heading in odom.
    const double heading_rad = last_->heading * kHeadingUnit_rad;
    const double dx_m = 1e-3 * scale_.mm_per_unit * counted(now.x, last_->x);
    const double dy_m = 1e-3 * scale_.mm_per_unit * counted(now.y, last_->y);
    const Pose2 step{std::cos(heading_rad) * dx_m + std::sin(heading_rad) * dy_m,
                     -std::sin(heading_rad) * dx_m + std::cos(heading_rad) * dy_m,
                     angleDifference(now.heading * kHeadingUnit_rad, heading_rad)};
    T_odom_robot_ = T_odom_robot_ * step;
  }
  last_ = now;
  return T_odom_robot_;
}

double forwardSpeed(const Sip& sip) {
  return 0.5e-3 * (sip.left_mmps + sip.right_mmps);
}

double turnRate(const Sip& sip, const Scale& scale) {
  return 0.5 * (sip.right_mmps - sip.left_mmps) * scale.radps_per_mmps;
}

}  // namespace vismem::p2os
