#include "drivers/ptu46/ptu46_codec.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <utility>

namespace vismem::ptu46 {
namespace {

/// Longest reply [bytes]; longer bytes are garbage with the begin of a reply.
constexpr std::size_t kLongestReply = 200;

char letter(Axis axis) {
  return axis == Axis::kPan ? 'P' : 'T';
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::string query(Axis axis, char what) {
  return {letter(axis), what, ' '};
}

std::string set(Axis axis, char what, long value) {
  return std::string{letter(axis), what} + std::to_string(value) + ' ';
}

void ReplyReader::add(std::span<const std::uint8_t> bytes) {
  pending_.append(bytes.begin(), bytes.end());
}

std::optional<Reply> ReplyReader::next() {
  while (true) {
    const auto begin = pending_.find_first_of("*!");
    const std::size_t before = begin == std::string::npos ? pending_.size() : begin;
    for (std::size_t i = 0; i < before; ++i)
      other_ += std::isspace(static_cast<unsigned char>(pending_[i])) == 0;
    pending_.erase(0, before);
    if (pending_.size() < 2) return std::nullopt;
    if (pending_[0] == '!' && (pending_[1] == 'P' || pending_[1] == 'T')) {
      const auto kind = pending_[1] == 'P' ? Reply::Kind::kPanLimit : Reply::Kind::kTiltLimit;
      pending_.erase(0, 2);
      return Reply{kind, {}};
    }
    const auto end = pending_.find_first_of("\r\n");
    if (end == std::string::npos) {
      if (pending_.size() < kLongestReply) return std::nullopt;
      other_ += 1;
      pending_.erase(0, 1);
      continue;
    }
    // Messages of limit switches may occur within sentences.
    for (const auto& [mark, kind] :
         {std::pair{"!P", Reply::Kind::kPanLimit}, {"!T", Reply::Kind::kTiltLimit}}) {
      const auto at = pending_.find(mark, 1);
      if (at < end) {
        pending_.erase(at, 2);
        return Reply{kind, {}};
      }
    }
    const Reply reply{pending_[0] == '*' ? Reply::Kind::kDone : Reply::Kind::kError,
                      trimmed(pending_.substr(1, end - 1))};
    pending_.erase(0, end + 1);
    return reply;
  }
}

std::optional<double> numberIn(const std::string& text) {
  std::optional<double> found;
  for (std::size_t at = 0; at < text.size();) {
    const auto begin = text.find_first_not_of(" \t", at);
    if (begin == std::string::npos) break;
    const auto end = std::min(text.find_first_of(" \t", begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    char* rest = nullptr;
    const double value = std::strtod(word.c_str(), &rest);
    const bool digits = word.find_first_of("0123456789") != std::string::npos;
    if (digits && *rest == '\0') {
      if (found) return std::nullopt;
      found = value;
    }
    at = end;
  }
  return found;
}

}  // namespace vismem::ptu46
