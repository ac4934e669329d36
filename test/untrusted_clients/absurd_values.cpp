#include "untrusted_clients/absurd_values.h"

#include <array>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace vismem::test {
namespace {

constexpr std::size_t kHugeText = 10'000'000;
/// Compact class encoding (Ice manual, data encoding): the last slice, its type id as a string.
constexpr std::uint8_t kLastSliceWithTypeId = 0x21;

}  // namespace

double AbsurdValues::real() {
  using Limits = std::numeric_limits<double>;
  static constexpr std::array kValues = {Limits::quiet_NaN(),
                                         Limits::signaling_NaN(),
                                         Limits::infinity(),
                                         -Limits::infinity(),
                                         Limits::max(),
                                         Limits::lowest(),
                                         Limits::denorm_min(),
                                         0.0,
                                         -0.0,
                                         -1.0,
                                         1e-300,
                                         1e9,
                                         -1e9,
                                         1.0};
  if (below(3) > 0) return kValues[random_() % kValues.size()];
  const std::uint64_t bits = random_();
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::int64_t AbsurdValues::whole() {
  using Limits = std::numeric_limits<std::int64_t>;
  static constexpr std::array<std::int64_t, 12> kValues = {Limits::min(),
                                                           Limits::max(),
                                                           Limits::min() + 1,
                                                           -1,
                                                           0,
                                                           1,
                                                           1'000'000,
                                                           2'147'483'647,
                                                           -2'147'483'648LL,
                                                           4'294'967'295LL,
                                                           Limits::max() - 1'000'000,
                                                           Limits::min() + 1'000'000};
  return below(3) > 0 ? kValues[random_() % kValues.size()] : static_cast<std::int64_t>(random_());
}

std::string AbsurdValues::text() {
  static const std::array<std::string, 13> kTexts = {"",
                                                     "RGB8",
                                                     "GRAY8",
                                                     "JPEG",
                                                     "YUY2",
                                                     "rgb8",
                                                     "%s%s%n%x",
                                                     "../../../etc/passwd",
                                                     std::string("nul\0nul", 7),
                                                     "\xff\xfe\xc3",
                                                     "\x1b[2J\r\n\n",
                                                     "\xf0\x9f\xa4\x96",
                                                     std::string(300, 'L')};
  const int kind = below(400);
  if (kind == 0) return std::string(kHugeText, 'A');
  if (kind < 8) return std::string(static_cast<std::size_t>(below(100'000)), '\xc3');
  if (kind < 100) {
    std::string noise(static_cast<std::size_t>(below(64)), ' ');
    for (char& c : noise) c = static_cast<char>(below(256));
    return noise;
  }
  return kTexts[random_() % kTexts.size()];
}

void AbsurdValues::addClass(WireBytes& bytes, const SliceType& type, int depth) {
  switch (below(8)) {
    case 0:
      bytes.size(0);  // null
      return;
    case 1:
      bytes.size(2 + below(300));  // one that came before, or none did
      return;
    case 2:
      bytes.size(1).byte(kLastSliceWithTypeId).text("::avm::NoSuchClass" + text().substr(0, 40));
      return;
    case 3:
      bytes.size(1).byte(static_cast<std::uint8_t>(below(256))).text(type.type_id);
      break;
    default:
      bytes.size(1).byte(kLastSliceWithTypeId).text(type.type_id);
      break;
  }
  for (const auto& member : type.members) add(bytes, member, depth + 1);
}

void AbsurdValues::addSequence(WireBytes& bytes, const SliceType& type, int depth) {
  static constexpr std::array<std::int64_t, 5> kLies = {-1, 2'147'483'647, -2'147'483'648LL, 100'000'000,
                                                        255};
  const int count = below(4);
  const bool lies = below(4) == 0;
  bytes.size(lies ? kLies[random_() % kLies.size()] : count);
  for (int i = 0; i < count; ++i) add(bytes, type.members.front(), depth + 1);
}

void AbsurdValues::add(WireBytes& bytes, const std::string& type, int depth) {
  if (type == "bool") {
    bytes.byte(static_cast<std::uint8_t>(below(2) == 0 ? below(2) : below(256)));
  } else if (type == "byte") {
    bytes.byte(static_cast<std::uint8_t>(below(256)));
  } else if (type == "short") {
    bytes.number(static_cast<std::int16_t>(whole()));
  } else if (type == "int") {
    bytes.number(static_cast<std::int32_t>(whole()));
  } else if (type == "long") {
    bytes.number(whole());
  } else if (type == "float") {
    const double value = real();
    // Out of float's range a conversion is undefined; the wire takes any bits.
    const auto bits = static_cast<std::uint32_t>(random_());
    const bool fits = value != value || (value >= -3e38 && value <= 3e38);
    if (fits) {
      bytes.number(static_cast<float>(value));
    } else {
      bytes.number(bits);
    }
  } else if (type == "double") {
    bytes.number(real());
  } else if (type == "string") {
    bytes.text(text());
  } else {
    const SliceType& named = model_.types.at(type);
    if (depth > 20) throw std::runtime_error("a type that holds itself: " + type);
    switch (named.kind) {
      case SliceType::Kind::kEnum:
        bytes.size(below(2) == 0   ? below(named.enumerators)
                   : below(2) == 0 ? below(255)
                                   : static_cast<std::int32_t>(whole()));
        break;
      case SliceType::Kind::kStruct:
        for (const auto& member : named.members) add(bytes, member, depth + 1);
        break;
      case SliceType::Kind::kSequence:
        addSequence(bytes, named, depth);
        break;
      case SliceType::Kind::kClass:
        addClass(bytes, named, depth);
        break;
    }
  }
}

std::string AbsurdValues::parametersOf(const SliceOperation& operation) {
  WireBytes bytes;
  for (const auto& type : operation.parameters) add(bytes, type, 0);
  return bytes.take();
}

}  // namespace vismem::test
