#include "simulator/core/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/config/config_error.h"
#include "common/config/nearest_name.h"
#include "common/config/text_fields.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "simulator/core/props.h"
#include "simulator/core/scene.h"

namespace vismem {
namespace {

constexpr double kLongest_s = 1e6;
constexpr double kFarthest_m = 10'000.0;

using Kind = ScenarioEvent::Kind;

/// The settings KEY=VALUE of one line. A problem is recorded and a valid value returned, so that all problems
/// are found.
class LineReader {
 public:
  LineReader(std::string where, std::vector<std::string>& problems)
      : where_(std::move(where)), problems_(problems) {}

  void problem(const std::string& what) { problems_.push_back(where_ + what); }

  void take(const std::vector<std::string_view>& settings) {
    for (const auto setting : settings) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string_view::npos || equals == 0) {
        problem("\"" + std::string(setting) + "\" (must be KEY=VALUE)");
      } else if (!values_.emplace(setting.substr(0, equals), setting.substr(equals + 1)).second) {
        problem("\"" + std::string(setting) + "\" (its key stands there twice)");
      }
    }
  }

  std::string word(const std::string& key, const std::string& fallback,
                   const std::set<std::string>& choices) {
    const auto value = find(key);
    if (!value) return fallback;
    if (choices.contains(*value)) return *value;
    problem(key + "=" + *value + " (must be one of " + joined(choices, ", ") + ")");
    return fallback;
  }

  std::vector<double> numbers(const std::string& key, const std::vector<double>& fallback, std::size_t least,
                              double low, double high) {
    const auto value = find(key);
    if (!value) return fallback;
    std::vector<double> result;
    bool good = true;
    for (const auto part : splitAt(*value, ',')) {
      const auto number = finiteNumber(part);
      good = good && number && *number >= low && *number <= high;
      result.push_back(number.value_or(0.0));
    }
    if (good && result.size() >= least && result.size() <= fallback.size()) {
      result.insert(result.end(), fallback.begin() + static_cast<std::ptrdiff_t>(result.size()),
                    fallback.end());
      return result;
    }
    problem(key + "=" + *value + " (must be " +
            (least == fallback.size() ? std::to_string(least)
                                      : std::to_string(least) + " or " + std::to_string(fallback.size())) +
            (least == 1 && fallback.size() == 1 ? " number " : " numbers joined by ',' ") + range(low, high) +
            ")");
    return fallback;
  }
  double number(const std::string& key, double fallback, double low, double high) {
    return numbers(key, {fallback}, 1, low, high)[0];
  }

  std::vector<Eigen::Vector2d> points(const std::string& key) {
    std::vector<Eigen::Vector2d> result;
    const auto value = find(key);
    if (!value) {
      problem("no " + key + " (expected " + key + "=x,y;x,y...)");
      return result;
    }
    for (const auto part : splitAt(*value, ';')) {
      const auto xy = splitAt(part, ',');
      const auto x = finiteNumber(xy[0]);
      const auto y = xy.size() == 2 ? finiteNumber(xy[1]) : std::nullopt;
      if (!x || !y || std::abs(*x) > kFarthest_m || std::abs(*y) > kFarthest_m) {
        problem(key + ": \"" + std::string(part) + "\" (must be x,y, each " +
                range(-kFarthest_m, kFarthest_m) + "; points are joined by ';')");
        return {};
      }
      result.emplace_back(*x, *y);
    }
    return result;
  }

  bool has(const std::string& key) { return find(key).has_value(); }

  /// To be called last: settings that were not read are problems.
  void finish() {
    for (const auto& [key, value] : values_) {
      if (known_.contains(key)) continue;
      problem("unknown key \"" + key + "\"" + suggestion(key, known_));
    }
  }

 private:
  std::optional<std::string> find(const std::string& key) {
    known_.insert(key);
    const auto found = values_.find(key);
    if (found == values_.end()) return std::nullopt;
    return found->second;
  }
  static std::string range(double low, double high) {
    const auto text = [](double v) {
      std::string digits = std::to_string(v);
      digits.erase(digits.find_last_not_of('0') + 1);
      if (digits.back() == '.') digits.pop_back();
      return digits;
    };
    return text(low) + ".." + text(high);
  }

  std::string where_;
  std::vector<std::string>& problems_;
  std::map<std::string, std::string> values_;
  std::set<std::string> known_;
};

PropShape readShape(LineReader& line) {
  PropShape shape;
  const std::string kind = line.word("shape", "box", {"box", "cylinder", "robot"});
  if (kind == "cylinder") shape.kind = PropShape::Kind::kCylinder;
  if (kind == "robot") {
    shape.kind = PropShape::Kind::kRobot;
    shape.size_m = {0.44, 0.44, 1.0};
  }
  const Eigen::Vector3d& s = shape.size_m;
  const Eigen::Vector3d& c = shape.color;
  const auto size = line.numbers("size_m", {s.x(), s.y(), s.z()}, 3, -kFarthest_m, kFarthest_m);
  const auto color = line.numbers("color", {c.x(), c.y(), c.z()}, 3, 0.0, 1.0);
  shape.size_m = {size[0], size[1], size[2]};
  shape.color = {color[0], color[1], color[2]};
  if (const auto problem = checkProp(shape); !problem.empty()) line.problem(problem);
  return shape;
}

Way readWay(LineReader& line, double speed_mps, const std::set<std::string>& ways) {
  Way way;
  const std::string kind = line.word("way", "open", ways);
  way.closed = kind == "closed";
  way.at_end = kind == "once" ? WayEnd::kStand : WayEnd::kBack;
  way.speed_mps = line.number("speed_mps", speed_mps, 0.01, 10.0);
  way.points = line.points("points_m");
  if (!way.points.empty()) {
    if (const auto problem = checkWay(way); !problem.empty()) line.problem(problem);
  }
  return way;
}

