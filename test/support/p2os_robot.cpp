#include "support/p2os_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace vismem {
namespace {

using p2os::Bytes;
using p2os::Command;

constexpr double kMmPerUnit = 0.84;
constexpr double kTurnFactor = 0.0056;
constexpr double kDeg = std::numbers::pi / 180.0;

void put(Bytes& bytes, int word) {
  const auto bits = static_cast<unsigned>(word) & 0xFFFFU;
  bytes.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(bits >> 8U));
}
void put(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(0);
}

double towards(double from, double to, double up, double down, double dt_s) {
  // Slower, or through zero: braking.
  const bool brakes = std::abs(to) < std::abs(from) || to * from < 0.0;
  const double step = (brakes ? down : up) * dt_s;
  return std::abs(to - from) <= step ? to : from + std::copysign(step, to - from);
}

}  // namespace

P2osRobot::P2osRobot(const Traits& traits) : traits_(traits) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

P2osRobot::~P2osRobot() {
  thread_.request_stop();
  thread_.join();
}

void P2osRobot::run(const std::stop_token& stop) {
  auto moved_until = Clock::now();
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(mutex_);
    const Bytes bytes = line_.read(0);
    const bool understands = traits_.baud_bps == 0 || line_.baud_bps() == traits_.baud_bps;
    if (!bytes.empty() && !faults_.deaf) {
      if (understands) {
        reader_.add(bytes);
        while (const auto data = reader_.next()) obey(*data);
      }
    }
    const auto now = Clock::now();
    if (open_ && std::chrono::duration<double>(now - last_packet_).count() > traits_.watchdog_s)
      watchdog_came_ = true;
    move(std::chrono::duration<double>(now - moved_until).count());
    moved_until = now;
    if (now >= next_sip_) {
      next_sip_ = std::max(next_sip_ + traits_.sip_period, now);
      if (open_ && understands) sendSip();
    }
  }
}

void P2osRobot::obey(const Bytes& data) {
  heard_.push_back({Clock::now(), data});
  const int number = data.front();
  int argument = 0;
  if (data.size() >= 4) {
    argument = data[2] + 256 * data[3];
    if (data[1] == 0x1B) argument = -argument;
  }
  if (!open_) {
    if (sync_ == p2os::kSyncSteps && number == static_cast<int>(Command::kOpen)) {
      open_ = true;
      motors_on_ = watchdog_came_ = false;
      set_speed_ = set_turn_ = 0.0;
      x_mm_ = y_mm_ = heading_rad_ = 0.0;
      last_packet_ = Clock::now();
      sync_ = 0;
    } else if (data.size() == 1 && number == (number == 0 ? 0 : sync_) && number < p2os::kSyncSteps) {
      sync_ = number + 1;
      Bytes echo{static_cast<std::uint8_t>(number)};
      if (number == p2os::kSyncSteps - 1) {
        put(echo, std::string("TestBot"));
        put(echo, std::string("Pioneer"));
        put(echo, traits_.subclass);
      }
      answer(echo);
    }
    return;
  }
  last_packet_ = Clock::now();
  watchdog_came_ = false;  // and so it resumes its last command
  switch (static_cast<Command>(number)) {
    case Command::kClose:
      if (faults_.stubborn_session) break;
      open_ = motors_on_ = false;
      set_speed_ = set_turn_ = 0.0;
      break;
    case Command::kEnable:
      motors_on_ = argument != 0 && !faults_.stop_button;
      break;
    case Command::kSpeed:
      set_speed_ = argument;
      break;
    case Command::kTurnRate:
      set_turn_ = argument;
      break;
    case Command::kStop:
      set_speed_ = set_turn_ = 0.0;
      break;
    case Command::kSetAcceleration:
      (argument > 0 ? acceleration_ : deceleration_) = std::abs(argument);
      break;
    case Command::kSetTurnAcceleration:
      (argument > 0 ? turn_acceleration_ : turn_deceleration_) = std::abs(argument);
      break;
    case Command::kConfig:
      sendConfig();
      break;
    default:
      break;
  }
}

void P2osRobot::move(double dt_s) {
  if (faults_.stop_button) motors_on_ = false;
  const bool drives =
      open_ && motors_on_ && !watchdog_came_ && !faults_.left_stalled && !faults_.right_stalled;
  speed_ = towards(speed_, drives ? set_speed_ : 0.0, acceleration_, drives ? deceleration_ : 4000.0, dt_s);
  turn_ = towards(turn_, drives ? set_turn_ : 0.0, turn_acceleration_, drives ? turn_deceleration_ : 1000.0,
                  dt_s);
  fastest_ = std::max(fastest_, std::abs(speed_));
  const double middle = heading_rad_ + 0.5 * turn_ * kDeg * dt_s;
  x_mm_ += speed_ * std::cos(middle) * dt_s;
  y_mm_ += speed_ * std::sin(middle) * dt_s;
  heading_rad_ += turn_ * kDeg * dt_s;
}

