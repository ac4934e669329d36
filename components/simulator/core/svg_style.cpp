#include "simulator/core/svg_style.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace vismem {
namespace {

constexpr double kLargestLength = 1e9;

const std::map<std::string, std::uint32_t> kNames{
    {"aqua", 0x00ffff},   {"black", 0x000000}, {"blue", 0x0000ff},   {"fuchsia", 0xff00ff},
    {"gray", 0x808080},   {"grey", 0x808080},  {"green", 0x008000},  {"lime", 0x00ff00},
    {"maroon", 0x800000}, {"navy", 0x000080},  {"olive", 0x808000},  {"orange", 0xffa500},
    {"purple", 0x800080}, {"red", 0xff0000},   {"silver", 0xc0c0c0}, {"teal", 0x008080},
    {"white", 0xffffff},  {"yellow", 0xffff00}};

SvgPaint fromNumber(std::uint32_t rgb) {
  return {SvgColor{static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
                   static_cast<std::uint8_t>(rgb)}};
}

std::string trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\n\r\f\v";
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin));
}

std::optional<SvgPaint> fromHex(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (digits.size() == 6) return fromNumber(value);
  if (digits.size() != 3) return std::nullopt;
  return fromNumber((value >> 8 & 15) * 0x110000 + (value >> 4 & 15) * 0x1100 + (value & 15) * 0x11);
}

/// rgb(1, 2, 3) or rgb(10% 20% 30%).
std::optional<SvgPaint> fromFunction(std::string_view text) {
  if (!text.starts_with("rgb(") || !text.ends_with(')')) return std::nullopt;
  text = text.substr(4, text.size() - 5);
  SvgColor color{};
  for (auto& channel : color) {
    const auto begin = std::min(text.find_first_not_of(", "), text.size());
    const auto end = std::min(text.find_first_of(", ", begin), text.size());
    const auto number = parseSvgLength(text.substr(begin, end - begin));
    if (!number || (!number->unit.empty() && number->unit != "%")) return std::nullopt;
    text.remove_prefix(end);
    channel = static_cast<std::uint8_t>(std::lround(std::clamp(number->units(255.0), 0.0, 255.0)));
  }
  if (!trimmed(text).empty()) return std::nullopt;
  return SvgPaint{color};
}

/// Attributes and the parts of `style` with a colon, which win.
std::map<std::string, std::string> declarationsOf(const tinyxml2::XMLElement& e) {
  std::map<std::string, std::string> result;
  for (auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) result[a->Name()] = trimmed(a->Value());
  const std::string style = svgText(e, "style");
  for (std::string_view text = style; !text.empty();) {
    const auto end = std::min(text.find(';'), text.size());
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto colon = one.find(':');
    if (colon != std::string_view::npos)
      result[trimmed(one.substr(0, colon))] = trimmed(one.substr(colon + 1));
  }
  return result;
}

/// The values of one element, read into a look.
class LookReader {
 public:
  LookReader(const tinyxml2::XMLElement& e, SvgReport& report)
      : e_(e), report_(report), says_(declarationsOf(e)) {}

  void given(const char* name, const std::function<void(const std::string&)>& use) const {
    const auto known = says_.find(name);
    if (known != says_.end() && known->second != "inherit") use(known->second);
  }
  void paint(const char* name, SvgPaint& result) const {
    given(name, [&](const std::string& v) {
      if (v.starts_with("url(")) {
        report_.leftOut(e_, std::string(name) + " = \"" + v + "\" is left out (plain colours are known)");
        result = {};
      } else if (const auto paint = parseSvgPaint(v)) {
        result = *paint;
      } else {
        report_.wrong(e_, name, v, "none, #rgb, #rrggbb, rgb(), or a basic colour name as white");
      }
    });
  }
  /// @param use gets a number in 0..1.
  void opacity(const char* name, const std::function<void(double)>& use) const {
    given(name, [&](const std::string& v) {
      const auto number = parseSvgLength(v);
      if (number && (number->unit.empty() || number->unit == "%")) {
        use(std::clamp(number->units(1.0), 0.0, 1.0));
      } else {
        report_.wrong(e_, name, v, "a number in 0..1");
      }
    });
  }
  void pen(SvgStroke& pen) const {
    given("stroke-width", [&](const std::string& v) {
      const auto width = parseSvgLength(v);
      if (width && width->value >= 0.0 && width->unit != "%") {
        pen.width = width->units(0.0);
      } else {
        report_.wrong(e_, "stroke-width", v, "a number of 0 or more, maybe with a unit");
      }
    });
    given("stroke-miterlimit", [&](const std::string& v) {
      if (const auto limit = parseSvgLength(v); limit && limit->value >= 1.0) pen.miter_limit = limit->value;
    });
  }
  void unsupported() const {
    for (const char* name : {"clip-path", "mask", "stroke-dasharray", "filter", "marker", "marker-start",
                             "marker-mid", "marker-end"}) {
      given(name, [&](const std::string& v) {
        if (v != "none" && v != "0" && !v.empty()) report_.leftOut(e_, std::string(name) + " is not applied");
      });
    }
  }

