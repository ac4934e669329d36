#include "common/recording/bag_reader.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "common/recording/file_bytes.h"

namespace vismem {
namespace {

/// Unpacked chunks that are kept: neighbouring messages of several topics come from the same ones.
constexpr std::size_t kKeptChunks = 3;
/// The beginning of each message of a packed chunk is kept: topics are read one after another, and unpacking
/// everything for each would take minutes for a recording of a gigabyte.
constexpr std::size_t kKeptBegin = 1024;
constexpr std::size_t kKeptBegins = 128u << 20;
constexpr std::size_t kSearchPiece = 1u << 20;
/// What a chunk's header holds wherever its fields stand.
constexpr std::string_view kChunkMark("op=\x05", 4);
/// From the beginning of a chunk's header to that mark, at most.
constexpr std::size_t kMarkReach = 64;

std::string printable(ByteView bytes) {
  std::string text;
  for (const std::uint8_t c : bytes) {
    if (c != '\n') text += std::isprint(c) ? static_cast<char>(c) : '.';
  }
  return text;
}

}  // namespace

struct BagReader::Impl {
  /// A chunk of the file.
  struct Chunk {
    std::uint64_t pos = 0;  ///< of its record
    std::uint64_t data_pos = 0;
    std::uint32_t stored = 0;  ///< bytes in the file
    std::uint32_t size = 0;    ///< bytes unpacked
    BagCompression compression = BagCompression::kNone;
  };

  explicit Impl(const std::string& file) : name(file), bytes(file) {}

  std::string name;
  FileBytes bytes;
  std::vector<BagConnection> connections;
  std::map<std::uint32_t, std::size_t> by_id;  ///< the bag's number of a connection -> index
  std::vector<std::vector<BagEntry>> entries;
  std::vector<Chunk> chunks;
  std::set<BagCompression> compressions;
  BagDamage damage;
  std::vector<std::pair<std::uint32_t, Bytes>> kept;  ///< newest last

  /// Of a message in a packed chunk.
  struct Begin {
    Bytes bytes;         ///< at most kKeptBegin
    bool whole = false;  ///< these are all
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Begin> begins;  ///< by chunk and offset
  std::size_t begin_bytes = 0;

  [[noreturn]] void fail(const std::string& what) const { throw RecordingError(name + ": " + what); }
  void note(std::uint64_t pos, const std::string& what) {
    damage.notes.push_back(name + ": chunk at byte " + std::to_string(pos) + ": " + what);
  }

  void checkMagic();
  void clear();
  std::optional<std::size_t> addConnection(const RecordFields& header, ByteView data);
  /// @return empty with the reason in `why`.
  std::optional<Chunk> chunkOf(std::uint64_t pos, const FileRecord& record, std::string& why) const;

  bool readIndex();
  bool readChunkIndex(std::uint64_t pos);

  void scan();
  std::uint64_t scanChunk(std::uint64_t pos, const FileRecord& record);
  std::uint64_t scanUnclosedChunk(std::uint64_t pos, const FileRecord& record);
  /// @return how many messages were found before the first that is damaged, and where that is.
  std::pair<std::size_t, std::size_t> scanMessages(ByteView unpacked, std::uint32_t chunk);
  std::optional<std::uint64_t> nextChunk(std::uint64_t from) const;

