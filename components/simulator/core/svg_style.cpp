#include "simulator/core/svg_style.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

namespace vismem {
namespace {

constexpr double kLargest = 1e9;
/// Paint with a smaller alpha counts as transparent.
constexpr double kVisibleAlpha = 0.5;
constexpr std::size_t kMaxRules = 2'000;

struct NamedColor {
  std::string_view name;
  std::uint32_t rgb;
};
constexpr NamedColor kNames[] = {{"aliceblue", 0xf0f8ff},
                                 {"antiquewhite", 0xfaebd7},
                                 {"aqua", 0x00ffff},
                                 {"aquamarine", 0x7fffd4},
                                 {"azure", 0xf0ffff},
                                 {"beige", 0xf5f5dc},
                                 {"bisque", 0xffe4c4},
                                 {"black", 0x000000},
                                 {"blanchedalmond", 0xffebcd},
                                 {"blue", 0x0000ff},
                                 {"blueviolet", 0x8a2be2},
                                 {"brown", 0xa52a2a},
                                 {"burlywood", 0xdeb887},
                                 {"cadetblue", 0x5f9ea0},
                                 {"chartreuse", 0x7fff00},
                                 {"chocolate", 0xd2691e},
                                 {"coral", 0xff7f50},
                                 {"cornflowerblue", 0x6495ed},
                                 {"cornsilk", 0xfff8dc},
                                 {"crimson", 0xdc143c},
                                 {"cyan", 0x00ffff},
                                 {"darkblue", 0x00008b},
                                 {"darkcyan", 0x008b8b},
                                 {"darkgoldenrod", 0xb8860b},
                                 {"darkgray", 0xa9a9a9},
                                 {"darkgreen", 0x006400},
                                 {"darkgrey", 0xa9a9a9},
                                 {"darkkhaki", 0xbdb76b},
                                 {"darkmagenta", 0x8b008b},
                                 {"darkolivegreen", 0x556b2f},
                                 {"darkorange", 0xff8c00},
                                 {"darkorchid", 0x9932cc},
                                 {"darkred", 0x8b0000},
                                 {"darksalmon", 0xe9967a},
                                 {"darkseagreen", 0x8fbc8f},
                                 {"darkslateblue", 0x483d8b},
                                 {"darkslategray", 0x2f4f4f},
                                 {"darkslategrey", 0x2f4f4f},
                                 {"darkturquoise", 0x00ced1},
                                 {"darkviolet", 0x9400d3},
                                 {"deeppink", 0xff1493},
                                 {"deepskyblue", 0x00bfff},
                                 {"dimgray", 0x696969},
                                 {"dimgrey", 0x696969},
                                 {"dodgerblue", 0x1e90ff},
                                 {"firebrick", 0xb22222},
                                 {"floralwhite", 0xfffaf0},
                                 {"forestgreen", 0x228b22},
                                 {"fuchsia", 0xff00ff},
                                 {"gainsboro", 0xdcdcdc},
                                 {"ghostwhite", 0xf8f8ff},
                                 {"gold", 0xffd700},
                                 {"goldenrod", 0xdaa520},
                                 {"gray", 0x808080},
                                 {"green", 0x008000},
                                 {"greenyellow", 0xadff2f},
                                 {"grey", 0x808080},
                                 {"honeydew", 0xf0fff0},
                                 {"hotpink", 0xff69b4},
                                 {"indianred", 0xcd5c5c},
                                 {"indigo", 0x4b0082},
                                 {"ivory", 0xfffff0},
                                 {"khaki", 0xf0e68c},
                                 {"lavender", 0xe6e6fa},
                                 {"lavenderblush", 0xfff0f5},
                                 {"lawngreen", 0x7cfc00},
                                 {"lemonchiffon", 0xfffacd},
                                 {"lightblue", 0xadd8e6},
                                 {"lightcoral", 0xf08080},
                                 {"lightcyan", 0xe0ffff},
                                 {"lightgoldenrodyellow", 0xfafad2},
                                 {"lightgray", 0xd3d3d3},
                                 {"lightgreen", 0x90ee90},
                                 {"lightgrey", 0xd3d3d3},
                                 {"lightpink", 0xffb6c1},
                                 {"lightsalmon", 0xffa07a},
                                 {"lightseagreen", 0x20b2aa},
                                 {"lightskyblue", 0x87cefa},
                                 {"lightslategray", 0x778899},
                                 {"lightslategrey", 0x778899},
                                 {"lightsteelblue", 0xb0c4de},
                                 {"lightyellow", 0xffffe0},
                                 {"lime", 0x00ff00},
                                 {"limegreen", 0x32cd32},
                                 {"linen", 0xfaf0e6},
                                 {"magenta", 0xff00ff},
                                 {"maroon", 0x800000},
                                 {"mediumaquamarine", 0x66cdaa},
                                 {"mediumblue", 0x0000cd},
                                 {"mediumorchid", 0xba55d3},
                                 {"mediumpurple", 0x9370db},
                                 {"mediumseagreen", 0x3cb371},
                                 {"mediumslateblue", 0x7b68ee},
                                 {"mediumspringgreen", 0x00fa9a},
                                 {"mediumturquoise", 0x48d1cc},
                                 {"mediumvioletred", 0xc71585},
                                 {"midnightblue", 0x191970},
                                 {"mintcream", 0xf5fffa},
                                 {"mistyrose", 0xffe4e1},
                                 {"moccasin", 0xffe4b5},
                                 {"navajowhite", 0xffdead},
                                 {"navy", 0x000080},
                                 {"oldlace", 0xfdf5e6},
                                 {"olive", 0x808000},
                                 {"olivedrab", 0x6b8e23},
                                 {"orange", 0xffa500},
                                 {"orangered", 0xff4500},
                                 {"orchid", 0xda70d6},
                                 {"palegoldenrod", 0xeee8aa},
                                 {"palegreen", 0x98fb98},
                                 {"paleturquoise", 0xafeeee},
                                 {"palevioletred", 0xdb7093},
                                 {"papayawhip", 0xffefd5},
                                 {"peachpuff", 0xffdab9},
                                 {"peru", 0xcd853f},
                                 {"pink", 0xffc0cb},
                                 {"plum", 0xdda0dd},
                                 {"powderblue", 0xb0e0e6},
                                 {"purple", 0x800080},
                                 {"rebeccapurple", 0x663399},
                                 {"red", 0xff0000},
                                 {"rosybrown", 0xbc8f8f},
                                 {"royalblue", 0x4169e1},
                                 {"saddlebrown", 0x8b4513},
                                 {"salmon", 0xfa8072},
                                 {"sandybrown", 0xf4a460},
                                 {"seagreen", 0x2e8b57},
                                 {"seashell", 0xfff5ee},
                                 {"sienna", 0xa0522d},
                                 {"silver", 0xc0c0c0},
                                 {"skyblue", 0x87ceeb},
                                 {"slateblue", 0x6a5acd},
                                 {"slategray", 0x708090},
                                 {"slategrey", 0x708090},
                                 {"snow", 0xfffafa},
                                 {"springgreen", 0x00ff7f},
                                 {"steelblue", 0x4682b4},
                                 {"tan", 0xd2b48c},
                                 {"teal", 0x008080},
                                 {"thistle", 0xd8bfd8},
                                 {"tomato", 0xff6347},
                                 {"turquoise", 0x40e0d0},
                                 {"violet", 0xee82ee},
                                 {"wheat", 0xf5deb3},
                                 {"white", 0xffffff},
                                 {"whitesmoke", 0xf5f5f5},
                                 {"yellow", 0xffff00},
                                 {"yellowgreen", 0x9acd32}};

SvgColor fromNumber(std::uint32_t rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
          static_cast<std::uint8_t>(rgb)};
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> wordsOf(std::string text) {
  std::vector<std::string> words;
  std::istringstream stream(std::move(text));
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::optional<SvgPaint> fromHex(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  const bool short_form = digits.size() == 3 || digits.size() == 4;
  if (!short_form && digits.size() != 6 && digits.size() != 8) return std::nullopt;
  const bool has_alpha = digits.size() == 4 || digits.size() == 8;
  double alpha = 1.0;
  if (has_alpha) {
    const std::uint32_t most = short_form ? 15 : 255;
    alpha = static_cast<double>(value & most) / most;
    value >>= short_form ? 4 : 8;
  }
  if (alpha < kVisibleAlpha) return SvgPaint{};
  if (short_form) value = (value >> 8 & 15) * 0x110000 + (value >> 4 & 15) * 0x1100 + (value & 15) * 0x11;
  return SvgPaint{fromNumber(value), false, ""};
}

/// rgb(1, 2, 3), rgb(10% 20% 30% / 0.5) and the same with an a.
std::optional<SvgPaint> fromFunction(const std::string& text) {
  const auto open = text.find('(');
  const std::string name = text.substr(0, open);
  if (open == std::string::npos || text.back() != ')' || (name != "rgb" && name != "rgba"))
    return std::nullopt;
  std::string inside = text.substr(open + 1, text.size() - open - 2);
  std::replace_if(
      inside.begin(), inside.end(), [](char c) { return c == ',' || c == '/'; }, ' ');
  const auto words = wordsOf(inside);
  if (words.size() != 3 && words.size() != 4) return std::nullopt;
  SvgPaint paint;
  paint.color.emplace();
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto number = parseSvgLength(words[i]);
    if (!number || (!number->unit.empty() && number->unit != "%")) return std::nullopt;
    const double full = i == 3 ? 1.0 : 255.0;
    const double value =
        std::clamp(number->unit.empty() ? number->value : number->value / 100.0 * full, 0.0, full);
    if (i < 3) (*paint.color)[i] = static_cast<std::uint8_t>(std::lround(value));
    if (i == 3 && value < kVisibleAlpha) return SvgPaint{};
  }
  return paint;
}

bool isName(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  });
}

}  // namespace

