/// @file The ASCII commands of Directed Perception's pan-tilt units (PTU-46, D46) and their replies. Pure.
///
/// A command ends with a blank. It is answered by "*", "* RESULT" or "! MESSAGE" up to the end of the line;
/// "!P" and "!T" may come at any time: an axis has run into its limit switch. By default the unit may echo
/// its input and answer in sentences. Source: the PTU-D46 user's manual 2.14.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace vismem::ptu46 {

enum class Axis { kPan, kTilt };

/// "PP", "TS": the letters of axis and quantity.
std::string query(Axis axis, char what);
/// "PP-500 ".
std::string set(Axis axis, char what, long value);

constexpr char kPosition = 'P';    ///< [steps], absolute
constexpr char kSpeed = 'S';       ///< [steps/s], > 0
constexpr char kResolution = 'R';  ///< [arc seconds a step]
constexpr char kMinimum = 'N';     ///< [steps]
constexpr char kMaximum = 'X';     ///< [steps]
constexpr char kSlowest = 'L';     ///< [steps/s]
constexpr char kFastest = 'U';     ///< [steps/s]

struct Reply {
  enum class Kind { kDone, kError, kPanLimit, kTiltLimit };
  Kind kind = Kind::kDone;
  std::string text;  ///< result or message, without the blanks around it
};

/// Finds replies in the received bytes and ignores echo between them.
class ReplyReader {
 public:
  void add(std::span<const std::uint8_t> bytes);
  std::optional<Reply> next();
  void reset() { *this = {}; }
  /// Bytes that belong to no reply: echo or garbage.
  std::size_t otherBytes() const { return other_; }

 private:
  std::string pending_;
  std::size_t other_ = 0;
};

/// The number in a result, which may be a sentence: "* Current Pan position is -12".
/// @return empty unless there is exactly one.
std::optional<double> numberIn(const std::string& text);

/// Range of an axis, in the unit's steps.
struct AxisRange {
  double step_rad = 0.0;
  long minimum = 0, maximum = 0;
  long slowest = 0, fastest = 0;
};

/// Conversion between angles and the unit's steps: angle 0 is `zero_rad` of the unit; `inverted` reverses the
/// sign.
struct AxisFrame {
  double zero_rad = 0.0;
  bool inverted = false;

  double angle(double steps, double step_rad) const {
    return (inverted ? -1.0 : 1.0) * (steps * step_rad - zero_rad);
  }
  double steps(double angle_rad, double step_rad) const {
    return ((inverted ? -angle_rad : angle_rad) + zero_rad) / step_rad;
  }
};

}  // namespace vismem::ptu46
