#include "recording/packed_record.hpp"

#include "recording/record_bytes.hpp"

#include <frontlux/file.hpp>

#include <cstdint>
#include <new>
#include <stdexcept>
#include <zlib.h>

namespace frontlux::planner::detail {
namespace {

constexpr std::size_t kTag = 4, kNumber = 4, kHeader = kTag + 3 * kNumber;
constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr std::size_t kMostRatio = 1032;  // zlib compresses to no less than that part, and a few bytes more

const Bytef* as_zlib(std::string_view bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), as_zlib(bytes), bytes.size()));
}

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  return from_bytes<std::uint32_t>(bytes.substr(at, kNumber).data(), std::endian::little);
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, as_zlib(bytes),
                static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw std::bad_alloc();  // there is no other reason
  packed.resize(size);
  return packed;
}

std::string decompressed(std::string_view packed, std::size_t size) {
  std::string bytes(size, '\0');
  auto got = static_cast<uLongf>(size);
  auto used = static_cast<uLong>(packed.size());
  Bytef nothing = 0;  // zlib wants a place to write to even if there is nothing to write
  Bytef* to = size > 0 ? reinterpret_cast<Bytef*>(bytes.data()) : &nothing;
  const int result = uncompress2(to, &got, as_zlib(packed), &used);
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result != Z_OK || got != size || used != packed.size())
    throw BadRecord("does not decompress to the " + std::to_string(size) + " bytes that it announces");
  return bytes;
}

bool begins_a_tag(std::string_view bytes) {
  for (const std::string_view tag : {kHeadTag, kStepTag, kEndTag})
    if (tag.starts_with(bytes.substr(0, kTag))) return true;
  return false;
}

}  // namespace

std::string packed_record(std::string_view tag, const std::string& bytes) {
  if (bytes.size() > kMostBytes)
    throw std::invalid_argument("recording: a step of " + std::to_string(bytes.size()) +
                                " bytes is more than the " + std::to_string(kMostBytes) + " that fit");
  const std::string packed = compressed(bytes);
  std::string record(tag);
  append_number(record, static_cast<std::uint32_t>(packed.size()));
  append_number(record, static_cast<std::uint32_t>(bytes.size()));
  append_number(record, checksum(record));
  record += packed;
  append_number(record, checksum(packed));
  return record;
}

std::string_view without_zeros(std::string_view bytes) {
  return bytes.substr(0, bytes.find_last_not_of('\0') + 1);
}

std::optional<Record> record_at(std::string_view file, std::size_t begin, std::size_t zeros) {
  const std::string_view left = file.substr(begin);
  // What a file grew by before the machine lost its power may read as zeros.
  if (zeros <= begin) return std::nullopt;
  const std::size_t written = zeros - begin;
  if (!begins_a_tag(left.substr(0, written))) throw BadRecord("no record begins here");
  if (left.size() < kHeader) return std::nullopt;
  if (checksum(left.substr(0, kHeader - kNumber)) != number_at(left, kHeader - kNumber)) {
    if (written < kHeader) return std::nullopt;
    throw BadRecord("the sizes of a record fail their checksum");
  }
  const std::size_t packed = number_at(left, kTag), plain = number_at(left, kTag + kNumber);
  if (plain > kMostBytes || plain > kMostRatio * (packed + 1))
    throw BadRecord("a record announces " + std::to_string(plain) + " bytes, more than it can hold");
  if (left.size() - kHeader < packed + kNumber) return std::nullopt;
  const std::string_view payload = left.substr(kHeader, packed);
  if (checksum(payload) != number_at(left, kHeader + packed)) {
    if (written < kHeader + packed + kNumber) return std::nullopt;
    throw BadRecord("a record fails its checksum");
  }
  return Record{left.substr(0, kTag), decompressed(payload, plain), begin + kHeader + packed + kNumber};
}

}  // namespace frontlux::planner::detail
