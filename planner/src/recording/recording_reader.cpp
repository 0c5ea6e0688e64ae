#include "recording/packed_record.hpp"
#include "recording/record_bytes.hpp"
#include "recording/recording_format.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::kRecordingTitle;

[[noreturn]] void fail_unbegun(const std::filesystem::path& file, const std::string& where) {
  throw UnbegunRecording(file.string() + ": ends " + where + "; begin it anew");
}

// The file's format, and where the records begin.
std::pair<int, std::size_t> read_title(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::size_t kMostDigits = 9;
  const auto foreign = [&] {
    fail(file, "is not a recording of frontlux",
         "name the file run.frontlux of a folder that `frontlux explore` wrote");
  };
  const auto too_short = [&] { fail_unbegun(file, "in its first line, before the run began"); };
  bytes = detail::without_zeros(bytes);
  if (kRecordingTitle.starts_with(bytes)) too_short();
  if (!bytes.starts_with(kRecordingTitle)) foreign();
  const std::string_view rest = bytes.substr(kRecordingTitle.size(), kMostDigits + 1);
  const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  if (digits == rest.size() && digits <= kMostDigits) too_short();
  if (digits == 0 || digits > kMostDigits || rest[digits] != '\n') foreign();
  const int format = std::stoi(std::string(rest.substr(0, digits)));
  if (format < detail::kOldestRecordingFormat || format > kRecordingFormat)
    fail(file,
         "is a recording of format " + std::to_string(format) + ", and this program reads formats " +
             std::to_string(detail::kOldestRecordingFormat) + " to " + std::to_string(kRecordingFormat),
         "read it with the frontlux that wrote it, or explore anew");
  return {format, kRecordingTitle.size() + digits + 1};
}

// What has been read may take no more memory than there is: a record may be a thousandth of what is in it.
class MemoryLimit {
 public:
  explicit MemoryLimit(const std::filesystem::path& file) : file_(file) {}

  /// @param plain  bytes of a record, unpacked
  void add(std::size_t plain, std::size_t robots) {
    constexpr std::size_t kPerByte = 2;  // a change takes eight bytes of memory, and four in the file
    kept_ += kPerByte * plain + robots * sizeof(RobotStep);
    if (kept_ + plain > available_)
      fail(file_,
           "holds steps that take more than " + std::to_string(kept_ + plain) +
               " bytes of memory, but only " + std::to_string(available_) + " are left",
           "read it on a machine with more memory");
  }

 private:
  const std::filesystem::path& file_;
  std::uint64_t kept_ = 0;  // [bytes]
  const std::uint64_t available_ = available_memory();
};

// Reads the records one after the other. `at`: where the next one begins
Recording read_records(std::string_view bytes, int format, MemoryLimit memory, std::size_t& at) {
  Recording recording;
  recording.format = format;
  const std::size_t zeros = detail::without_zeros(bytes).size();  // where they begin
  bool has_head = false;
  while (at < bytes.size()) {
    if (recording.end && zeros > at) throw detail::BadRecord("goes on after its end");
    const auto record = detail::record_at(bytes, at, zeros);
    if (!record) break;
    memory.add(record->bytes.size(), recording.head.robots.size());
    if (has_head == (record->tag == detail::kHeadTag))
      throw detail::BadRecord(has_head ? "has a second head" : "has no head");
    if (record->tag == detail::kHeadTag)
      recording.head = detail::head_from(record->bytes);
    else if (record->tag == detail::kStepTag)
      recording.steps.push_back(
          detail::step_from(record->bytes, recording.head, recording.steps.size(), format));
    else
      recording.end = detail::end_from(record->bytes);
    has_head = true;
    at = record->end;
    if (!recording.end) recording.bytes = at;
  }
  recording.truncated = !recording.end && at < bytes.size();
  return recording;
}

}  // namespace

Recording read_recording(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  auto [format, at] = read_title(file, bytes);
  try {
    Recording recording = read_records(bytes, format, MemoryLimit(file), at);
    if (recording.bytes == 0) fail_unbegun(file, "before the run began");
    return recording;
  } catch (const detail::BadRecord& error) {
    fail(file, "is damaged at byte " + std::to_string(at) + ": " + error.what(),
         "take a copy of it that is whole, or explore anew");
  }
}

}  // namespace frontlux::planner
