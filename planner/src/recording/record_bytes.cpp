#include "recording/record_bytes.hpp"

#include <frontlux/file.hpp>

namespace frontlux::planner::detail {

void RecordBytes::end() const {
  if (!left_.empty()) throw BadRecord(std::to_string(left_.size()) + " bytes too many");
}

void RecordBytes::refuse(const std::string& what) const {
  const std::string message = part_.empty() ? what : part_ + ": " + what;
  if (reading_) throw BadRecord(message);
  throw std::invalid_argument("recording: " + message);
}

std::string RecordBytes::out_of_range(const char* name, std::uint64_t value, std::uint64_t max) {
  return std::string(name) + " is " + std::to_string(value) + ", but has to be 0 to " + std::to_string(max);
}

std::string_view RecordBytes::take(std::size_t size) {
  require(size <= left_.size(), "ends too early");
  const std::string_view taken = left_.substr(0, size);
  left_.remove_prefix(size);
  return taken;
}

void RecordBytes::varint(std::uint64_t& value) {
  if (!reading_) {
    std::uint64_t left = value;
    for (; left >= 0x80; left >>= 7U) written_ += static_cast<char>(0x80U | (left & 0x7FU));
    written_ += static_cast<char>(left);
    return;
  }
  value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<unsigned char>(take(1)[0]);
    const std::uint64_t bits = byte & 0x7FU;
    if (shift == 63 && bits > 1) break;
    value |= bits << shift;
    if ((byte & 0x80U) == 0) {
      require(byte != 0 || shift == 0, "a whole number has more bytes than it needs");
      return;
    }
  }
  refuse("a whole number has more than 64 bits");
}

// 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
void RecordBytes::difference(std::uint16_t& value, int& last) {
  const int by = value - last;
  auto number = static_cast<std::uint64_t>(by < 0 ? -2 * by - 1 : 2 * by);
  varint(number);
  if (reading_) {
    require(number <= 0x1'FFFF, "a voxel lies outside the key range");
    const int half = static_cast<int>(number >> 1U), next = last + ((number & 1U) != 0 ? -half - 1 : half);
    require(next >= 0 && next <= 0xFFFF, "a voxel lies outside the key range");
    value = static_cast<std::uint16_t>(next);
  }
  last = value;
}

char RecordBytes::byte_of(double number, unsigned shift) {
  static_assert(sizeof number == sizeof(std::uint64_t) && std::numeric_limits<double>::is_iec559);
  return static_cast<char>((std::bit_cast<std::uint64_t>(number) >> shift) & 0xFFU);
}

void RecordBytes::number(double& value) {
  if (!reading_) {
    append_number(written_, std::bit_cast<std::uint64_t>(value));
    return;
  }
  value = from_bytes<double>(take(8).data(), std::endian::little);
}

void RecordBytes::text(std::string& text) {
  std::uint64_t size = text.size();
  varint(size);
  if (!reading_) {
    written_ += text;
    return;
  }
  require(size <= left_.size(), "a text is longer than what is there");
  text = take(static_cast<std::size_t>(size));
}

}  // namespace frontlux::planner::detail
