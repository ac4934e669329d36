#include "mapper/core/map_edits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

using Kind = MapEdit::Kind;

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all{
      {"delete", Kind::kDelete},         {"relabel", Kind::kRelabel}, {"join", Kind::kJoin},
      {"split", Kind::kSplit},           {"square", Kind::kSquare},   {"length", Kind::kLength},
      {"straighten", Kind::kStraighten}, {"move", Kind::kMove}};
  return all;
}

template <typename Number>
std::optional<Number> numberOf(const std::string& text) {
  Number value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Reads the words of one line.
class Line {
 public:
  Line(std::vector<std::string> words, std::string where)
      : words_(std::move(words)), where_(std::move(where)) {}

  MapEdit read() {
    MapEdit edit;
    edit.where = where_;
    const auto kind = kinds().find(words_.front());
    if (kind == kinds().end())
      fail("\"" + words_.front() +
           "\" (must be delete, relabel, join, split, straighten, "
           "square, length or move)");
    edit.kind = kind->second;
    edit.ids.push_back(id());
    switch (edit.kind) {
      case Kind::kDelete:
        break;
      case Kind::kRelabel:
        edit.label = word("a label");
        break;
      case Kind::kJoin:
      case Kind::kSquare:
        edit.ids.push_back(id());
        break;
      case Kind::kStraighten:
        do edit.ids.push_back(id());
        while (next_ < words_.size());
        break;
      case Kind::kLength:
        edit.from_m = metres("a length", 1e-3);
        break;
      case Kind::kSplit:
        edit.from_m = metres("the beginning of the stretch", 0.0);
        edit.to_m = metres("its end", edit.from_m);
        break;
      case Kind::kMove: {
        const std::string end = word("a or b");
        if (end != "a" && end != "b") fail("\"" + end + "\" (must be a or b)");
        edit.at_b = end == "b";
        edit.place.x() = metres("x", -kFarthest_m);
        edit.place.y() = metres("y", -kFarthest_m);
        break;
      }
    }
    if (next_ < words_.size()) fail("\"" + words_[next_] + "\" is one word too many");
    return edit;
  }

 private:
  static constexpr double kFarthest_m = 1e5;

  [[noreturn]] void fail(const std::string& what) const { throw ConfigError({where_ + ": " + what}); }
  std::string word(const char* what) {
    if (next_ >= words_.size()) fail(std::string("the line ends before ") + what);
    return words_[next_++];
  }
  std::uint64_t id() {
    const std::string text = word("the id of an edge");
    const auto value = numberOf<std::uint64_t>(text);
    if (!value || *value == 0) fail("\"" + text + "\" (must be the id of an edge)");
    return *value;
  }
  double metres(const char* what, double least) {
    const std::string text = word(what);
    const auto value = numberOf<double>(text);
    if (value && *value >= least && *value <= kFarthest_m) return *value;
    std::ostringstream rule;
    rule << "(must be " << what << " in metres, " << least << ".." << kFarthest_m << ")";
    fail("\"" + text + "\" " + rule.str());
  }

  std::vector<std::string> words_;
  std::string where_;
  std::size_t next_ = 1;
};

std::optional<std::size_t> indexOf(const MapState& state, std::uint64_t id) {
  const auto found = std::find_if(state.landmarks.begin(), state.landmarks.end(),
                                  [&](const LineLandmark& landmark) { return landmark.id == id; });
  if (found == state.landmarks.end()) return std::nullopt;
  return static_cast<std::size_t>(found - state.landmarks.begin());
}

/// Extends the first to both.
void join(MapState& state, std::size_t into, std::size_t other) {
  LineLandmark& kept = state.landmarks[into];
  const LineLandmark taken = state.landmarks[other];
  const Pose2 T = inverse(state.poses[static_cast<std::size_t>(kept.anchor)]) *
                  state.poses[static_cast<std::size_t>(taken.anchor)];
  const Segment2 moved = transform(T, taken.segment());
  const Eigen::Vector2d u = kept.along();
  const Eigen::Vector2d origin = kept.pointAt(0.0);
  const bool turned = u.dot(moved.b - moved.a) < 0.0;
  const LandmarkEnd a{u.dot((turned ? moved.b : moved.a) - origin), (turned ? taken.b : taken.a).closed};
  const LandmarkEnd b{u.dot((turned ? moved.a : moved.b) - origin), (turned ? taken.a : taken.b).closed};
  if (a.t_m < kept.a.t_m) kept.a = a;
  if (b.t_m > kept.b.t_m) kept.b = b;
  // Against its own direction its sightings would not fit.
  if (!turned) kept.seen.insert(kept.seen.end(), taken.seen.begin(), taken.seen.end());
  kept.recentre();
  state.landmarks.erase(state.landmarks.begin() + static_cast<std::ptrdiff_t>(other));
}

void split(MapState& state, std::size_t index, double from_m, double to_m) {
  const LineLandmark whole = state.landmarks[index];
  // A line that was cut before has pieces with the next ids.
  std::uint64_t id = whole.id;
  while (indexOf(state, id)) ++id;
  LineLandmark before = whole;
  before.b = {whole.a.t_m + from_m, true};
  LineLandmark behind = whole;
  behind.a = {whole.a.t_m + to_m, true};
  behind.id = id;
  state.landmarks.erase(state.landmarks.begin() + static_cast<std::ptrdiff_t>(index));
  for (LineLandmark* piece : {&before, &behind}) {
    if (piece->b.t_m <= piece->a.t_m) continue;
    piece->recentre();
    state.landmarks.push_back(*piece);
  }
}

/// Between the lines of two edges, 0..90.
double degreesBetween(const MapState& state, std::size_t one, std::size_t other) {
  const double turn = state.worldSegment(state.landmarks[one]).direction() -
                      state.worldSegment(state.landmarks[other]).direction();
  return radToDeg(std::atan2(std::abs(std::sin(turn)), std::abs(std::cos(turn))));
}

/// Edges that are not about in one line, or about at right angles, would pull the whole map out of shape.
bool fitsTogether(MapEdit::Kind kind, const MapState& state, std::size_t one, std::size_t other) {
  constexpr double kMostAsideDeg = 30.0;
  if (kind != Kind::kJoin && kind != Kind::kStraighten && kind != Kind::kSquare) return true;
  const double angle = degreesBetween(state, one, other);
  return kind == Kind::kSquare ? angle >= 90.0 - kMostAsideDeg : angle <= kMostAsideDeg;
}

/// A length in another unit, or of another edge, would pull the whole map out of shape. An end that was not
/// seen may lie further away.
bool fitsLength(const LineLandmark& edge, double length_m) {
  constexpr double kMostRatio = 1.5;
  const double seen_m = edge.segment().length();
  const bool may_go_on = !edge.a.closed || !edge.b.closed;
  return length_m >= seen_m / kMostRatio && (may_go_on || length_m <= seen_m * kMostRatio);
}

/// Why an edit cannot be made of these edges; empty: it can.
std::string obstacleTo(const MapEdit& edit, const MapState& state, const std::vector<std::size_t>& indices) {
  const auto is_chord = [&](std::size_t i) { return state.landmarks[i].isChord(); };
  if (edit.kind != Kind::kDelete && edit.kind != Kind::kRelabel &&
      std::any_of(indices.begin(), indices.end(), is_chord)) {
    return "chords of a circle can be deleted and relabelled only";
  }
  char text[160];
  for (std::size_t i = 1; i < indices.size(); ++i) {
    if (fitsTogether(edit.kind, state, indices[0], indices[i])) continue;
    std::snprintf(text, sizeof text,
                  "edges %llu and %llu are at %.0f degrees (must be within 30 of %s): they stay as they are",
                  static_cast<unsigned long long>(edit.ids[0]), static_cast<unsigned long long>(edit.ids[i]),
                  degreesBetween(state, indices[0], indices[i]),
                  edit.kind == Kind::kSquare ? "a right angle" : "one line");
    return text;
  }
  const double length_m = state.landmarks[indices[0]].segment().length();
  if (edit.kind == Kind::kSplit && edit.from_m >= length_m) {
    std::snprintf(text, sizeof text, "edge %llu is %.2f m long: it has no stretch from %.2f m on",
                  static_cast<unsigned long long>(edit.ids[0]), length_m, edit.from_m);
    return text;
  }
  if (edit.kind == Kind::kLength && !fitsLength(state.landmarks[indices[0]], edit.from_m)) {
    std::snprintf(
        text, sizeof text,
        "edge %llu is %.2f m long (must be within a factor of 1.5 of the measured %g m): it stays as it is",
        static_cast<unsigned long long>(edit.ids[0]), length_m, edit.from_m);
    return text;
  }
  return {};
}

}  // namespace

