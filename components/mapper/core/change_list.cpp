#include "mapper/core/change_list.h"

#include <charconv>
#include <iomanip>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/config/text_format.h"
#include "common/kinematics/random_stream.h"
#include "mapper/core/record_text.h"

namespace vismem {
namespace {

const std::vector<std::pair<std::string, Decision>> kDecisions{
    {"open", Decision::kOpen}, {"accept", Decision::kAccept}, {"reject", Decision::kReject}};
const std::vector<std::pair<std::string, MapChange::Kind>> kKinds{{"moved", MapChange::Kind::kMoved},
                                                                  {"removed", MapChange::Kind::kRemoved},
                                                                  {"new", MapChange::Kind::kNew}};

/// The value of a word.
template <typename T>
T wordOf(LineFields& in, const char* field, const std::vector<std::pair<std::string, T>>& words) {
  const std::string text = in.word(field);
  for (const auto& [word, value] : words) {
    if (word == text) return value;
  }
  in.fail(std::string(field) + " = \"" + shown(text) +
          "\" (must be one of: " + joined(words, ", ", &std::pair<std::string, T>::first) + ")");
}

const std::string& wordFor(Decision decision) {
  for (const auto& [word, value] : kDecisions) {
    if (value == decision) return word;
  }
  return kDecisions.front().first;
}

/// Reads the lines of a list.
class ChangeListReader {
 public:
  void read(const std::string& kind, LineFields& in) {
    if (kind == "map") {
      list.map = in.integer("checksum", 0, std::numeric_limits<std::int64_t>::max());
    } else if (kind == "frame") {
      list.T_old_map = in.pose();
    } else if (kind == "change") {
      in.integer("number", static_cast<std::int64_t>(list.changes.size()) + 1,
                 static_cast<std::int64_t>(list.changes.size()) + 1);
      ListedChange listed;
      listed.decision = wordOf(in, "decision", kDecisions);
      listed.change.kind = wordOf(in, "kind", kKinds);
      listed.change.label = in.word("label");
      list.changes.push_back(std::move(listed));
    } else if (kind == "was" || kind == "now") {
      if (list.changes.empty()) in.fail("\"" + kind + "\" before the first change");
      MapChange& change = list.changes.back().change;
      if (change.kind == (kind == "was" ? MapChange::Kind::kNew : MapChange::Kind::kRemoved))
        in.fail("\"" + kind + "\" of a change that is " + nameOf(change.kind) + " (must be \"" +
                (kind == "was" ? "now" : "was") + "\")");
      (kind == "was" ? change.before : change.now).push_back(in.segment());
    } else if (kind == "added") {
      MapSegment row;
      row.label = in.word("label");
      const Segment2 floor = in.segment();
      row.world.a << floor.a, 0.0;
      row.world.b << floor.b, 0.0;
      list.added.push_back(std::move(row));
    } else if (kind == "gone" || kind == "came") {
      list.rejected.push_back(readFact(kind == "gone", in));
    } else {
      in.fail("\"" + shown(kind) + "\" (must be map, frame, change, was, now, added, gone or came)");
    }
    in.finish();
  }

  ChangeList list;
};

/// The numbers of "1,3"; empty for "all".
std::optional<std::set<std::size_t>> numbersOf(const std::string& text, const char* option,
                                               std::size_t changes) {
  std::set<std::size_t> numbers;
  if (text == "all") return std::nullopt;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    std::size_t number = 0;
    const auto end = std::from_chars(part.data(), part.data() + part.size(), number);
    if (end.ec != std::errc() || end.ptr != part.data() + part.size() || number == 0 || number > changes) {
      const std::string rule = changes == 0
                                   ? "nothing: the list has no changes"
                                   : "all, or numbers 1.." + std::to_string(changes) + " joined by ','";
      throw ConfigError(
          {std::string(option) + " " + shown(text) + ": \"" + shown(part) + "\" (must be " + rule + ")"});
    }
    numbers.insert(number);
  }
  return numbers;
}

}  // namespace