std::string trimmedSvg(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::optional<SvgPaint> parseSvgPaint(std::string_view raw) {
  const std::string text = trimmedSvg(raw);
  const std::string small = lower(text);
  if (small == "none" || small == "transparent") return SvgPaint{};
  if (small == "currentcolor") return SvgPaint{std::nullopt, true, ""};
  if (small.starts_with("url(")) {
    const auto close = text.find(')');
    if (close == std::string::npos) return std::nullopt;
    std::string id = trimmedSvg(std::string_view(text).substr(4, close - 4));
    if (id.size() >= 2 && (id.front() == '"' || id.front() == '\'')) id = id.substr(1, id.size() - 2);
    SvgPaint paint;
    if (const std::string instead = trimmedSvg(std::string_view(text).substr(close + 1)); !instead.empty()) {
      const auto known = parseSvgPaint(instead);
      if (!known || !known->reference.empty()) return std::nullopt;
      paint = *known;
    }
    if (id.starts_with('#')) paint.reference = id.substr(1);
    return paint;
  }
  if (small.starts_with('#')) return fromHex(std::string_view(small).substr(1));
  if (const auto known = std::find_if(std::begin(kNames), std::end(kNames),
                                      [&](const NamedColor& color) { return color.name == small; });
      known != std::end(kNames)) {
    return SvgPaint{fromNumber(known->rgb), false, ""};
  }
  return small.empty() ? std::nullopt : fromFunction(small);
}

double SvgLength::units(double hundred_percent) const {
  if (unit == "%") return value / 100.0 * hundred_percent;
  static const std::map<std::string, double> kPixels{
      {"", 1.0},           {"px", 1.0},         {"in", 96.0},        {"cm", 96.0 / 2.54},
      {"mm", 96.0 / 25.4}, {"Q", 96.0 / 101.6}, {"pt", 96.0 / 72.0}, {"pc", 16.0}};
  return value * kPixels.at(unit);
}

std::optional<SvgLength> parseSvgLength(std::string_view raw) {
  std::string text = trimmedSvg(raw);
  if (text.starts_with('+')) text.erase(0, 1);
  const std::size_t digits = text.starts_with('-') ? 1 : 0;
  if (digits >= text.size() ||
      (std::isdigit(static_cast<unsigned char>(text[digits])) == 0 && text[digits] != '.')) {
    return std::nullopt;  // nan and inf are numbers to from_chars
  }
  SvgLength result;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.value);
  if (error != std::errc() || !(std::abs(result.value) <= kLargest)) return std::nullopt;
  result.unit = std::string(end, static_cast<std::size_t>(text.data() + text.size() - end));
  for (const char* known : {"", "px", "mm", "cm", "in", "pt", "pc", "Q", "%"}) {
    if (result.unit == known) return result;
  }
  return std::nullopt;
}