std::vector<MapEdit> parseMapEdits(std::string_view text, const std::string& file_name) {
  std::vector<MapEdit> edits;
  std::vector<std::string> problems;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty()) continue;
    try {
      edits.push_back(Line(std::move(words), file_name + ":" + std::to_string(number)).read());
    } catch (const ConfigError& error) {
      problems.emplace_back(error.what());
    }
  }
  if (!problems.empty()) throw ConfigError(problems);
  return edits;
}

std::vector<std::string> applyEdits(const std::vector<MapEdit>& edits, MapState& state) {
  std::vector<std::string> missing;
  for (const MapEdit& edit : edits) {
    std::vector<std::size_t> indices;
    for (const std::uint64_t id : edit.ids) {
      const auto index = indexOf(state, id);
      if (index) {
        indices.push_back(*index);
      } else {
        missing.push_back(edit.where + ": no edge " + std::to_string(id) +
                          " any more: the edit has no effect");
      }
    }
    if (indices.size() < edit.ids.size()) continue;
    if (const std::string obstacle = obstacleTo(edit, state, indices); !obstacle.empty()) {
      missing.push_back(edit.where + ": " + obstacle);
      continue;
    }
    const LineLandmark& first = state.landmarks[indices[0]];
    if (edit.kind == Kind::kDelete || edit.kind == Kind::kRelabel || edit.kind == Kind::kSplit)
      state.overruled.insert(first.elements.begin(), first.elements.end());
    switch (edit.kind) {
      case Kind::kDelete:
        state.landmarks.erase(state.landmarks.begin() + static_cast<std::ptrdiff_t>(indices[0]));
        break;
      case Kind::kRelabel:
        state.landmarks[indices[0]].label = edit.label;
        break;
      case Kind::kJoin:
        if (indices[0] != indices[1]) join(state, indices[0], indices[1]);
        break;
      case Kind::kSplit:
        split(state, indices[0], edit.from_m, edit.to_m);
        break;
      case Kind::kStraighten:
      case Kind::kSquare:
      case Kind::kLength:
      case Kind::kMove:
        break;
    }
  }
  return missing;
}

