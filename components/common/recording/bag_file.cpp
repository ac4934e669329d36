#include "common/recording/bag_file.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/config/config_error.h"
#include "common/recording/bag_reader.h"
#include "common/recording/ros_types.h"

namespace vismem {
namespace {

/// Holds the header of an image with names of usual length; the rest is read where it does not.
constexpr std::size_t kImageBegin = 512;

/// tf2 names have no leading slash, those of the first tf may.
std::string frameName(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

RosHeader completed(const RosHeader& header, std::int64_t recorded_ns) {
  return {header.stamp_us == 0 ? toStampOfTime(recorded_ns) : header.stamp_us, frameName(header.frame_id)};
}

BagImageHeader headerOf(const RosCompressedImage& message, std::int64_t recorded_ns) {
  return {completed(message.header, recorded_ns), message.format, /*compressed=*/true};
}

BagImageHeader headerOf(const RosImage& message, std::int64_t recorded_ns) {
  // A side that is no int is absurd, and said to be so where sizes are checked.
  return {completed(message.header, recorded_ns), message.encoding, /*compressed=*/false,
          static_cast<int>(std::min<std::uint32_t>(message.width, 1u << 30)),
          static_cast<int>(std::min<std::uint32_t>(message.height, 1u << 30))};
}

}  // namespace

struct BagFile::Impl {
  struct Place {
    std::size_t reader = 0;
    BagEntry entry;
  };

  std::string file;
  std::vector<BagReader> readers;
  std::vector<BagTopic> topics;
  std::map<std::string, std::vector<Place>> places;  ///< by topic, in order of recording
  std::map<std::string, std::vector<Place>> images;  ///< those whose headers could be read
  std::vector<std::string> notes;
  std::set<std::string> noted;
  std::int64_t begin_us = 0;
  std::int64_t end_us = 0;

  [[noreturn]] void fail(const std::string& topic, const std::string& what) const {
    throw RecordingError(file + ": topic " + topic + ": " + what);
  }
  void note(const std::string& text) {
    if (noted.insert(text).second) notes.push_back(text);
  }

  void open(const std::vector<std::string>& files);
  void addTopics(std::size_t reader);

  const BagTopic& topicOf(const std::string& name) const {
    for (const BagTopic& topic : topics) {
      if (topic.name == name) return topic;
    }
    throw RecordingError(file + ": no topic " + name);
  }

  Bytes read(const Place& place, std::size_t at_most = SIZE_MAX) {
    return readers[place.reader].read(place.entry, at_most);
  }

  /// @param read gives the value of one message; what it throws leaves that message out.
  template <typename Read>
  void forEach(const std::string& topic, const std::string& type, Read read_one) {
    if (topicOf(topic).type != type)
      fail(topic, "has type " + topicOf(topic).type + " (expected " + type + ")");
    const std::vector<Place>& list = places[topic];
    std::size_t left_out = 0;
    std::string why;
    for (const Place& place : list) {
      try {
        read_one(place);
      } catch (const RecordingError& error) {
        ++left_out;
        why = error.what();
      }
    }
    if (left_out > 0 && left_out == list.size()) fail(topic, "none of its messages can be read: " + why);
    if (left_out > 0) {
      note(file + ": topic " + topic + ": " + std::to_string(left_out) + " of " +
           std::to_string(list.size()) + " messages are damaged and left out (" + why + ")");
    }
  }

