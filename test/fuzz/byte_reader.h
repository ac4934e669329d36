/// @file Values out of a fuzzer's bytes. After the last byte everything is zero.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vismem {

class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), end_(data + size) {}

  std::uint8_t byte() { return data_ < end_ ? *data_++ : 0; }
  /// In [low, high], from two bytes.
  int integer(int low, int high) {
    const int value = byte() << 8 | byte();
    return low + value % (high - low + 1);
  }
  /// In [low, high], in 65536 steps.
  double real(double low, double high) { return low + (high - low) * integer(0, 65535) / 65535.0; }
  bool coin() { return (byte() & 1) != 0; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - data_); }

 private:
  const std::uint8_t* data_;
  const std::uint8_t* end_;
};

}  // namespace vismem