std::string lineOf(const MapChange& change) {
  std::ostringstream line;
  line << std::fixed << std::setprecision(2) << nameOf(change.kind) << " " << change.label;
  const auto place = [&](const char* word, const std::vector<Segment2>& edges) {
    if (!edges.empty()) line << " " << word << " " << placeOf(edges).x() << " " << placeOf(edges).y();
  };
  place("from", change.before);
  place("to", change.now);
  return line.str();
}

std::int64_t checksumOf(const SegmentMap& map) {
  std::uint64_t hash = fnv1a("");
  for (const MapSegment& row : map.segments) {
    const Segment3& at = row.world;
    hash = fnv1a(formatted("%.17g %.17g %.17g %.17g %.17g %.17g %.17g %s\n", at.a.x(), at.a.y(), at.a.z(),
                           at.b.x(), at.b.y(), at.b.z(), row.width_m, row.label.c_str()),
                 hash);
  }
  return static_cast<std::int64_t>(hash >> 1);
}

ChangeList changeListOf(const MapComparison& found, const Pose2& T_old_map, const SegmentMap& old) {
  ChangeList list{T_old_map, {}, found.added, found.rejected, checksumOf(old)};
  for (const MapChange& change : found.changes) list.changes.push_back({change});
  return list;
}

std::string writeChangeList(const ChangeList& list) {
  LineWriter out;
  out.word("changes").integer(1).end();
  out.comment("Write accept or reject in place of open, then run update_map.");
  if (list.map) out.word("map").integer(*list.map).end();
  out.word("frame").pose(list.T_old_map).end();
  std::int64_t number = 0;
  for (const ListedChange& listed : list.changes) {
    const MapChange& change = listed.change;
    out.comment(lineOf(change));
    out.word("change").integer(++number).word(wordFor(listed.decision));
    out.word(nameOf(change.kind)).word(change.label).end();
    for (const Segment2& edge : change.before) out.word("was").segment(edge).end();
    for (const Segment2& edge : change.now) out.word("now").segment(edge).end();
  }
  for (const MapSegment& row : list.added) out.word("added").word(row.label).segment(row.world.floor()).end();
  for (const ChangeFact& fact : list.rejected) writeFact(out, fact);
  return out.take();
}

ChangeList parseChangeList(std::string_view text, const std::string& file_name) {
  ChangeListReader reader;
  readRecord(text, file_name, "changes",
             [&](const std::string& kind, LineFields& in) { reader.read(kind, in); });
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < reader.list.changes.size(); ++i) {
    const MapChange& change = reader.list.changes[i].change;
    const std::string where =
        file_name + ": change " + std::to_string(i + 1) + " (" + nameOf(change.kind) + ") ";
    if (change.kind != MapChange::Kind::kNew && change.before.empty())
      problems.push_back(where + "has no line \"was\" (must be 1 or more)");
    if (change.kind != MapChange::Kind::kRemoved && change.now.empty())
      problems.push_back(where + "has no line \"now\" (must be 1 or more)");
  }
  if (!problems.empty()) throw ConfigError(problems);
  return std::move(reader.list);
}

void decide(ChangeList& list, const std::string& accept, const std::string& reject) {
  const auto accepted = numbersOf(accept, "--accept", list.changes.size());
  const auto rejected = numbersOf(reject, "--reject", list.changes.size());
  if (!accepted && !rejected) throw ConfigError({"--accept all and --reject all (must be one of both)"});
  for (std::size_t i = 0; i < list.changes.size(); ++i) {
    const std::size_t number = i + 1;
    const bool is_accepted = accepted && accepted->count(number) > 0;
    const bool is_rejected = rejected && rejected->count(number) > 0;
    if (is_accepted && is_rejected)
      throw ConfigError({"change " + std::to_string(number) + " (must be accepted or rejected, not both)"});
    Decision& decision = list.changes[i].decision;
    if (is_accepted)
      decision = Decision::kAccept;
    else if (is_rejected)
      decision = Decision::kReject;
    else if (decision == Decision::kOpen && !accepted)
      decision = Decision::kAccept;
    else if (decision == Decision::kOpen && !rejected)
      decision = Decision::kReject;
  }
}

}  // namespace vismem