  template <typename Message>
  std::vector<Message> messages(const std::string& topic, const std::string& type,
                                Message (*parse)(ByteView)) {
    std::vector<Message> all;
    forEach(topic, type, [&](const Place& place) {
      Message message = parse(read(place));
      message.header = completed(message.header, place.entry.time_ns);
      all.push_back(std::move(message));
    });
    return all;
  }
};

void BagFile::Impl::open(const std::vector<std::string>& files) {
  if (files.empty()) throw RecordingError("no recording is named (expected a ROS 1 bag)");
  for (const std::string& name : files) readers.emplace_back(name);
  const auto beginOf = [](const BagReader& reader) {
    std::int64_t begin = INT64_MAX;
    for (std::size_t i = 0; i < reader.connections().size(); ++i) {
      for (const BagEntry& entry : reader.entries(i)) begin = std::min(begin, entry.time_ns);
    }
    return begin;
  };
  std::vector<std::pair<std::int64_t, std::size_t>> order;
  for (std::size_t i = 0; i < readers.size(); ++i) order.emplace_back(beginOf(readers[i]), i);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<BagReader> sorted;
  for (const auto& [begin, index] : order) sorted.push_back(std::move(readers[index]));
  readers = std::move(sorted);
  file = readers.front().file();
  if (readers.size() > 1) file += " and " + std::to_string(readers.size() - 1) + " more";
  for (std::size_t i = 0; i < readers.size(); ++i) {
    for (const std::string& text : readers[i].damage().notes) note(text);
    addTopics(i);
  }
  std::sort(topics.begin(), topics.end(),
            [](const BagTopic& a, const BagTopic& b) { return a.name < b.name; });
}

void BagFile::Impl::addTopics(std::size_t reader) {
  std::set<std::string> touched;
  for (std::size_t i = 0; i < readers[reader].connections().size(); ++i) {
    const BagConnection& connection = readers[reader].connections()[i];
    auto topic = std::find_if(topics.begin(), topics.end(),
                              [&](const BagTopic& t) { return t.name == connection.topic; });
    if (topic == topics.end()) {
      topics.push_back({connection.topic, connection.type, 0});
      topic = std::prev(topics.end());
    } else if (topic->type != connection.type) {
      note(readers[reader].file() + ": topic " + connection.topic + ": has messages of the types " +
           topic->type + " and " + connection.type + ": the latter are left out");
      continue;
    }
    const RosType* known = findRosType(connection.type);
    if (known != nullptr && !connection.md5.empty() && connection.md5 != "*" &&
        connection.md5 != known->md5) {
      throw RecordingError(readers[reader].file() + ": topic " + connection.topic + ": " + connection.type +
                           " with checksum " + connection.md5 + " (expected " + known->name +
                           " with checksum " + known->md5 + ")");
    }
    const auto& entries = readers[reader].entries(i);
    topic->messages += entries.size();
    touched.insert(connection.topic);
    for (const BagEntry& entry : entries) {
      const std::int64_t stamp_us = toStampOfTime(entry.time_ns);
      begin_us = end_us == 0 && begin_us == 0 ? stamp_us : std::min(begin_us, stamp_us);
      end_us = std::max(end_us, stamp_us);
      places[connection.topic].push_back({reader, entry});
    }
  }
  // Several connections of a topic, each in the order of the file.
  for (const std::string& topic : touched) {
    std::stable_sort(places[topic].begin(), places[topic].end(), [](const Place& a, const Place& b) {
      return std::tuple(a.reader, a.entry.chunk, a.entry.offset) <
             std::tuple(b.reader, b.entry.chunk, b.entry.offset);
    });
  }
}

BagFile::BagFile(const std::string& file) : BagFile(std::vector<std::string>{file}) {}

BagFile::BagFile(const std::vector<std::string>& files) : impl_(std::make_unique<Impl>()) {
  impl_->open(files);
}

BagFile::~BagFile() = default;
BagFile::BagFile(BagFile&&) noexcept = default;
BagFile& BagFile::operator=(BagFile&&) noexcept = default;

const std::string& BagFile::file() const {
  return impl_->file;
}
const std::vector<BagTopic>& BagFile::topics() const {
  return impl_->topics;
}
const std::vector<std::string>& BagFile::notes() const {
  return impl_->notes;
}
std::int64_t BagFile::beginUs() const {
  return impl_->begin_us;
}
std::int64_t BagFile::endUs() const {
  return impl_->end_us;
}

std::uint64_t BagFile::bytes() const {
  std::uint64_t sum = 0;
  for (const BagReader& reader : impl_->readers) sum += reader.fileSize();
  return sum;
}

std::vector<std::string> BagFile::compressions() const {
  std::set<std::string> names;
  for (const BagReader& reader : impl_->readers) {
    for (const std::string& name : reader.compressions()) names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::vector<BagImageHeader> BagFile::imageHeaders(const std::string& topic) {
  const std::string type = impl_->topicOf(topic).type;
  if (type != kRawImageType && type != kCompressedImageType) {
    impl_->fail(topic, "has type " + type + " (expected images)");
  }
  const auto headerIn = [&](const Bytes& bytes, std::int64_t recorded_ns) {
    return type == kCompressedImageType ? headerOf(parseCompressedImageHeader(bytes), recorded_ns)
                                        : headerOf(parseImageHeader(bytes), recorded_ns);
  };
  std::vector<BagImageHeader> headers;
  std::vector<Impl::Place> found;
  impl_->forEach(topic, type, [&](const Impl::Place& place) {
    const Bytes begin = impl_->read(place, kImageBegin);
    try {
      headers.push_back(headerIn(begin, place.entry.time_ns));
    } catch (const RecordingError&) {
      if (begin.size() < kImageBegin) throw;
      headers.push_back(headerIn(impl_->read(place), place.entry.time_ns));
    }
    found.push_back(place);
  });
  impl_->images.insert_or_assign(topic, std::move(found));
  return headers;
}

BagImage BagFile::readImage(const std::string& topic, std::size_t index) {
  const Impl::Place& place = impl_->images.at(topic).at(index);
  try {
    const Bytes bytes = impl_->read(place);
    BagImage image;
    if (impl_->topicOf(topic).type == kCompressedImageType) {
      RosCompressedImage message = parseCompressedImage(bytes);
      image.header = headerOf(message, place.entry.time_ns);
      image.data = std::move(message.data);
    } else {
      RosImage message = parseImage(bytes);
      image.header = headerOf(message, place.entry.time_ns);
      image.step = message.step;
      image.data = std::move(message.data);
    }
    return image;
  } catch (const RecordingError& error) {
    impl_->fail(topic, "image " + std::to_string(index) + " cannot be read: " + error.what());
  }
}

std::vector<RosCameraInfo> BagFile::cameraInfos(const std::string& topic) {
  return impl_->messages(topic, kCameraInfoType, parseCameraInfo);
}

std::vector<RosOdometry> BagFile::odometry(const std::string& topic) {
  auto samples = impl_->messages(topic, kOdometryType, parseOdometry);
  for (RosOdometry& sample : samples) sample.child_frame_id = frameName(sample.child_frame_id);
  return samples;
}

std::vector<RosJointState> BagFile::joints(const std::string& topic) {
  return impl_->messages(topic, kJointStateType, parseJointState);
}

std::vector<RosPoseWithCovariance> BagFile::poses(const std::string& topic) {
  const std::string& type = impl_->topicOf(topic).type;
  if (type == kPlainPoseType) return impl_->messages(topic, type, parsePose);
  if (type != kOdometryType) return impl_->messages(topic, kPoseType, parsePoseWithCovariance);
  std::vector<RosPoseWithCovariance> poses;
  for (const RosOdometry& sample : odometry(topic))
    poses.push_back({sample.header, sample.pose, sample.pose_covariance});
  return poses;
}

std::vector<std::string> BagFile::strings(const std::string& topic) {
  std::vector<std::string> texts;
  impl_->forEach(topic, kStringType,
                 [&](const Impl::Place& place) { texts.push_back(parseString(impl_->read(place))); });
  return texts;
}

std::vector<BagTransform> BagFile::transforms() {
  std::vector<BagTransform> transforms;
  for (const BagTopic& topic : impl_->topics) {
    if (topic.type != kTransformType && topic.type != kOldTransformType) continue;
    const bool is_static = topic.name.find("tf_static") != std::string::npos;
    impl_->forEach(topic.name, topic.type, [&](const Impl::Place& place) {
      for (const RosTransform& item : parseTransforms(impl_->read(place))) {
        transforms.push_back(
            {{completed(item.header, place.entry.time_ns), frameName(item.child_frame_id), item.pose},
             is_static});
      }
    });
  }
  return transforms;
}

std::vector<std::string> bagsOf(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    const auto some = bagsOf(path);
    files.insert(files.end(), some.begin(), some.end());
  }
  return files;
}

std::vector<std::string> bagsOf(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::size_t comma = path.find(',');
  if (comma != std::string::npos && !fs::exists(path, error)) {
    return bagsOf(std::vector{path.substr(0, comma), path.substr(comma + 1)});
  }
  std::vector<std::string> files;
  if (!fs::exists(path, error)) throw ConfigError({path + ": no such file or folder (must be a ROS 1 bag)"});
  if (!fs::is_directory(path, error)) return {path};
  for (const auto& item : fs::directory_iterator(path, error)) {
    const std::string name = item.path().filename().string();
    if (name.ends_with(".bag") || name.ends_with(".bag.active")) files.push_back(item.path().string());
  }
  if (files.empty()) throw ConfigError({path + ": a folder without a recording (must hold NAME.bag)"});
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace vismem
