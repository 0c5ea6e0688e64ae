#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace frontlux::report::detail {

/// Numbers as bytes, in the order in which the page reads them (web/src/byte_reader.js).
class ByteWriter {
 public:
  void u8(std::uint8_t number) { bytes_ += static_cast<char>(number); }

  /// Seven bits a byte, the lowest first; the top bit says that there is more.
  void count(std::uint64_t number) {
    for (; number >= 0x80; number >>= 7U) u8(static_cast<std::uint8_t>((number & 0x7FU) | 0x80U));
    u8(static_cast<std::uint8_t>(number));
  }

  /// Small numbers of either sign take few bytes.
  void difference(std::int64_t number) {
    count((static_cast<std::uint64_t>(number) << 1U) ^ static_cast<std::uint64_t>(number >> 63));
  }

  /// Single precision, lowest byte first.
  void f32(double number) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(number));
    for (unsigned shift = 0; shift < 32; shift += 8) u8(static_cast<std::uint8_t>(bits >> shift));
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace frontlux::report::detail
