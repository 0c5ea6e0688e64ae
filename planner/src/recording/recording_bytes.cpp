#include "recording/recording_bytes.hpp"

#include <bit>
#include <limits>

namespace frontlux::planner::detail {
namespace {

std::string in_part(const std::string& part, const std::string& what) {
  return part.empty() ? what : part + ": " + what;
}

std::string out_of_range(const char* name, std::uint64_t value, int max) {
  return std::string(name) + " is " + std::to_string(value) + ", but 0 to " + std::to_string(max) +
         " is possible";
}

}  // namespace

void RecordWriter::count(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7U) bytes_ += static_cast<char>(0x80U | (value & 0x7FU));
  bytes_ += static_cast<char>(value);
}

char RecordWriter::byte_of(double number, int byte) {
  return static_cast<char>((std::bit_cast<std::uint64_t>(number) >> static_cast<unsigned>(8 * byte)) & 0xFFU);
}

void RecordWriter::number(double value) {
  for (int byte = 0; byte < 8; ++byte) bytes_ += byte_of(value, byte);
}

void RecordWriter::text(const std::string& text) {
  count(text.size());
  bytes_ += text;
}

void RecordWriter::small(int value, int max, const char* name) {
  if (value < 0 || value > max)
    refuse(std::string(name) + " is " + std::to_string(value) + ", but 0 to " + std::to_string(max) +
           " is possible");
  count(static_cast<std::uint64_t>(value));
}

void RecordWriter::key(const VoxelKey& key) {
  for (const std::uint16_t k : {key.x, key.y, key.z}) count(k);
}

void RecordWriter::refuse(const std::string& what) const {
  throw std::invalid_argument("recording: " + in_part(part_, what));
}

void RecordReader::refuse(const std::string& what) const { throw BadRecord(in_part(part_, what)); }

void RecordReader::end() const {
  if (!left_.empty()) throw BadRecord(std::to_string(left_.size()) + " bytes too many");
}

std::string_view RecordReader::take(std::size_t size) {
  if (size > left_.size()) refuse("ends too early");
  const std::string_view taken = left_.substr(0, size);
  left_.remove_prefix(size);
  return taken;
}

std::uint64_t RecordReader::take_count() {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<unsigned char>(take(1)[0]);
    const std::uint64_t bits = byte & 0x7FU;
    if (shift == 63 && bits > 1) break;
    value |= bits << shift;
    if ((byte & 0x80U) == 0) {
      if (byte == 0 && shift > 0) refuse("a count is written with more bytes than it needs");
      return value;
    }
  }
  refuse("a count has more than 64 bits");
}

std::int64_t RecordReader::difference() {
  const std::uint64_t value = take_count();
  if (value > 0x1'FFFF) refuse("a voxel lies outside the key range");
  const auto half = static_cast<std::int64_t>(value >> 1U);
  return (value & 1U) != 0 ? -half - 1 : half;
}

double RecordReader::from_bits(std::uint64_t bits) {
  static_assert(sizeof(double) == sizeof bits && std::numeric_limits<double>::is_iec559);
  return std::bit_cast<double>(bits);
}

void RecordReader::number(double& value) {
  const std::string_view bytes = take(8);
  std::uint64_t bits = 0;
  for (std::size_t i = 8; i-- > 0;) bits = (bits << 8U) | static_cast<unsigned char>(bytes[i]);
  value = from_bits(bits);
}

void RecordReader::text(std::string& text) {
  const std::uint64_t size = take_count();
  if (size > left_.size()) refuse("a text is longer than what is there");
  text = take(static_cast<std::size_t>(size));
}

void RecordReader::flag(bool& flag) {
  const auto byte = static_cast<unsigned char>(take(1)[0]);
  if (byte > 1) refuse("a flag is " + std::to_string(byte) + " instead of 0 or 1");
  flag = byte == 1;
}

void RecordReader::count32(std::uint32_t& value) {
  const std::uint64_t wide = take_count();
  if (wide > std::numeric_limits<std::uint32_t>::max()) refuse("a count has more than 32 bits");
  value = static_cast<std::uint32_t>(wide);
}

void RecordReader::small(int& value, int max, const char* name) {
  const std::uint64_t wide = take_count();
  if (wide > static_cast<std::uint64_t>(max)) refuse(out_of_range(name, wide, max));
  value = static_cast<int>(wide);
}

void RecordReader::key(VoxelKey& key) {
  for (std::uint16_t VoxelKey::*axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    const std::uint64_t k = take_count();
    if (k > 0xFFFF) refuse("a voxel lies outside the key range");
    key.*axis = static_cast<std::uint16_t>(k);
  }
}

}  // namespace frontlux::planner::detail
