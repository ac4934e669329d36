#include "support/ptu46_device.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace vismem {
namespace {

constexpr long kSlowest = 31;
constexpr long kFastest = 2902;

}  // namespace

Ptu46Device::Ptu46Device() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Ptu46Device::~Ptu46Device() {
  thread_.request_stop();
  thread_.join();
}

void Ptu46Device::run(const std::stop_token& stop) {
  auto moved_until = Clock::now();
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(mutex_);
    const auto bytes = line_.read(0);
    const auto now = Clock::now();
    const double dt_s = std::chrono::duration<double>(now - moved_until).count();
    moved_until = now;
    for (Joint& joint : joints_) {
      const double way = joint.target - joint.at;
      joint.at += std::copysign(std::min(std::abs(way), joint.speed * dt_s), way);
    }
    if (!faults_.deaf) pending_.append(bytes.begin(), bytes.end());
    if (now < busy_until_) continue;
    for (auto end = pending_.find_first_of(" \r"); end != std::string::npos;
         end = pending_.find_first_of(" \r")) {
      const std::string command = pending_.substr(0, end);
      if (echo_ && !faults_.silent)
        line_.write(
            std::vector<std::uint8_t>(pending_.begin(), pending_.begin() + static_cast<long>(end) + 1));
      pending_.erase(0, end + 1);
      if (!command.empty()) obey(command);
      if (Clock::now() < busy_until_) break;
    }
  }
}

void Ptu46Device::obey(const std::string& command) {
  heard_.push_back(command);
  const std::string name = command.substr(0, 2);
  if (name == refused_command_) return error(refused_message_);
  if (command == "ED" || command == "EE") {
    echo_ = command == "EE";
    return done();
  }
  if (command == "FT" || command == "FV") {
    verbose_ = command == "FV";
    return done();
  }
  if (command == "CI" || command == "I") return done();
  if (command == "H" || command == "HP" || command == "HT") {
    if (command != "HT") joints_[0].target = joints_[0].at;
    if (command != "HP") joints_[1].target = joints_[1].at;
    return done();
  }
  if (command == "R") {
    for (Joint& joint : joints_) joint.at = joint.target = 0.0;
    busy_until_ = Clock::now() + faults_.reset_time;
    return done("!T!T!P!P*");
  }
  if (name.size() == 2 && (name[0] == 'P' || name[0] == 'T')) {
    return obeyAxis(joints_[name[0] == 'P' ? 0 : 1], name[0] == 'P' ? "Pan" : "Tilt", name[1],
                    command.substr(2));
  }
  error("Illegal command entered");
}

void Ptu46Device::obeyAxis(Joint& joint, const std::string& name, char what, const std::string& argument) {
  const auto answer = [&](const std::string& sentence, const std::string& value) {
    done("* " + sentence + value, "* " + value);
  };
  const long value = std::atol(argument.c_str());
  switch (what) {
    case 'P':
      if (argument.empty()) {
        return answer("Current " + name + " position is ", std::to_string(std::lround(joint.at)));
      }
      if (value > joint.maximum) {
        return error("Maximum allowable " + name + " position is " + std::to_string(joint.maximum));
      }
      if (value < joint.minimum) {
        return error("Minimum allowable " + name + " position is " + std::to_string(joint.minimum));
      }
      joint.target = static_cast<double>(value);
      return done();
    case 'S':
      if (argument.empty())
        return answer("Target " + name + " speed is ", std::to_string(std::lround(joint.speed)));
      if (value < kSlowest || value > kFastest) return error(name + " speed out of range");
      joint.speed = static_cast<double>(value);
      return done();
    case 'R':
      return done("* 185.142853 seconds arc per " + name + " position", "* 185.142853");
    case 'N':
      return answer("Minimum " + name + " position is ", std::to_string(joint.minimum));
    case 'X':
      return answer("Maximum " + name + " position is ",
                    std::to_string(faults_.no_range ? joint.minimum : joint.maximum));
    case 'L':
      return answer("Minimum " + name + " speed is ", std::to_string(kSlowest) + " ");
    case 'U':
      return answer("Maximum " + name + " speed is ", std::to_string(kFastest));
    default:
      error("Illegal command entered");
  }
}

void Ptu46Device::done(const std::string& sentence, const std::string& terse) {
  const std::string text = verbose_ || terse.empty() ? (sentence.empty() ? "*" : sentence) : terse;
  const std::string sent = (faults_.garbled ? "~~%" : text) + "\r\n";
  if (!faults_.silent) line_.write(std::vector<std::uint8_t>(sent.begin(), sent.end()));
}

void Ptu46Device::error(const std::string& message) {
  const std::string sent = (faults_.garbled ? "~~%" : "! " + message) + "\r\n";
  if (!faults_.silent) line_.write(std::vector<std::uint8_t>(sent.begin(), sent.end()));
}

void Ptu46Device::change(const std::function<void(Faults&)>& what) {
  const std::lock_guard lock(mutex_);
  what(faults_);
}
void Ptu46Device::unplug() {
  const std::lock_guard lock(mutex_);
  line_.unplug();
}
void Ptu46Device::plugIn() {
  const std::lock_guard lock(mutex_);
  pending_.clear();
  line_.plugIn();
}
void Ptu46Device::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  line_.write(std::vector<std::uint8_t>(text.begin(), text.end()));
}
void Ptu46Device::refuse(const std::string& command, const std::string& message) {
  const std::lock_guard lock(mutex_);
  refused_command_ = command;
  refused_message_ = message;
}
std::array<double, 2> Ptu46Device::position() const {
  const std::lock_guard lock(mutex_);
  return {joints_[0].at, joints_[1].at};
}
bool Ptu46Device::moves() const {
  const std::lock_guard lock(mutex_);
  return joints_[0].at != joints_[0].target || joints_[1].at != joints_[1].target;
}
std::vector<std::string> Ptu46Device::heard() const {
  const std::lock_guard lock(mutex_);
  return heard_;
}

}  // namespace vismem
