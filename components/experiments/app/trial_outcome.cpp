#include "experiments/app/trial_outcome.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "evaluation/app/cpu_stages.h"

namespace vismem {
namespace {

using nlohmann::json;

/// Length of a cycle. Updates within it only predict the pose; their time is added to its first update.
constexpr double kTick_s = 0.2;

/// JSON has no infinite numbers.
json packed(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0.0 ? "inf" : "-inf";
}
double unpacked(const json& value) {
  if (value.is_number()) return value.get<double>();
  const std::string word = value.get<std::string>();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  return word == "inf" ? infinity : -infinity;
}

json packed(const std::optional<double>& value) {
  return value ? packed(*value) : json(nullptr);
}
std::optional<double> unpackedOptional(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(unpacked(value));
}

json packed(const std::vector<double>& values) {
  json list = json::array();
  for (const double value : values) list.push_back(packed(value));
  return list;
}
std::vector<double> unpackedList(const json& list) {
  std::vector<double> values;
  for (const json& value : list) values.push_back(unpacked(value));
  return values;
}

/// The fields of an event in the order of its row.
json packed(const EventScore& event) {
  return {event.seed,
          event.event,
          packed(event.seconds),
          packed(event.settled_after_s),
          packed(event.position_error_m),
          packed(event.heading_error_rad),
          event.right_at_end,
          packed(event.true_alive),
          packed(event.inside_reported),
          packed(event.error_over_reported),
          packed(event.evidence_after_s)};
}
EventScore eventFrom(const json& row) {
  EventScore event;
  event.seed = row.at(0).get<std::uint64_t>();
  event.event = row.at(1).get<int>();
  event.seconds = unpacked(row.at(2));
  event.settled_after_s = unpackedOptional(row.at(3));
  event.position_error_m = unpackedOptional(row.at(4));
  event.heading_error_rad = unpackedOptional(row.at(5));
  event.right_at_end = row.at(6).get<bool>();
  event.true_alive = unpackedOptional(row.at(7));
  event.inside_reported = unpackedOptional(row.at(8));
  event.error_over_reported = unpackedOptional(row.at(9));
  event.evidence_after_s = unpackedOptional(row.at(10));
  return event;
}

json packed(const PublishedPose& pose) {
  json row{pose.stamp_us, packed(pose.reliability)};
  if (const auto& at = pose.T_world_robot) {
    for (const double value : {at->x, at->y, at->theta}) row.push_back(packed(value));
  }
  return row;
}
PublishedPose publishedFrom(const json& row) {
  PublishedPose pose{row.at(0).get<StampUs>(), std::nullopt, unpacked(row.at(1))};
  if (row.size() > 2) pose.T_world_robot = Pose2{unpacked(row[2]), unpacked(row.at(3)), unpacked(row.at(4))};
  return pose;
}

json packed(const MethodOutcome& outcome, bool with_path) {
  json events = json::array();
  for (const EventScore& event : outcome.events) events.push_back(packed(event));
  json all{{"method", outcome.method}, {"events", events}, {"cycle_ms", packed(outcome.cycle_ms)}};
  if (!with_path) return all;
  for (const PublishedPose& pose : outcome.poses) all["poses"].push_back(packed(pose));
  return all;
}
MethodOutcome methodFrom(const json& all) {
  MethodOutcome outcome;
  outcome.method = all.at("method").get<std::string>();
  for (const json& row : all.at("events")) outcome.events.push_back(eventFrom(row));
  outcome.cycle_ms = unpackedList(all.at("cycle_ms"));
  for (const json& row : all.value("poses", json::array())) outcome.poses.push_back(publishedFrom(row));
  return outcome;
}

json packed(const RecordOutcome& record, bool with_path) {
  json all{{"gaze_plan_ms", packed(record.gaze_plan_ms)},
           {"gaze_requests", record.gaze_requests},
           {"methods", json::array()}};
  for (const MethodOutcome& outcome : record.methods) all["methods"].push_back(packed(outcome, with_path));
  if (!with_path) return all;
  all["events_us"] = record.events_us;
  for (const auto& [stamp_us, pose] : record.truth) {
    all["truth"].push_back({stamp_us, packed(pose.x), packed(pose.y), packed(pose.theta)});
  }
  return all;
}
RecordOutcome recordFrom(const json& all) {
  RecordOutcome record;
  for (const json& one : all.at("methods")) record.methods.push_back(methodFrom(one));
  record.gaze_plan_ms = unpackedList(all.at("gaze_plan_ms"));
  record.gaze_requests = all.at("gaze_requests").get<int>();
  record.events_us = all.value("events_us", std::vector<StampUs>());
  for (const json& row : all.value("truth", json::array())) {
    record.truth.push_back(
        {row.at(0).get<StampUs>(), {unpacked(row.at(1)), unpacked(row.at(2)), unpacked(row.at(3))}});
  }
  return record;
}

}  // namespace

MethodOutcome runMethod(const MethodMaker& maker, const Trial& trial, const SegmentMap& map_edges,
                        bool is_start_known, const std::function<void()>& look) {
  MethodOutcome outcome;
  outcome.method = maker.name;
  const auto method = maker.make(map_edges, trial.seed);
  bool start_is_due = is_start_known;
  std::vector<PoseEstimate> estimates;
  std::optional<StampUs> last_tick_us;
  for (std::size_t i = 0; i < trial.updates.size(); ++i) {
    if (look) look();
    const MemoryUpdate& update = trial.updates[i];
    const double before_s = CpuStages::now_s();
    estimates.push_back(method->step(update));
    const double spent_s = CpuStages::now_s() - before_s;
    const StampUs stamp_us = update.snapshot->stamp_us;
    if (!last_tick_us || stamp_us >= *last_tick_us + toStampUs(kTick_s)) {
      outcome.cycle_ms.push_back(0.0);
      last_tick_us = stamp_us;
    }
    outcome.cycle_ms.back() += 1e3 * spent_s;
    if (!start_is_due) continue;
    const auto truth = poseAt(trial.truth, stamp_us);
    if (!truth) continue;
    method->setPose(*truth);
    start_is_due = false;
  }
  outcome.events = scoreEvents(trial, estimates);
  for (const PoseEstimate& estimate : estimates) {
    outcome.poses.push_back({estimate.stamp_us, estimate.T_world_robot, estimate.reliability});
  }
  return outcome;
}

void noteEvidence(const std::vector<std::optional<double>>& evidence_after_s, MethodOutcome& outcome) {
  for (std::size_t i = 0; i < evidence_after_s.size() && i < outcome.events.size(); ++i) {
    outcome.events[i].evidence_after_s = evidence_after_s[i];
  }
}

json toJson(const TrialOutcome& outcome, bool with_path) {
  json all{{"seed", outcome.seed}, {"whole", outcome.is_whole}, {"records", json::array()}};
  for (const RecordOutcome& record : outcome.records) all["records"].push_back(packed(record, with_path));
  return all;
}

TrialOutcome trialOutcomeFrom(const json& all) {
  TrialOutcome outcome;
  outcome.seed = all.at("seed").get<std::uint64_t>();
  outcome.is_whole = all.at("whole").get<bool>();
  for (const json& record : all.at("records")) outcome.records.push_back(recordFrom(record));
  return outcome;
}

}  // namespace vismem
