#include "mapper/core/map_history.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace vismem {
namespace {

constexpr double kSame_m = 6e-4;  // rows of files are in millimetres
constexpr std::int64_t kMostSeen = 1'000'000'000;

bool isSameSegment(const Segment2& one, const Segment2& other, double near_m) {
  const auto ends = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (one.a - a).norm() <= near_m && (one.b - b).norm() <= near_m;
  };
  return ends(other.a, other.b) || ends(other.b, other.a);
}

/// Reads the lines of a history.
class HistoryReader {
 public:
  void read(const std::string& kind, LineFields& in) {
    if (kind == "complete") {
      history.seen.is_complete = in.flag("complete");
    } else if (kind == "row") {
      readRow(in);
    } else if (kind == "gone" || kind == "came") {
      history.rejected.push_back(readFact(kind == "gone", in));
    } else if (kind == "session") {
      history.seen.sessions.emplace_back();
      camera_.reset();
    } else if (kind == "camera") {
      session(kind, in);
      camera_ = in.camera();
    } else if (kind == "view") {
      if (!camera_) in.fail("a view before the camera of its session");
      session(kind, in).views.push_back({*camera_, in.pose3("camera pose")});
    } else if (kind == "trace") {
      FloorTrace trace;
      trace.label = in.word("label");
      trace.sightings = static_cast<int>(in.integer("sightings", 0, kMostSeen));
      trace.floor = in.segment();
      session(kind, in).traces.push_back(std::move(trace));
    } else {
      in.fail("\"" + kind + "\" (must be complete, row, gone, came, session, camera, view or trace)");
    }
    in.finish();
  }

  MapHistory history;

 private:
  SeenFloor& session(const std::string& kind, const LineFields& in) {
    if (history.seen.sessions.empty()) in.fail("a " + kind + " before the first session");
    return history.seen.sessions.back();
  }
  void readRow(LineFields& in) {
    CountedRow row;
    row.row.label = in.word("label");
    row.row.width_m = in.number("width");
    row.times_seen = static_cast<int>(in.integer("times seen", 0, kMostSeen));
    row.sessions = static_cast<int>(in.integer("sessions", 0, kMostSeen));
    const Segment2 floor = in.segment();
    row.row.world.a << floor.a, 0.0;
    row.row.world.b << floor.b, 0.0;
    history.rows.push_back(std::move(row));
  }

  std::optional<CameraIntrinsics> camera_;
};

}  // namespace

void writeFact(LineWriter& out, const ChangeFact& fact) {
  out.word(fact.is_gone ? "gone" : "came").word(fact.label);
  for (const Segment2& edge : fact.edges) out.segment(edge);
  out.end();
}

ChangeFact readFact(bool is_gone, LineFields& in) {
  ChangeFact fact{is_gone, in.word("label"), {in.segment()}};
  while (in.hasMore()) fact.edges.push_back(in.segment());
  return fact;
}

std::string writeMapHistory(const MapHistory& history) {
  LineWriter out;
  out.word("history").integer(1).end();
  out.word("complete").integer(history.seen.is_complete).end();
  for (const CountedRow& row : history.rows) {
    out.word("row").word(row.row.label).number(row.row.width_m);
    out.integer(row.times_seen).integer(row.sessions).segment(row.row.world.floor()).end();
  }
  for (const ChangeFact& fact : history.rejected) writeFact(out, fact);
  for (const SeenFloor& session : history.seen.sessions) {
    out.word("session").end();
    const CameraIntrinsics* camera = nullptr;
    for (const SeenView& view : session.views) {
      if (!camera || *camera != view.intrinsics) out.word("camera").camera(view.intrinsics).end();
      camera = &view.intrinsics;
      out.word("view").pose(view.T_map_camera).end();
    }
    for (const FloorTrace& trace : session.traces)
      out.word("trace").word(trace.label).integer(trace.sightings).segment(trace.floor).end();
  }
  return out.take();
}

MapHistory parseMapHistory(std::string_view text, const std::string& file_name) {
  HistoryReader reader;
  readRecord(text, file_name, "history",
             [&](const std::string& kind, LineFields& in) { reader.read(kind, in); });
  return std::move(reader.history);
}

std::vector<CountedRow> countedRows(const SegmentMap& map, const MapHistory& history) {
  std::vector<CountedRow> rows;
  for (const MapSegment& row : map.segments) {
    CountedRow counted{row};
    for (const CountedRow& known : history.rows) {
      if (known.row.label != row.label || !isSameSegment(known.row.world.floor(), row.world.floor(), kSame_m))
        continue;
      counted.times_seen = known.times_seen;
      counted.sessions = known.sessions;
      break;
    }
    rows.push_back(std::move(counted));
  }
  return rows;
}

std::vector<CountedRow> expandStripes(const std::vector<CountedRow>& rows,
                                      const std::map<Label, Label>& stripe_edges) {
  std::vector<CountedRow> edges;
  for (const CountedRow& row : rows) {
    SegmentMap one;
    one.segments = {row.row};
    for (MapSegment& edge : expandStripes(one, stripe_edges).segments)
      edges.push_back({std::move(edge), row.times_seen, row.sessions});
  }
  return edges;
}

SeenFloor seenBy(const DriveRecord& record, const std::vector<Pose2>& poses,
                 const std::set<std::uint64_t>& overruled) {
  constexpr int kLeastSightings = 3;
  SeenFloor seen;
  for (std::size_t k = 0; k < poses.size() && k < record.keyframes.size(); ++k) {
    const Keyframe& keyframe = record.keyframes[k];
    seen.views.push_back({keyframe.intrinsics, toPose3(poses[k]) * keyframe.T_robot_camera});
  }
  for (const auto& [id, element] : record.elements) {
    const auto last = static_cast<std::size_t>(element.last_keyframe);
    if (overruled.contains(id)) continue;
    if (element.sightings >= kLeastSightings && last < poses.size())
      seen.traces.push_back({transform(poses[last], element.robot), element.label, element.sightings});
  }
  return seen;
}

SegmentMap transform(const Pose2& T, SegmentMap map) {
  for (MapSegment& row : map.segments) row.world = transform(T, row.world);
  return map;
}

MapHistory transform(const Pose2& T, MapHistory history) {
  for (SeenFloor& session : history.seen.sessions) session = transform(T, std::move(session));
  for (CountedRow& row : history.rows) row.row.world = transform(T, row.row.world);
  for (ChangeFact& fact : history.rejected) {
    for (Segment2& edge : fact.edges) edge = transform(T, edge);
  }
  return history;
}

}  // namespace vismem
