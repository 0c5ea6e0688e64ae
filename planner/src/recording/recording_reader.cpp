#include <frontlux/file.hpp>
#include "recording/recording_bytes.hpp"
#include "recording/recording_head.hpp"
#include "recording/recording_parts.hpp"
#include "recording/recording_record.hpp"
#include "recording/recording_step.hpp"

#include <frontlux/planner/recording.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace frontlux::planner {
namespace {

using detail::kRecordingTitle;

// Where the records begin.
std::size_t check_title(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::size_t kMostDigits = 9;
  const auto foreign = [&] {
    frontlux::fail(file, "is not a recording of frontlux",
                 "name the file run.frontlux of a folder that `frontlux explore` wrote");
  };
  if (!bytes.starts_with(kRecordingTitle)) {
    if (!bytes.empty() && kRecordingTitle.starts_with(bytes))
      frontlux::fail(file, "ends in its first line, before the run began", "explore anew");
    foreign();
  }
  const std::string_view rest = bytes.substr(kRecordingTitle.size());
  const std::string_view digits = rest.substr(0, rest.substr(0, kMostDigits + 1).find('\n'));
  if (digits.size() == rest.size() && digits.size() <= kMostDigits)
    frontlux::fail(file, "ends in its first line, before the run began", "explore anew");
  if (digits.empty() || digits.size() > kMostDigits || !std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) foreign();
  if (digits != std::to_string(detail::kRecordingFormat))
    frontlux::fail(file,
                 "is a recording of format " + std::string(digits) + ", and this program reads format " +
                     std::to_string(detail::kRecordingFormat),
                 "read it with the frontlux that wrote it, or explore anew");
  return kRecordingTitle.size() + digits.size() + 1;
}

std::string end_from(std::string_view bytes) {
  detail::RecordReader reader(bytes);
  std::string reason;
  detail::code_end(reader, reason);
  reader.end();
  return reason;
}

// Takes the records one after the other.
class Parts {
 public:
  Parts(std::string_view bytes, std::size_t begin) : bytes_(bytes), at_(begin) {}
  [[nodiscard]] std::size_t at() const { return at_; }

  [[nodiscard]] Recording all() {
    Recording recording;
    bool headed = false;
    while (at_ < bytes_.size()) {
      if (recording.end) throw detail::BadRecord("goes on after its end");
      const auto record = detail::record_at(bytes_, at_);
      if (!record) break;
      if (headed == (record->tag == detail::kHeadTag))
        throw detail::BadRecord(headed ? "has a second head" : "has no head");
      if (record->tag == detail::kHeadTag)
        recording.head = detail::head_from(record->bytes);
      else if (record->tag == detail::kStepTag)
        recording.steps.push_back(detail::step_from(record->bytes, recording.head, recording.steps.size()));
      else
        recording.end = end_from(record->bytes);
      headed = true;
      at_ = record->end;
      if (!recording.end) recording.bytes = at_;
    }
    recording.truncated = at_ < bytes_.size();
    return recording;
  }

 private:
  std::string_view bytes_;
  std::size_t at_;
};

}  // namespace

Recording read_recording(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  Parts parts(bytes, check_title(file, bytes));
  try {
    Recording recording = parts.all();
    if (recording.bytes == 0) frontlux::fail(file, "ends before the run began", "explore anew");
    return recording;
  } catch (const detail::BadRecord& error) {
    frontlux::fail(file, "is damaged at byte " + std::to_string(parts.at()) + ": " + error.what(),
                 "take a copy of it that is whole, or explore anew");
  }
}

}  // namespace frontlux::planner