void P2osRobot::answer(std::span<const std::uint8_t> data) {
  if (faults_.silent || faults_.deaf) return;
  Bytes bytes = p2os::packet(data);
  if (faults_.wrong_checksums) bytes.back() ^= 0x55U;
  line_.write(bytes);
}

void P2osRobot::sendSip() {
  // Whole mm/s that its encoders have seen, none that they have not.
  const int middle = static_cast<int>(speed_);
  const int half_difference = static_cast<int>(turn_ * kDeg / kTurnFactor);
  const int left = middle - half_difference;
  const int right = middle + half_difference;
  const auto counter = [](double mm) { return static_cast<int>(std::lround(mm / kMmPerUnit)) & 0x7FFF; };
  Bytes sip{left != 0 || right != 0 ? p2os::kMovingType : p2os::kStandingType};
  put(sip, counter(x_mm_));
  put(sip, counter(y_mm_));
  const double turns = heading_rad_ / (2.0 * std::numbers::pi);
  put(sip, static_cast<int>(std::lround(4096.0 * (turns - std::floor(turns)))));
  put(sip, left);
  put(sip, right);
  sip.push_back(static_cast<std::uint8_t>(std::lround(10.0 * faults_.battery_V)));
  sip.push_back(faults_.left_stalled ? 1 : 0);
  sip.push_back(faults_.right_stalled ? 1 : 0);
  put(sip, 0);
  put(sip, (motors_on_ ? 1 : 0) + (faults_.stop_button ? 32 : 0));
  sip.push_back(0);  // compass
  sip.push_back(1);  // one sonar
  sip.push_back(0);
  put(sip, 5000);
  sip.insert(sip.end(), {0, 0, 0, 0, 0});  // gripper, inputs, outputs
  answer(sip);
}

void P2osRobot::sendConfig() {
  Bytes config{p2os::kConfigType};
  put(config, std::string("Pioneer"));
  put(config, traits_.subclass);
  put(config, std::string("TEST01"));
  config.push_back(0);
  for (const int value : {360, 2200, 300, 2000, 500}) put(config, value);
  put(config, std::string("TestBot"));
  config.insert(config.end(), {static_cast<std::uint8_t>(traits_.sip_period.count()), 0, 0});
  put(config, 0);
  put(config, 1);
  config.push_back(0);
  put(config, 110);
  put(config, 19105);
  put(config, traits_.reported_watchdog_ms);
  config.insert(config.end(), {1, 0, 0, 0, 0});
  answer(config);
}

void P2osRobot::change(const std::function<void(Faults&)>& what) {
  const std::lock_guard lock(mutex_);
  what(faults_);
}

void P2osRobot::switchMotorsOff() {
  const std::lock_guard lock(mutex_);
  motors_on_ = false;
}

void P2osRobot::unplug() {
  const std::lock_guard lock(mutex_);
  line_.unplug();
}

void P2osRobot::plugIn() {
  const std::lock_guard lock(mutex_);
  line_.plugIn();
}

void P2osRobot::babble(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  line_.write(bytes);
}

void P2osRobot::leaveOldSession(double speed_mmps) {
  const std::lock_guard lock(mutex_);
  open_ = motors_on_ = watchdog_came_ = true;
  set_speed_ = speed_mmps;
  speed_ = fastest_ = 0.0;
  last_packet_ = Clock::now() - std::chrono::hours(1);
}

double P2osRobot::speed_mmps() const {
  const std::lock_guard lock(mutex_);
  return speed_;
}
double P2osRobot::turnRate_degps() const {
  const std::lock_guard lock(mutex_);
  return turn_;
}
double P2osRobot::setSpeed_mmps() const {
  const std::lock_guard lock(mutex_);
  return set_speed_;
}
bool P2osRobot::sessionOpen() const {
  const std::lock_guard lock(mutex_);
  return open_;
}
bool P2osRobot::motorsOn() const {
  const std::lock_guard lock(mutex_);
  return motors_on_;
}
bool P2osRobot::watchdogCame() const {
  const std::lock_guard lock(mutex_);
  return watchdog_came_;
}
double P2osRobot::fastest_mmps() {
  const std::lock_guard lock(mutex_);
  return std::exchange(fastest_, std::abs(speed_));
}
std::vector<P2osRobot::Heard> P2osRobot::heard() const {
  const std::lock_guard lock(mutex_);
  return heard_;
}

}  // namespace vismem
