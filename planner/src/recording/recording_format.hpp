#pragma once

#include <frontlux/planner/recording.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace frontlux::planner::detail {

/// The first line of a recording, but for the number of its format and the line's end.
inline constexpr std::string_view kRecordingTitle = "frontlux recording, format ";
/// The oldest format that is read: see `Recording::format`.
inline constexpr int kOldestRecordingFormat = 3;

/// The bytes of a recording's records. What writes them throws std::invalid_argument naming the value that is
/// out of bounds, what reads them BadRecord.

[[nodiscard]] std::string head_bytes(const RecordingHead& head);
[[nodiscard]] RecordingHead head_from(std::string_view bytes);

/// @param number  that the step must have
/// @param format  of the file
[[nodiscard]] std::string step_bytes(const RecordedStep& step, const RecordingHead& head,
                                     std::uint64_t number, int format = kRecordingFormat);
[[nodiscard]] RecordedStep step_from(std::string_view bytes, const RecordingHead& head, std::uint64_t number,
                                     int format = kRecordingFormat);

/// Why a run ended: a word of small letters and _, so that newer words need no newer format.
[[nodiscard]] std::string end_bytes(const std::string& reason);
[[nodiscard]] std::string end_from(std::string_view bytes);

}  // namespace frontlux::planner::detail
