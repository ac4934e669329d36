/// @file The packets that a Pioneer robot's microcontroller (P2OS, ARCOS) exchanges with its host. Pure:
/// bytes in, values out.
///
/// Both ways: 0xFA 0xFB, N = number of bytes that follow, data, checksum (most significant byte first).
/// Numbers in the data are little endian. A host's data is a command's number and at most one argument; a
/// robot's begins with the packet's type. Sources: the Pioneer 2 operations manual, and the public drivers of
/// Player and AriaCoda, whose bytes the tests compare with.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/pose.h"

namespace vismem::p2os {

using Bytes = std::vector<std::uint8_t>;
using BytesView = std::span<const std::uint8_t>;

enum class Command : std::uint8_t {
  kPulse = 0,  ///< only resets the robot's watchdog
  kOpen = 1,
  kClose = 2,
  kEnable = 4,                ///< motors: 1 on, 0 off
  kSetAcceleration = 5,       ///< [mm/s2]; negative: deceleration
  kSetMaxSpeed = 6,           ///< [mm/s]
  kSpeed = 11,                ///< [mm/s], held until the next
  kSetMaxTurnRate = 10,       ///< [deg/s]
  kConfig = 18,               ///< asks for a packet of kConfigType
  kTurnRate = 21,             ///< [deg/s], counter-clockwise, held until the next
  kSetTurnAcceleration = 23,  ///< [deg/s2]; negative: deceleration
  kSonar = 28,                ///< 1 on, 0 off
  kStop = 29,                 ///< brakes; the motors stay on
};
/// Before a session is open the same numbers mean the three steps of the handshake, which the robot echoes.
constexpr int kSyncSteps = 3;

constexpr std::uint8_t kStandingType = 0x32;  ///< a Sip while the wheels stand
constexpr std::uint8_t kMovingType = 0x33;    ///< a Sip while they turn
constexpr std::uint8_t kConfigType = 0x20;

/// Maximum length of data [bytes], for the protocol's maximum of 200 bytes per packet.
constexpr std::size_t kMaxData = 195;

/// Sum of the big-endian 16-bit words modulo 65536; the last byte of an odd number is then XORed.
std::uint16_t checksum(BytesView data);
/// The packet around data of 1..kMaxData bytes.
Bytes packet(BytesView data);
Bytes command(Command command);
/// @param argument is clamped to -65535..65535: its sign travels in the argument's type.
Bytes command(Command command, int argument);
Bytes sync(int step);

/// Finds packets in a stream of bytes, ignores bytes between them, and drops packets with a wrong checksum.
class PacketReader {
 public:
  void add(BytesView bytes);
  /// The data of the next whole packet.
  std::optional<Bytes> next();
  /// Resets the reader to its initial state.
  void reset();

  std::size_t garbageBytes() const { return garbage_; }  ///< that belong to no packet
  std::size_t wrongChecksums() const { return wrong_checksums_; }

 private:
  Bytes pending_;
  std::size_t garbage_ = 0;
  std::size_t wrong_checksums_ = 0;
};

/// The robot's answer to the last step of the handshake.
struct Identity {
  std::string name;
  std::string robot_class;  ///< "Pioneer"
  std::string subclass;     ///< "p2dx"
};
/// @return empty unless the data is the echo of step 2 with three names.
std::optional<Identity> parseIdentity(BytesView data);

/// The server information packet, about ten times a second, in the robot's own units.
struct Sip {
  bool moving = false;
  std::uint16_t x = 0;  ///< 15 bits, which roll over
  std::uint16_t y = 0;
  std::int16_t heading = 0;    ///< 4096 a turn
  std::int16_t left_mmps = 0;  ///< speed of the left wheel
  std::int16_t right_mmps = 0;
  double battery_V = 0.0;
  bool left_stalled = false;
  bool right_stalled = false;
  std::uint8_t left_bumpers = 0;  ///< without the stall bit
  std::uint8_t right_bumpers = 0;
  bool motors_on = false;
  bool stop_button = false;
};
/// @return empty for other packets and for truncated ones.
std::optional<Sip> parseSip(BytesView data);

/// The robot's own settings.
struct RobotConfig {
  std::string type;
  std::string subtype;
  std::string serial_number;
  std::string name;
  int max_turn_rate_degps = 0;
  int max_speed_mmps = 0;
  int sip_cycle_ms = 0;
  double low_battery_V = 0.0;
  int watchdog_ms = 0;  ///< the robot stops by itself this long after the last packet
};
/// @return empty for other packets and for truncated ones.
std::optional<RobotConfig> parseConfig(BytesView data);

/// Conversion of a model's units to SI units.
struct Scale {
  double mm_per_unit = 1.0;        ///< of x and y
  double radps_per_mmps = 0.0056;  ///< turn rate per half the difference of the wheels' speeds
};
/// @param subclass name from the robot: "p2dx".
/// @return empty for an unknown model.
std::optional<Scale> scaleOf(std::string_view subclass);

/// Dead reckoning from counters that roll over. The pose continues when the robot's counters restart.
class Odometry {
 public:
  explicit Odometry(const Scale& scale = {}) : scale_(scale) {}
  void setScale(const Scale& scale) { scale_ = scale; }
  /// To be called after a restart of the robot's counters: the next ones belong to the present pose.
  void restart() { last_.reset(); }
  /// @return T_odom_robot, which begins at the origin.
  Pose2 add(const Sip& sip);
  Pose2 pose() const { return T_odom_robot_; }

 private:
  struct Counters {
    std::uint16_t x = 0;
    std::uint16_t y = 0;
    std::int16_t heading = 0;
  };
  Scale scale_;
  std::optional<Counters> last_;
  Pose2 T_odom_robot_;
};

/// [m/s] forward.
double forwardSpeed(const Sip& sip);
/// [rad/s] counter-clockwise.
double turnRate(const Sip& sip, const Scale& scale);

}  // namespace vismem::p2os
