#pragma once

#include "report/explored_run.hpp"
#include "support/folder_test.hpp"

#include <frontlux/report/report.hpp>

#include <nlohmann/json.hpp>

#include <string_view>
#include <zlib.h>

namespace frontlux::test {

// Bit by bit, from a table that is looked through: slow, and unlike what it judges.
inline std::string from_base64(std::string_view text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value{};
  for (std::size_t i = 0; i < digits.size(); ++i)
    value.at(static_cast<unsigned char>(digits[i])) = static_cast<int>(i);
  std::string bytes;
  unsigned bits = 0, held = 0;
  for (const char c : text) {
    if (c == '=') break;
    EXPECT_NE(digits.find(c), std::string::npos);
    held = held << 6U | static_cast<unsigned>(value.at(static_cast<unsigned char>(c)));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(held >> bits & 0xFFU);
  }
  return bytes;
}

inline std::string inflated(std::string_view bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit(&stream), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  std::array<char, 1 << 16> buffer;
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = buffer.size();
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(buffer.data(), buffer.size() - stream.avail_out);
  }
  EXPECT_EQ(state, Z_STREAM_END);
  inflateEnd(&stream);
  return out;
}

// The texts of the runs in a page.
inline std::vector<std::string> packed_runs(const std::string& page) {
  const std::string begin = "<script type=\"text/plain\" class=\"run\">", end = "</script>";
  std::vector<std::string> runs;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    runs.push_back(page.substr(at, page.find(end, at) - at));
  }
  return runs;
}

// Reads what the page reads.
struct Reader {
  std::string bytes;
  std::size_t at = 0;

  std::uint8_t u8() { return static_cast<std::uint8_t>(bytes.at(at++)); }
  std::uint64_t count() {
    std::uint64_t number = 0;
    for (unsigned shift = 0;; shift += 7) {
      const std::uint64_t byte = u8();
      number |= (byte & 0x7FU) << shift;
      if (byte < 0x80) return number;
    }
  }
  std::int64_t difference() {
    const std::uint64_t number = count();
    return static_cast<std::int64_t>(number / 2) * (number % 2 != 0 ? -1 : 1) -
           static_cast<std::int64_t>(number % 2);
  }
  std::vector<VoxelKey> keys(std::size_t size) {
    std::vector<VoxelKey> list(size);
    for (const auto axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
      std::int64_t key = 0;
      for (VoxelKey& voxel : list) voxel.*axis = static_cast<std::uint16_t>(key += difference());
    }
    return list;
  }
  float f32() {
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= std::uint32_t{u8()} << 8 * i;
    return std::bit_cast<float>(bits);
  }
};

struct Decoded {
  nlohmann::json facts;
  Reader data;
};

inline Decoded decode(const std::string& packed) {
  const std::string bytes = inflated(from_base64(packed));
  std::uint32_t length = 0;
  for (unsigned i = 0; i < 4; ++i) length |= std::uint32_t{static_cast<unsigned char>(bytes.at(i))} << 8 * i;
  return {nlohmann::json::parse(bytes.substr(4, length)), {bytes.substr(4 + length)}};
}

/// Writes reports, and reads what they hold.
class ReportFolder : public FolderTest {
 protected:
  std::string page_of(const std::vector<report::ReportedRun>& runs) {
    report::write_report(folder_ / "report.html", runs, "1.2.3");
    return content_of(folder_ / "report.html");
  }
  static const planner::Recording& room() {
    static const planner::Recording recording = explored_run("room", 5);
    return recording;
  }
};

}  // namespace frontlux::test