 private:
  const tinyxml2::XMLElement& e_;
  SvgReport& report_;
  std::map<std::string, std::string> says_;
};

}  // namespace

std::optional<SvgPaint> parseSvgPaint(std::string_view raw) {
  std::string text = trimmed(raw);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (text == "none" || text == "transparent") return SvgPaint{};
  if (text.starts_with('#')) return fromHex(std::string_view(text).substr(1));
  if (const auto known = kNames.find(text); known != kNames.end()) return fromNumber(known->second);
  return fromFunction(text);
}

double SvgLength::units(double hundred_percent) const {
  if (unit == "%") return value / 100.0 * hundred_percent;
  static const std::map<std::string, double> kPixels{
      {"", 1.0},           {"px", 1.0},         {"in", 96.0},        {"cm", 96.0 / 2.54},
      {"mm", 96.0 / 25.4}, {"Q", 96.0 / 101.6}, {"pt", 96.0 / 72.0}, {"pc", 16.0}};
  return value * kPixels.at(unit);
}

std::optional<SvgLength> parseSvgLength(std::string_view raw) {
  std::string text = trimmed(raw);
  if (text.starts_with('+')) text.erase(0, 1);
  const std::size_t digits = text.starts_with('-') ? 1 : 0;
  if (digits >= text.size() ||
      (std::isdigit(static_cast<unsigned char>(text[digits])) == 0 && text[digits] != '.')) {
    return std::nullopt;  // nan and inf are numbers to from_chars
  }
  SvgLength result;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.value);
  if (error != std::errc() || !(std::abs(result.value) <= kLargestLength)) return std::nullopt;
  result.unit = std::string(end, static_cast<std::size_t>(text.data() + text.size() - end));
  for (const char* known : {"", "px", "mm", "cm", "in", "pt", "pc", "Q", "%"}) {
    if (result.unit == known) return result;
  }
  return std::nullopt;
}

SvgLook svgLookOf(const tinyxml2::XMLElement& e, const SvgLook& around, SvgReport& report) {
  SvgLook look = around;
  look.fixed_width = false;
  const LookReader in(e, report);
  in.paint("fill", look.fill);
  in.paint("stroke", look.stroke);
  in.pen(look.pen);
  in.given("stroke-linejoin", [&](const std::string& v) { look.join = v; });
  in.given("stroke-linecap", [&](const std::string& v) { look.cap = v; });
  in.given("fill-rule", [&](const std::string& v) { look.even_odd = v == "evenodd"; });
  in.given("visibility", [&](const std::string& v) { look.visible = v == "visible"; });
  in.given("vector-effect", [&](const std::string& v) { look.fixed_width = v == "non-scaling-stroke"; });
  in.opacity("fill-opacity", [&](double v) { look.fill_opacity = v; });
  in.opacity("stroke-opacity", [&](double v) { look.stroke_opacity = v; });
  in.opacity("opacity", [&](double v) { look.opacity *= v; });
  in.given("display", [&](const std::string& v) {
    if (v == "none") look.opacity = 0.0;
  });
  in.given("data-label", [&](const std::string& v) { look.label = v == "none" ? "" : v; });
  in.unsupported();
  return look;
}

}  // namespace vismem