  const Bytes& unpacked(std::uint32_t chunk);
  void keepBegins(std::uint32_t chunk, ByteView data);
};

void BagReader::Impl::checkMagic() {
  const Bytes begin = bytes.read(0, kBagMagic.size());
  if (std::string_view(reinterpret_cast<const char*>(begin.data()), begin.size()) == kBagMagic) return;
  fail("not a ROS 1 bag: begins with \"" +
       printable(ByteView(begin).first(std::min<std::size_t>(begin.size(), 12))) +
       "\" (expected \"#ROSBAG V2.0\")");
}

void BagReader::Impl::clear() {
  connections.clear();
  by_id.clear();
  entries.clear();
  chunks.clear();
  compressions.clear();
  damage = {};
}

std::optional<std::size_t> BagReader::Impl::addConnection(const RecordFields& header, ByteView data) {
  const auto id = header.u32("conn");
  const auto topic = header.text("topic");
  const auto details = RecordFields::parse(data);
  if (!id || !topic || topic->empty() || !details) return std::nullopt;
  if (const auto known = by_id.find(*id); known != by_id.end()) return known->second;
  connections.push_back({*topic, details->text("type").value_or(""), details->text("md5sum").value_or("")});
  entries.emplace_back();
  by_id.emplace(*id, connections.size() - 1);
  return connections.size() - 1;
}

std::optional<BagReader::Impl::Chunk> BagReader::Impl::chunkOf(std::uint64_t pos, const FileRecord& record,
                                                               std::string& why) const {
  const auto size = record.fields.u32("size");
  const auto name_of_compression = record.fields.text("compression");
  if (record.fields.op() != BagOp::kChunk || !size || !name_of_compression) {
    why = "its header is damaged";
    return std::nullopt;
  }
  const auto compression = bagCompressionFromName(*name_of_compression);
  if (!compression) {
    why = "compression \"" +
          printable({reinterpret_cast<const std::uint8_t*>(name_of_compression->data()),
                     name_of_compression->size()}) +
          "\" (expected none, bz2 or lz4)";
    return std::nullopt;
  }
  return Chunk{pos, record.data_pos, record.data_size, *size, *compression};
}

bool BagReader::Impl::readIndex() {
  const auto first = headerAt(bytes, kBagMagic.size());
  if (!first || first->fields.op() != BagOp::kFileHeader) return false;
  const auto index_pos = first->fields.u64("index_pos");
  const auto chunk_count = first->fields.u32("chunk_count");
  if (!index_pos || !chunk_count || *index_pos < first->end() || *index_pos > bytes.size()) return false;
  // What follows the index position is small: connections and one record a chunk.
  const std::uint64_t index_size = bytes.size() - *index_pos;
  if (index_size > kMaxChunkSize) return false;
  const Bytes index = bytes.read(*index_pos, static_cast<std::size_t>(index_size));
  std::set<std::uint64_t> positions;
  std::size_t at = 0;
  while (at < index.size()) {
    const auto record = readRecord(index, at);
    if (!record) return false;
    if (record->fields.op() == BagOp::kConnection) {
      if (!addConnection(record->fields, record->data)) return false;
    } else if (record->fields.op() == BagOp::kChunkInfo) {
      const auto pos = record->fields.u64("chunk_pos");
      if (!pos || *pos >= *index_pos || !positions.insert(*pos).second) return false;
    } else {
      return false;
    }
    at = record->end;
  }
  if (positions.size() != *chunk_count) return false;
  return std::all_of(positions.begin(), positions.end(),
                     [&](std::uint64_t pos) { return readChunkIndex(pos); });
}

bool BagReader::Impl::readChunkIndex(std::uint64_t pos) {
  const auto record = headerAt(bytes, pos);
  if (!record || record->end() > bytes.size()) return false;
  std::string why;
  const auto chunk = chunkOf(pos, *record, why);
  if (!chunk) {
    if (record->fields.op() != BagOp::kChunk || !record->fields.u32("size")) return false;
    ++damage.chunks_lost;
    note(pos, why + ": its messages are left out");
    return true;
  }
  if (chunk->compression == BagCompression::kNone && chunk->size != chunk->stored) return false;
  chunks.push_back(*chunk);
  compressions.insert(chunk->compression);
  const auto number = static_cast<std::uint32_t>(chunks.size() - 1);
  std::uint64_t at = record->end();
  for (auto next = headerAt(bytes, at); next && next->fields.op() == BagOp::kIndex;
       next = headerAt(bytes, at)) {
    const auto id = next->fields.u32("conn");
    const auto count = next->fields.u32("count");
    const auto connection = id ? by_id.find(*id) : by_id.end();
    if (!count || connection == by_id.end() || next->end() > bytes.size()) return false;
    const Bytes data = bytes.read(next->data_pos, next->data_size);
    if (data.size() / 12 < *count) return false;
    for (std::size_t i = 0; i < *count; ++i) {
      const std::uint8_t* item = data.data() + 12 * i;
      const std::int64_t time_ns =
          static_cast<std::int64_t>(readU32(item)) * 1'000'000'000 + readU32(item + 4);
      const std::uint32_t offset = readU32(item + 8);
      if (offset >= chunk->size) return false;
      entries[connection->second].push_back({time_ns, number, offset});
    }
    at = next->end();
  }
  return true;
}

std::pair<std::size_t, std::size_t> BagReader::Impl::scanMessages(ByteView data, std::uint32_t chunk) {
  std::size_t at = 0;
  std::size_t found = 0;
  while (at < data.size()) {
    const auto record = readRecord(data, at);
    if (!record) break;
    if (record->fields.op() == BagOp::kConnection) {
      if (!addConnection(record->fields, record->data)) break;
    } else if (record->fields.op() == BagOp::kMessage) {
      const auto id = record->fields.u32("conn");
      const auto time_ns = record->fields.timeNs("time");
      const auto connection = id ? by_id.find(*id) : by_id.end();
      if (!time_ns || connection == by_id.end()) break;
      entries[connection->second].push_back({*time_ns, chunk, static_cast<std::uint32_t>(at)});
      ++found;
    } else {
      break;
    }
    at = record->end;
  }
  return {found, at};
}

std::uint64_t BagReader::Impl::scanChunk(std::uint64_t pos, const FileRecord& record) {
  std::string why;
  auto chunk = chunkOf(pos, record, why);
  const bool cut_off = record.end() > bytes.size();
  const std::uint64_t end = std::min<std::uint64_t>(record.end(), bytes.size());
  if (!chunk) {
    ++damage.chunks_lost;
    note(pos, why + ": its messages are left out");
    return end;
  }
  // Of a chunk that is not compressed, whatever is whole can be used.
  const bool plain = chunk->compression == BagCompression::kNone;
  std::optional<Bytes> data;
  try {
    const Bytes stored = bytes.read(record.data_pos, static_cast<std::size_t>(end - record.data_pos));
    if (plain && stored.size() <= kMaxChunkSize) {
      data = stored;
    } else {
      data = unpack(chunk->compression, stored, chunk->size);
    }
  } catch (const RecordingError& error) {
    why = cut_off ? "the file ends inside it" : error.what();
  }
  if (!data) {
    ++damage.chunks_lost;
    damage.bytes_lost += end - pos;
    note(pos, why + ": its messages are left out");
    return end;
  }
  chunk->stored = static_cast<std::uint32_t>(end - record.data_pos);
  chunk->size = static_cast<std::uint32_t>(data->size());
  chunks.push_back(*chunk);
  compressions.insert(chunk->compression);
  const auto number = static_cast<std::uint32_t>(chunks.size() - 1);
  const auto [found, good] = scanMessages(*data, number);
  if (!plain) keepBegins(number, *data);
  if (good < data->size() || cut_off) {
    ++damage.chunks_lost;
    damage.bytes_lost += data->size() - good;
    note(pos, std::string(cut_off ? "the file ends inside it" : "it is damaged") + ": " +
                  std::to_string(found) + " messages are saved, " + std::to_string(data->size() - good) +
                  " bytes are left out");
  }
  return end;
}

/// rosbag writes a chunk's header with size 0 first and its messages behind; a recording that was cut off
/// then leaves them so.
std::uint64_t BagReader::Impl::scanUnclosedChunk(std::uint64_t pos, const FileRecord& record) {
  const std::uint64_t left = bytes.size() - record.data_pos;
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(left, kMaxChunkSize));
  const Bytes data = bytes.read(record.data_pos, size);
  chunks.push_back({pos, record.data_pos, static_cast<std::uint32_t>(data.size()),
                    static_cast<std::uint32_t>(data.size()), BagCompression::kNone});
  compressions.insert(BagCompression::kNone);
  const auto [found, good] = scanMessages(data, static_cast<std::uint32_t>(chunks.size() - 1));
  chunks.back().stored = chunks.back().size = static_cast<std::uint32_t>(good);
  ++damage.chunks_lost;
  note(pos, "it was never closed: " + std::to_string(found) + " messages are saved");
  return record.data_pos + good;
}

std::optional<std::uint64_t> BagReader::Impl::nextChunk(std::uint64_t from) const {
  for (std::uint64_t base = from; base < bytes.size();) {
    const Bytes piece = bytes.read(base, kSearchPiece + kChunkMark.size());
    if (piece.size() < kChunkMark.size()) return std::nullopt;
    const std::string_view text(reinterpret_cast<const char*>(piece.data()), piece.size());
    for (auto mark = text.find(kChunkMark); mark != std::string_view::npos;
         mark = text.find(kChunkMark, mark + 1)) {
      const std::uint64_t mark_pos = base + mark;
      const std::uint64_t first = mark_pos - std::min<std::uint64_t>(mark_pos - from, kMarkReach);
      for (std::uint64_t pos = first; pos + 8 <= mark_pos; ++pos) {
        const auto record = headerAt(bytes, pos);
        if (record && record->fields.op() == BagOp::kChunk && record->fields.u32("size") &&
            record->fields.text("compression") && record->data_pos > mark_pos) {
          return pos;
        }
      }
    }
    base += kSearchPiece;
  }
  return std::nullopt;
}

void BagReader::Impl::scan() {
  clear();
  damage.reindexed = true;
  const auto first = headerAt(bytes, kBagMagic.size());
  const bool good = first && first->fields.op() == BagOp::kFileHeader && first->end() <= bytes.size();
  std::uint64_t at = good ? first->end() : kBagMagic.size();
  while (at < bytes.size()) {
    const auto record = headerAt(bytes, at);
    const auto op = record ? record->fields.op() : std::nullopt;
    const bool whole = record && record->end() <= bytes.size();
    if (op == BagOp::kChunk && record->data_size == 0 && record->fields.u32("size") == 0u) {
      at = scanUnclosedChunk(at, *record);
    } else if (op == BagOp::kChunk) {
      at = scanChunk(at, *record);
    } else if (op == BagOp::kConnection && whole) {
      const Bytes data = bytes.read(record->data_pos, record->data_size);
      addConnection(record->fields, data);
      at = record->end();
    } else if ((op == BagOp::kIndex || op == BagOp::kChunkInfo) && whole) {
      at = record->end();
    } else {
      const std::uint64_t next = nextChunk(at + 1).value_or(bytes.size());
      damage.bytes_lost += next - at;
      damage.notes.push_back(name + ": " + std::to_string(next - at) + " bytes at byte " +
                             std::to_string(at) + " are no record of a bag: left out");
      at = next;
    }
  }
}

const Bytes& BagReader::Impl::unpacked(std::uint32_t chunk) {
  for (auto item = kept.rbegin(); item != kept.rend(); ++item) {
    if (item->first == chunk) return item->second;
  }
  const Chunk& where = chunks.at(chunk);
  try {
    kept.emplace_back(chunk, unpack(where.compression, bytes.read(where.data_pos, where.stored), where.size));
  } catch (const RecordingError& error) {
    fail("chunk at byte " + std::to_string(where.pos) + ": " + error.what());
  }
  if (kept.size() > kKeptChunks) kept.erase(kept.begin());
  keepBegins(chunk, kept.back().second);
  return kept.back().second;
}

void BagReader::Impl::keepBegins(std::uint32_t chunk, ByteView data) {
  std::size_t at = 0;
  for (auto record = readRecord(data, at); record && begin_bytes < kKeptBegins;
       record = readRecord(data, at)) {
    if (record->fields.op() == BagOp::kMessage) {
      const ByteView begin = record->data.first(std::min(record->data.size(), kKeptBegin));
      const auto [item, added] = begins.try_emplace({chunk, static_cast<std::uint32_t>(at)});
      if (added) {
        item->second = {{begin.begin(), begin.end()}, begin.size() == record->data.size()};
        begin_bytes += begin.size() + sizeof(Begin);
      }
    }
    at = record->end;
  }
}

BagReader::BagReader(const std::string& file) : impl_(std::make_unique<Impl>(file)) {
  impl_->checkMagic();
  if (!impl_->readIndex()) {
    impl_->scan();
    std::size_t messages = 0;
    for (const auto& list : impl_->entries) messages += list.size();
    if (messages == 0) {
      // A note begins with the name of the file, as does what fail() throws.
      const std::vector<std::string>& notes = impl_->damage.notes;
      const std::string why = notes.empty() ? "" : " (" + notes.front().substr(file.size() + 2) + ")";
      impl_->fail("its index is missing or damaged, and none of its " + std::to_string(impl_->bytes.size()) +
                  " bytes holds a message" + why);
    }
    impl_->damage.notes.insert(impl_->damage.notes.begin(),
                               file +
                                   ": the index is missing or damaged, as of a recording that was cut off: "
                                   "indexed again, " +
                                   std::to_string(messages) + " messages in " +
                                   std::to_string(impl_->chunks.size()) + " chunks");
  }
  for (auto& list : impl_->entries) {
    std::sort(list.begin(), list.end(), [](const BagEntry& a, const BagEntry& b) {
      return std::pair(a.chunk, a.offset) < std::pair(b.chunk, b.offset);
    });
  }
}

BagReader::~BagReader() = default;
BagReader::BagReader(BagReader&&) noexcept = default;
BagReader& BagReader::operator=(BagReader&&) noexcept = default;

const std::string& BagReader::file() const {
  return impl_->name;
}
std::uint64_t BagReader::fileSize() const {
  return impl_->bytes.size();
}
const std::vector<BagConnection>& BagReader::connections() const {
  return impl_->connections;
}
const std::vector<BagEntry>& BagReader::entries(std::size_t connection) const {
  return impl_->entries.at(connection);
}
std::size_t BagReader::chunks() const {
  return impl_->chunks.size();
}
const BagDamage& BagReader::damage() const {
  return impl_->damage;
}

std::vector<std::string> BagReader::compressions() const {
  std::vector<std::string> names;
  for (const BagCompression compression : impl_->compressions) names.emplace_back(nameOf(compression));
  return names;
}

Bytes BagReader::read(const BagEntry& entry, std::size_t at_most) {
  const Impl::Chunk& chunk = impl_->chunks.at(entry.chunk);
  const auto broken = [&]() {
    impl_->fail("chunk at byte " + std::to_string(chunk.pos) + ": the message at its byte " +
                std::to_string(entry.offset) + " is damaged");
  };
  if (chunk.compression == BagCompression::kNone) {
    const auto record = headerAt(impl_->bytes, chunk.data_pos + entry.offset);
    const std::uint64_t chunk_end = chunk.data_pos + chunk.size;
    if (!record || record->fields.op() != BagOp::kMessage || record->end() > chunk_end) broken();
    Bytes data = impl_->bytes.read(record->data_pos, std::min<std::size_t>(record->data_size, at_most));
    if (data.size() != std::min<std::size_t>(record->data_size, at_most)) broken();
    return data;
  }
  if (const auto begin = impl_->begins.find({entry.chunk, entry.offset}); begin != impl_->begins.end()) {
    const Bytes& bytes = begin->second.bytes;
    if (begin->second.whole || at_most <= bytes.size()) {
      const ByteView wanted = ByteView(bytes).first(std::min(bytes.size(), at_most));
      return {wanted.begin(), wanted.end()};
    }
  }
  const auto record = readRecord(impl_->unpacked(entry.chunk), entry.offset);
  if (!record || record->fields.op() != BagOp::kMessage) broken();
  const ByteView data = record->data.first(std::min(record->data.size(), at_most));
  return {data.begin(), data.end()};
}

}  // namespace vismem
