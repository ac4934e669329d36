#include "drivers/pololu_maestro/maestro_codec.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismem::maestro {
namespace {

constexpr std::array kModels{
    Model{0x0089, "Micro Maestro 6", 6, true}, Model{0x008A, "Mini Maestro 12", 12, false},
    Model{0x008B, "Mini Maestro 18", 18, false}, Model{0x008C, "Mini Maestro 24", 24, false}};

constexpr std::uint8_t kToDevice = 0x40;
constexpr std::uint8_t kFromDevice = 0xC0;
constexpr std::uint8_t kGetVariables = 0x83;
constexpr std::uint8_t kSetServoVariable = 0x84;
constexpr std::uint8_t kSetTarget = 0x85;
constexpr std::uint8_t kClearErrors = 0x86;
constexpr std::uint8_t kGetServoSettings = 0x87;

/// Size of a Micro Maestro's variables, before its servos [bytes].
constexpr std::size_t kMicroHeader = 98;
constexpr std::size_t kMicroErrors = 2;
constexpr std::size_t kServoBytes = 7;

}  // namespace

const Model* modelOf(std::uint16_t vendor, std::uint16_t product) {
  const auto* model =
      std::find_if(kModels.begin(), kModels.end(), [&](const Model& m) { return m.product == product; });
  return vendor == kVendor && model != kModels.end() ? model : nullptr;
}

Request setTarget(int channel, int target_qus) {
  return {kToDevice, kSetTarget, static_cast<std::uint16_t>(target_qus), static_cast<std::uint16_t>(channel),
          0};
}

Request setSpeed(int channel, int speed) {
  return {kToDevice, kSetServoVariable, static_cast<std::uint16_t>(speed),
          static_cast<std::uint16_t>(channel), 0};
}

Request getServos(const Model& model) {
  const auto servos = static_cast<std::size_t>(model.channels) * kServoBytes;
  return {kFromDevice, model.micro ? kGetVariables : kGetServoSettings, 0, 0,
          static_cast<std::uint16_t>((model.micro ? kMicroHeader : 0) + servos)};
}

Request clearErrors() {
  return {kToDevice, kClearErrors, 0, 0, 0};
}

std::optional<State> parseServos(const Model& model, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < getServos(model).length) return std::nullopt;
  const auto word = [&](std::size_t at) { return bytes[at] + 256 * bytes[at + 1]; };
  State state;
  if (model.micro) state.errors = static_cast<unsigned>(word(kMicroErrors));
  std::size_t at = model.micro ? kMicroHeader : 0;
  for (int i = 0; i < model.channels; ++i, at += kServoBytes) {
    state.servos.push_back({word(at), word(at + 2), word(at + 4)});
  }
  return state;
}

int Pulse::target_qus(double angle_rad) const {
  return std::clamp(static_cast<int>(std::lround(4.0 * (centre_us + angle_rad * us_per_rad))), 1, 0xFFFF);
}

int Pulse::speed(double rate_radps) const {
  return std::clamp(static_cast<int>(std::lround(std::abs(rate_radps * us_per_rad) / kSpeedUnit_usps)), 1,
                    kFastest);
}

}  // namespace vismem::maestro
