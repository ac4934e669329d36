/// @file A PTU-46 for tests of its driver: the unit by its manual, on a pseudo terminal.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "support/pty_line.h"

namespace vismem {

/// As after power-up it echoes and answers in sentences until commands switch this off. Limits, speeds and
/// steps are the manual's examples. *Thread-safe*.
class Ptu46Device {
 public:
  struct Faults {
    bool deaf = false;      ///< neither receives nor sends
    bool silent = false;    ///< receives and obeys without replies
    bool garbled = false;   ///< each reply is something else
    bool no_range = false;  ///< its limits are the same on both sides
    std::chrono::milliseconds reset_time{50};
  };

  Ptu46Device();
  ~Ptu46Device();

  std::string path() const { return line_.path(); }
  void change(const std::function<void(Faults&)>& what);
  void unplug();
  void plugIn();
  /// Sends this text unasked.
  void say(const std::string& text);
  /// The next commands of this kind ("PP") are refused.
  void refuse(const std::string& command, const std::string& message);

  /// [steps] of pan and tilt.
  std::array<double, 2> position() const;
  bool moves() const;
  /// All commands so far.
  std::vector<std::string> heard() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Joint {
    double at = 0.0;
    double target = 0.0;
    double speed = 1000.0;
    long minimum, maximum;
  };

  void run(const std::stop_token& stop);
  void obey(const std::string& command);
  void obeyAxis(Joint& joint, const std::string& name, char what, const std::string& argument);
  void done(const std::string& sentence = {}, const std::string& terse = {});
  void error(const std::string& message);

  mutable std::mutex mutex_;
  PtyLine line_;
  Faults faults_;
  std::array<Joint, 2> joints_{Joint{0.0, 0.0, 1000.0, -3090, 3090}, Joint{0.0, 0.0, 1000.0, -907, 604}};
  std::string pending_;
  std::vector<std::string> heard_;
  std::string refused_command_, refused_message_;
  bool echo_ = true;
  bool verbose_ = true;
  Clock::time_point busy_until_ = Clock::now();
  std::jthread thread_;
};

}  // namespace vismem