void readPlace(LineReader& line, ScenarioEvent& event) {
  const bool robot = event.kind == Kind::kKidnap;
  if (!line.has("at_m"))
    line.problem(robot ? "no at_m (expected at_m=x,y)" : "no at_m (expected at_m=x,y or x,y,z)");
  const auto at = robot ? line.numbers("at_m", {0.0, 0.0}, 2, -kFarthest_m, kFarthest_m)
                        : line.numbers("at_m", {0.0, 0.0, 0.0}, 2, -kFarthest_m, kFarthest_m);
  const double heading = degToRad(line.number("heading_deg", 0.0, -360.0, 360.0));
  event.T_world_robot = {at[0], at[1], wrapAngle(heading)};
  if (robot) return;
  if (line.has("heading_deg") && line.has("rotation_deg"))
    line.problem("heading_deg and rotation_deg (only one of them can be)");
  const auto turn = line.numbers("rotation_deg", {0.0, 0.0, radToDeg(heading)}, 3, -360.0, 360.0);
  event.T_world_model =
      poseFromXyzRpy(at[0], at[1], at[2], degToRad(turn[0]), degToRad(turn[1]), degToRad(turn[2]));
}

/// The settings of an event after its words.
void readEvent(LineReader& line, ScenarioEvent& event) {
  switch (event.kind) {
    case Kind::kPlace:
    case Kind::kKidnap:
      readPlace(line, event);
      break;
    case Kind::kWalk:
      event.way = readWay(line, 0.4, {"closed", "once", "open"});
      break;
    case Kind::kDrive:
      event.way = readWay(line, 0.3, {"closed", "open"});
      break;
    case Kind::kSlip:
      event.slip = {line.number("left_m", 0.0, -1.0, 1.0), line.number("right_m", 0.0, -1.0, 1.0)};
      break;
    case Kind::kRemove:
    case Kind::kStand:
    case Kind::kHalt:
      break;
  }
}

struct Verb {
  Kind kind;
  bool of_model;
};
const std::map<std::string, Verb>& verbs() {
  static const std::map<std::string, Verb> kVerbs{
      {"place", {Kind::kPlace, true}},  {"remove", {Kind::kRemove, true}},  {"walk", {Kind::kWalk, true}},
      {"stand", {Kind::kStand, true}},  {"kidnap", {Kind::kKidnap, false}}, {"slip", {Kind::kSlip, false}},
      {"drive", {Kind::kDrive, false}}, {"halt", {Kind::kHalt, false}}};
  return kVerbs;
}

}  // namespace

Scenario parseScenario(std::string_view text, const std::string& file_name) {
  Scenario scenario;
  scenario.name = file_name;
  std::vector<std::string> problems;
  bool headed = false;
  int number = 0;
  for (const auto raw : splitAt(text, '\n')) {
    ++number;
    const auto content = contentOf(raw);
    if (content.empty()) continue;
    const std::string where = file_name + ":" + std::to_string(number) + ": ";
    const std::string found = "\"" + std::string(content) + "\"";
    auto parts = words(content);
    LineReader line(where, problems);
    if (!headed) {
      headed = true;
      if (content != "scenario 1") line.problem(found + " (the first line must be: scenario 1)");
      if (content.starts_with("scenario")) continue;
    }
    if (parts[0] == "object" && parts.size() >= 2) {
      const std::string name(parts[1]);
      parts.erase(parts.begin(), parts.begin() + 2);
      line.take(parts);
      if (!scenario.objects.emplace(name, readShape(line)).second) {
        line.problem("object \"" + name + "\" (was declared before)");
      }
      line.finish();
      continue;
    }
    const auto at = parts[0] == "at" && parts.size() >= 3 ? finiteNumber(parts[1]) : std::nullopt;
    if (!at || *at < 0.0 || *at > kLongest_s) {
      line.problem(found + " (must be: object NAME ..., or: at SECONDS VERB ..., with 0 to 1000000 seconds)");
      continue;
    }
    const std::string verb(parts[2]);
    const auto known = verbs().find(verb);
    if (known == verbs().end()) {
      std::set<std::string> names;
      for (const auto& [name, unused] : verbs()) names.insert(name);
      line.problem("unknown verb \"" + verb + "\"" + suggestion(verb, names));
      continue;
    }
    ScenarioEvent event;
    event.kind = known->second.kind;
    event.line = number;
    event.at_s = *at;
    std::size_t used = 3;
    if (known->second.of_model) {
      if (parts.size() < 4 || parts[3].find('=') != std::string_view::npos) {
        line.problem(found + " (must be: at SECONDS " + verb + " NAME ...)");
        continue;
      }
      event.model = parts[3];
      used = 4;
    }
    parts.erase(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(used));
    line.take(parts);
    readEvent(line, event);
    line.finish();
    scenario.events.push_back(std::move(event));
  }
  if (!headed) problems.push_back(file_name + ": empty (the first line must be: scenario 1)");
  if (!problems.empty()) throw ConfigError(std::move(problems));
  std::stable_sort(scenario.events.begin(), scenario.events.end(),
                   [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  return scenario;
}

std::vector<std::string> unknownModels(const Scenario& scenario, const std::set<std::string>& models) {
  std::set<std::string> known = models;
  for (const auto& [name, shape] : scenario.objects) known.insert(name);
  std::vector<std::string> problems;
  for (const auto& event : scenario.events) {
    if (event.model.empty() || known.contains(event.model)) continue;
    problems.push_back(scenario.name + ":" + std::to_string(event.line) + ": no object \"" + event.model +
                       "\" here and no model of that name in the world" + suggestion(event.model, known));
  }
  return problems;
}

}  // namespace vismem