std::vector<LineConstraint> constraintsOf(const std::vector<MapEdit>& edits, const MapState& state) {
  std::vector<LineConstraint> constraints;
  for (const MapEdit& edit : edits) {
    const auto first = indexOf(state, edit.ids.front());
    if (!first || state.landmarks[*first].isChord()) continue;
    if (edit.kind == Kind::kLength && fitsLength(state.landmarks[*first], edit.from_m)) {
      constraints.push_back({LineConstraint::Kind::kLength, *first, *first, edit.from_m});
    }
    if (edit.kind != Kind::kSquare && edit.kind != Kind::kStraighten) continue;
    for (std::size_t i = 1; i < edit.ids.size(); ++i) {
      const auto other = indexOf(state, edit.ids[i]);
      if (!other || *other == *first || state.landmarks[*other].isChord()) continue;
      if (!fitsTogether(edit.kind, state, *first, *other)) continue;
      constraints.push_back(
          {edit.kind == Kind::kSquare ? LineConstraint::Kind::kSquare : LineConstraint::Kind::kStraight,
           *first, *other, 0.0});
    }
  }
  return constraints;
}

void applyMoves(const std::vector<MapEdit>& edits, std::vector<MappedRow>& rows) {
  for (const MapEdit& edit : edits) {
    if (edit.kind != Kind::kMove) continue;
    for (MappedRow& row : rows) {
      if (row.id != edit.ids.front() || row.derived) continue;
      (edit.at_b ? row.map.b : row.map.a) = edit.place;
      (edit.at_b ? row.closed_b : row.closed_a) = true;
      row.updateWorld();
    }
  }
}

}  // namespace vismem