SvgDeclarations parseSvgDeclarations(std::string_view text) {
  SvgDeclarations result;
  while (!text.empty()) {
    const auto end = std::min(text.find(';'), text.size());
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto colon = one.find(':');
    if (colon == std::string_view::npos) continue;
    std::string value = trimmedSvg(one.substr(colon + 1));
    if (const auto important = value.find('!'); important != std::string::npos) {
      value = trimmedSvg(std::string_view(value).substr(0, important));
    }
    result[lower(trimmedSvg(one.substr(0, colon)))] = value;
  }
  return result;
}

int SvgStyleSheet::Rule::specificity() const {
  return (id.empty() ? 0 : 10'000) + 100 * static_cast<int>(std::min<std::size_t>(classes.size(), 99)) +
         (element.empty() ? 0 : 1);
}

std::vector<std::string> SvgStyleSheet::add(std::string_view css) {
  std::string text;
  for (std::size_t i = 0; i < css.size(); ++i) {
    if (css.compare(i, 2, "/*") == 0) {
      const auto end = css.find("*/", i + 2);
      if (end == std::string_view::npos) break;
      i = end + 1;
    } else {
      text.push_back(css[i]);
    }
  }
  std::vector<std::string> unknown;
  for (std::size_t at = 0; at < text.size();) {
    const auto open = text.find('{', at);
    const auto close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) break;
    const auto declarations = parseSvgDeclarations(std::string_view(text).substr(open + 1, close - open - 1));
    std::string selectors = text.substr(at, open - at) + ",";
    at = close + 1;
    for (auto comma = selectors.find(','); comma != std::string::npos; comma = selectors.find(',')) {
      const std::string selector = trimmedSvg(std::string_view(selectors).substr(0, comma));
      selectors.erase(0, comma + 1);
      Rule rule;
      rule.declarations = declarations;
      bool known = !selector.empty() && rules_.size() < kMaxRules;
      for (std::size_t begin = 0; known && begin < selector.size();) {
        const auto end = std::min(selector.find_first_of(".#", begin + 1), selector.size());
        const char kind = selector[begin];
        const bool marked = kind == '.' || kind == '#';
        const std::string name = selector.substr(begin + (marked ? 1 : 0), end - begin - (marked ? 1 : 0));
        known = isName(name) || (!marked && name == "*");
        if (kind == '.') {
          rule.classes.push_back(name);
        } else if (kind == '#') {
          rule.id = name;
        } else if (name != "*") {
          rule.element = name;
        }
        begin = end;
      }
      if (known) {
        rules_.push_back(std::move(rule));
      } else if (!selector.empty()) {
        unknown.push_back(selector);
      }
    }
  }
  return unknown;
}

SvgDeclarations SvgStyleSheet::match(std::string_view element, std::string_view id,
                                     std::string_view classes) const {
  const auto has = wordsOf(std::string(classes));
  std::vector<const Rule*> holding;
  for (const Rule& rule : rules_) {
    if (!rule.element.empty() && rule.element != element) continue;
    if (!rule.id.empty() && rule.id != id) continue;
    if (std::all_of(rule.classes.begin(), rule.classes.end(), [&](const std::string& name) {
          return std::find(has.begin(), has.end(), name) != has.end();
        })) {
      holding.push_back(&rule);
    }
  }
  std::stable_sort(holding.begin(), holding.end(),
                   [](const Rule* a, const Rule* b) { return a->specificity() < b->specificity(); });
  SvgDeclarations result;
  for (const Rule* rule : holding) {
    for (const auto& [name, value] : rule->declarations) result[name] = value;
  }
  return result;
}

}  // namespace vismem
