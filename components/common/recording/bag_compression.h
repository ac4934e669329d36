/// @file Compression of a bag's chunks: none, bz2 and lz4 as ROS writes them. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/recording/bag_format.h"

namespace vismem {

enum class BagCompression { kNone, kBz2, kLz4 };

/// "none", "bz2", "lz4": what stands in the bag.
const char* nameOf(BagCompression compression);
std::optional<BagCompression> bagCompressionFromName(const std::string& name);

/// @param size of the unpacked bytes, as the bag says.
/// @throws RecordingError when the bytes are damaged, have another size, or more than kMaxChunkSize.
Bytes unpack(BagCompression compression, ByteView packed, std::size_t size);

/// kNone and kLz4 only: bz2 is read, not written, because it takes a core for a camera at 30 Hz.
Bytes pack(BagCompression compression, ByteView bytes);

}  // namespace vismem
