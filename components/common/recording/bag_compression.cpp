#include "common/recording/bag_compression.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

namespace vismem {
namespace {

/// Both grow their result as it comes out: a damaged size must not be allocated.
constexpr std::size_t kPiece = 1u << 18;
/// roslz4's blocks of 1 MiB, as rosbag uses them.
constexpr int kBlockSizeId = 6;
constexpr std::size_t kBlockSize = 1u << 20;

[[noreturn]] void damaged(const char* kind, const std::string& what) {
  throw RecordingError(std::string(kind) + " data are damaged: " + what);
}

void grow(Bytes& out, ByteView piece, std::size_t size, const char* kind) {
  if (piece.size() > size - out.size()) {
    damaged(kind, "more than the " + std::to_string(size) + " bytes that the chunk says");
  }
  out.insert(out.end(), piece.begin(), piece.end());
}

Bytes unpackBz2(ByteView packed, std::size_t size) {
  struct End {
    void operator()(bz_stream* stream) const { BZ2_bzDecompressEnd(stream); }
  };
  bz_stream state{};
  if (BZ2_bzDecompressInit(&state, 0, 0) != BZ_OK) throw RecordingError("bz2: out of memory");
  const std::unique_ptr<bz_stream, End> end(&state);
  state.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  state.avail_in = static_cast<unsigned>(packed.size());
  Bytes out;
  Bytes piece(kPiece);
  while (true) {
    state.next_out = reinterpret_cast<char*>(piece.data());
    state.avail_out = static_cast<unsigned>(piece.size());
    const int code = BZ2_bzDecompress(&state);
    const std::size_t made = piece.size() - state.avail_out;
    grow(out, ByteView(piece).first(made), size, "bz2");
    if (code == BZ_STREAM_END) break;
    if (code != BZ_OK) damaged("bz2", "error " + std::to_string(code));
    if (made == 0 && state.avail_in == 0) damaged("bz2", "they end too early");
  }
  return out;
}

Bytes unpackLz4(ByteView packed, std::size_t size) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) {
    throw RecordingError("lz4: out of memory");
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(raw,
                                                                             LZ4F_freeDecompressionContext);
  Bytes out;
  Bytes piece(kPiece);
  std::size_t at = 0;
  while (true) {
    std::size_t made = piece.size();
    std::size_t used = packed.size() - at;
    const std::size_t rest =
        LZ4F_decompress(context.get(), piece.data(), &made, packed.data() + at, &used, nullptr);
    if (LZ4F_isError(rest)) damaged("lz4", LZ4F_getErrorName(rest));
    grow(out, ByteView(piece).first(made), size, "lz4");
    at += used;
    if (rest == 0) break;
    if (used == 0 && made == 0) damaged("lz4", "they end too early");
  }
  return out;
}

Bytes packLz4(ByteView bytes) {
  Bytes out(bytes.size() + 8 * (bytes.size() / kBlockSize + 1) + 1024);
  auto size = static_cast<unsigned>(out.size());
  // The library's interface is not const, its input is.
  const int code = roslz4_buffToBuffCompress(const_cast<char*>(reinterpret_cast<const char*>(bytes.data())),
                                             static_cast<unsigned>(bytes.size()),
                                             reinterpret_cast<char*>(out.data()), &size, kBlockSizeId);
  if (code != ROSLZ4_OK) throw RecordingError("lz4: cannot compress: error " + std::to_string(code));
  out.resize(size);
  return out;
}

}  // namespace

const char* nameOf(BagCompression compression) {
  switch (compression) {
    case BagCompression::kBz2:
      return "bz2";
    case BagCompression::kLz4:
      return "lz4";
    case BagCompression::kNone:
      break;
  }
  return "none";
}

std::optional<BagCompression> bagCompressionFromName(const std::string& name) {
  for (const auto compression : {BagCompression::kNone, BagCompression::kBz2, BagCompression::kLz4}) {
    if (name == nameOf(compression)) return compression;
  }
  return std::nullopt;
}

Bytes unpack(BagCompression compression, ByteView packed, std::size_t size) {
  if (size > kMaxChunkSize || packed.size() > kMaxChunkSize) {
    throw RecordingError("it has " + std::to_string(std::max(size, packed.size())) +
                         " bytes (expected at most " + std::to_string(kMaxChunkSize) + ")");
  }
  Bytes out;
  switch (compression) {
    case BagCompression::kNone:
      out.assign(packed.begin(), packed.end());
      break;
    case BagCompression::kBz2:
      out = unpackBz2(packed, size);
      break;
    case BagCompression::kLz4:
      out = unpackLz4(packed, size);
      break;
  }
  if (out.size() != size) {
    throw RecordingError("it unpacks to " + std::to_string(out.size()) + " bytes (expected " +
                         std::to_string(size) + ")");
  }
  return out;
}

Bytes pack(BagCompression compression, ByteView bytes) {
  if (compression == BagCompression::kLz4) return packLz4(bytes);
  if (compression != BagCompression::kNone) throw RecordingError("bz2 is not written (use none or lz4)");
  return {bytes.begin(), bytes.end()};
}

}  // namespace vismem
