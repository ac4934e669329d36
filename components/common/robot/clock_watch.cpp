#include "common/robot/clock_watch.h"

#include <cstdlib>
#include <iomanip>
#include <sstream>

namespace vismem {
namespace {

/// Above the age of a sample on a loaded network.
constexpr StampUs kTolerated_us = 300'000;
/// Unsynchronized clocks differ by seconds or minutes; larger differences indicate another time base.
constexpr StampUs kComparable_us = 600 * kSecondUs;
constexpr StampUs kPatience_us = 3 * kSecondUs;

}  // namespace

std::string ClockWatch::check(StampUs stamp_us, StampUs host_now_us) {
  const StampUs ahead_us = stamp_us - host_now_us;
  if (std::abs(ahead_us) <= kTolerated_us || std::abs(ahead_us) > kComparable_us) {
    off_since_us_.reset();
    return "";
  }
  if (!off_since_us_) off_since_us_ = host_now_us;
  if (host_now_us - *off_since_us_ < kPatience_us) return "";
  std::ostringstream text;
  text << "stamps are " << std::fixed << std::setprecision(1) << toSeconds(std::abs(ahead_us)) << " s "
       << (ahead_us > 0 ? "ahead of" : "behind") << " this host's clock (are the hosts kept in step by NTP?)";
  return text.str();
}

}  // namespace vismem
