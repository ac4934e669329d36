#include "common/robot/ports.h"

#include <sstream>

namespace vismem {

std::optional<PortReply> rejectAbsurd(const FrameRequest& request) {
  const auto side = [](const char* name, int value) -> std::optional<PortReply> {
    if (value >= 0 && value <= kMaxImageSide_px) return std::nullopt;
    return PortReply::rejected(std::string(name) + " = " + std::to_string(value) + " (must be 0.." +
                               std::to_string(kMaxImageSide_px) + ")");
  };
  if (auto reply = side("width", request.width)) return reply;
  if (auto reply = side("height", request.height)) return reply;
  // Written so that a NaN fails too.
  const double rate = request.rate_hz;
  if (rate == 0.0 || (rate >= kMinFrameRate_hz && rate <= kMaxFrameRate_hz)) return std::nullopt;
  std::ostringstream text;
  text << "rate = " << rate << " Hz (must be 0 or " << kMinFrameRate_hz << ".." << kMaxFrameRate_hz << ")";
  return PortReply::rejected(text.str());
}

}  // namespace vismem
