#include "common/recording/log_topics.h"

#include <algorithm>
#include <optional>

#include "common/config/text_format.h"
#include "common/recording/recorded_rows.h"

namespace vismem {

std::string truthTopic(const BagFile& bag, const std::string& named) {
  for (const BagTopic& topic : bag.topics()) {
    if (named.empty() || topic.name != named) continue;
    if (isPoseType(topic.type)) return named;
    throw RecordingError(bag.file() + ": topic " + named + ": has type " + topic.type + " (expected " +
                         kPoseType + ", " + kPlainPoseType + " or " + kOdometryType + ")");
  }
  if (!named.empty()) {
    std::string known;
    for (const BagTopic& topic : bag.topics()) {
      if (isPoseType(topic.type)) known += (known.empty() ? "" : ", ") + topic.name;
    }
    throw RecordingError(bag.file() + ": topic " + named + ": is not in the bag, whose poses are " +
                         (known.empty() ? "none" : known));
  }
  for (const char* usual : {"/ground_truth/pose", "/ground_truth"}) {
    for (const BagTopic& topic : bag.topics()) {
      if (topic.name == usual && isPoseType(topic.type) && topic.messages > 0) return usual;
    }
  }
  return {};
}

std::vector<TruePose> readTruth(BagFile& bag, const std::string& named) {
  std::vector<TruePose> truth;
  const std::string topic = truthTopic(bag, named);
  if (topic.empty()) return truth;
  for (const RosPoseWithCovariance& recorded : bag.poses(topic)) {
    const std::optional<Pose3> pose = toPose3(recorded.pose);
    if (pose && pose->matrix().allFinite()) truth.push_back({recorded.header.stamp_us, toPose2(*pose)});
  }
  std::stable_sort(truth.begin(), truth.end(),
                   [](const TruePose& a, const TruePose& b) { return a.stamp_us < b.stamp_us; });
  return truth;
}

std::string coverageNote(const std::string& what, StampUs begin_us, StampUs end_us,
                         const std::vector<StampUs>& images) {
  if (images.front() >= begin_us - kClockBackUs && images.back() <= end_us + kClockBackUs) return {};
  const auto outside = std::count_if(images.begin(), images.end(), [&](StampUs stamp_us) {
    return stamp_us < begin_us || stamp_us > end_us;
  });
  return formatted("%d of %zu images cannot be used: %s at %.3f..%.3f s, images at %.3f..%.3f s",
                   static_cast<int>(outside), images.size(), what.c_str(), toSeconds(begin_us),
                   toSeconds(end_us), toSeconds(images.front()), toSeconds(images.back()));
}

std::vector<OdometryTopic> odometryTopics(BagFile& bag, const std::string& truth_topic) {
  std::vector<OdometryTopic> topics;
  for (const BagTopic& topic : bag.topics()) {
    if (topic.type != kOdometryType || topic.messages == 0 || topic.name == truth_topic) continue;
    const auto samples = bag.odometry(topic.name);
    if (!samples.empty())
      topics.push_back({topic.name, samples.front().header.frame_id, samples.front().child_frame_id});
  }
  return topics;
}

std::string chooseOdometry(const std::vector<OdometryTopic>& topics, const std::string& odom_frame) {
  if (topics.size() == 1) return topics.front().name;
  const std::string wanted = odom_frame.empty() ? "odom" : odom_frame;
  const auto fits = [&](const OdometryTopic& topic) { return topic.parent == wanted; };
  if (std::count_if(topics.begin(), topics.end(), fits) != 1) return {};
  return std::find_if(topics.begin(), topics.end(), fits)->name;
}

std::string textOf(const std::vector<OdometryTopic>& topics) {
  return joined(topics, ", ", &OdometryTopic::text);
}

}  // namespace vismem
