#include "common/recording/bag_encoder.h"

#include <algorithm>

#include "common/recording/ros_types.h"

namespace vismem {
namespace {

/// ROS takes the time 0 for "none": its readers pass over messages recorded then.
constexpr std::int64_t kFirstTimeNs = 1;

void appendMessage(Bytes& out, std::uint32_t connection, std::int64_t time_ns, ByteView message) {
  RecordHeader header(BagOp::kMessage);
  header.u32("conn", connection).timeNs("time", time_ns);
  appendRecord(out, header, message);
}

}  // namespace

BagEncoder::BagEncoder(ByteSink& sink, BagCompression compression) : sink_(sink), compression_(compression) {
  Bytes begin(kBagMagic.begin(), kBagMagic.end());
  const Bytes header = fileHeader(0);
  begin.insert(begin.end(), header.begin(), header.end());
  sink_.write(begin);
  written_ = begin.size();
}

/// @param index_pos 0 while there is no index.
Bytes BagEncoder::fileHeader(std::uint64_t index_pos) const {
  RecordHeader header(BagOp::kFileHeader);
  header.u64("index_pos", index_pos)
      .u32("conn_count", static_cast<std::uint32_t>(index_pos == 0 ? 0 : connection_records_.size()))
      .u32("chunk_count", static_cast<std::uint32_t>(index_pos == 0 ? 0 : chunks_.size()));
  const Bytes padding(kFileHeaderSize - header.bytes().size(), ' ');
  Bytes out;
  appendRecord(out, header, padding);
  return out;
}

std::uint32_t BagEncoder::connect(const BagChannel& channel) {
  if (const auto known = connections_.find(channel); known != connections_.end()) return known->second;
  const RosType* type = findRosType(channel.type);
  if (type == nullptr) throw RecordingError("topic " + channel.topic + ": unknown type " + channel.type);
  const auto number = static_cast<std::uint32_t>(connection_records_.size());
  RecordHeader header(BagOp::kConnection);
  header.u32("conn", number).text("topic", channel.topic);
  RecordHeader details;
  details.text("topic", channel.topic)
      .text("type", type->name)
      .text("md5sum", type->md5)
      .text("message_definition", type->definition);
  Bytes record;
  appendRecord(record, header, details.bytes());
  connection_records_.push_back(std::move(record));
  in_file_.push_back(false);
  connections_.emplace(channel, number);
  return number;
}

void BagEncoder::add(const BagChannel& channel, std::int64_t stamp_us, ByteView message) {
  const std::uint32_t connection = connect(channel);
  if (!in_file_[connection] && !items_.contains(connection)) {
    const Bytes& record = connection_records_[connection];
    chunk_.insert(chunk_.end(), record.begin(), record.end());
  }
  const std::int64_t time_ns = std::max(toTimeNs(stamp_us), kFirstTimeNs);
  items_[connection].push_back({time_ns, static_cast<std::uint32_t>(chunk_.size())});
  appendMessage(chunk_, connection, time_ns, message);
  if (!open_since_us_) open_since_us_ = stamp_us;
}

BagEncoder::ChunkInfo BagEncoder::appendChunk(Bytes& out) const {
  ChunkInfo info;
  info.pos = written_;
  RecordHeader header(BagOp::kChunk);
  header.text("compression", nameOf(compression_)).u32("size", static_cast<std::uint32_t>(chunk_.size()));
  if (compression_ == BagCompression::kNone) {
    appendRecord(out, header, chunk_);
  } else {
    appendRecord(out, header, pack(compression_, chunk_));
  }
  bool first = true;
  for (const auto& [connection, items] : items_) {
    std::vector<Item> sorted = items;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Item& a, const Item& b) { return a.time_ns < b.time_ns; });
    Bytes data;
    data.reserve(12 * sorted.size());
    for (const Item& item : sorted) {
      appendTime(data, item.time_ns);
      appendU32(data, item.offset);
    }
    RecordHeader index(BagOp::kIndex);
    index.u32("ver", 1).u32("conn", connection).u32("count", static_cast<std::uint32_t>(sorted.size()));
    appendRecord(out, index, data);
    info.first_ns = first ? sorted.front().time_ns : std::min(info.first_ns, sorted.front().time_ns);
    info.last_ns = first ? sorted.back().time_ns : std::max(info.last_ns, sorted.back().time_ns);
    info.counts[connection] = static_cast<std::uint32_t>(sorted.size());
    first = false;
  }
  return info;
}

void BagEncoder::forgetChunk() {
  chunk_.clear();
  items_.clear();
  open_since_us_.reset();
}

void BagEncoder::closeChunk() {
  if (items_.empty()) return;
  Bytes out;
  out.reserve(chunk_.size() + 4096);
  ChunkInfo info = appendChunk(out);
  try {
    sink_.write(out);
    sink_.sync();
  } catch (const RecordingError&) {
    // What a full disk took of the chunk would only be in the way of the index.
    forgetChunk();
    sink_.truncate(written_);
    throw;
  }
  written_ += out.size();
  for (const auto& [connection, count] : info.counts) {
    in_file_[connection] = true;
    messages_written_ += count;
  }
  chunks_.push_back(std::move(info));
  forgetChunk();
}

void BagEncoder::finish() {
  closeChunk();
  Bytes out;
  for (const Bytes& record : connection_records_) out.insert(out.end(), record.begin(), record.end());
  for (const ChunkInfo& chunk : chunks_) {
    RecordHeader header(BagOp::kChunkInfo);
    header.u32("ver", 1)
        .u64("chunk_pos", chunk.pos)
        .timeNs("start_time", chunk.first_ns)
        .timeNs("end_time", chunk.last_ns)
        .u32("count", static_cast<std::uint32_t>(chunk.counts.size()));
    Bytes data;
    for (const auto& [connection, count] : chunk.counts) {
      appendU32(data, connection);
      appendU32(data, count);
    }
    appendRecord(out, header, data);
  }
  sink_.write(out);
  sink_.overwrite(kBagMagic.size(), fileHeader(written_));
  sink_.sync();
  written_ += out.size();
}

}  // namespace vismem
