#include "common/process/stream_health.h"

#include "common/process/status.h"

namespace vismem {

void StreamHealth::came(std::size_t count, SteadyTime now, const std::string& condition) {
  status_.alive(reader_);
  last_ = now;
  for (std::size_t i = 0; i < count; ++i) status_.count(stream_);
  condition.empty() ? status_.healthy(device_) : status_.fault(device_, condition);
}

void StreamHealth::nothing(const std::string& why, SteadyTime now) {
  status_.alive(reader_);
  // The duration of its absence counts from the first answer.
  if (last_ == SteadyTime{}) last_ = now;
  if (now - last_ >= patience_) status_.fault(device_, why.empty() ? "it gives nothing" : why);
}

}  // namespace vismem
