#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace frontlux::planner::detail {

inline constexpr std::string_view kHeadTag = "head", kStepTag = "step", kEndTag = "end ";

/// A record as it is in the file: tag, compressed and plain size and the checksum of these, then the
/// compressed bytes and their checksum.
/// @throws std::invalid_argument if there are more than a gigabyte of them
[[nodiscard]] std::string packed_record(std::string_view tag, const std::string& bytes);

/// A record as it was packed.
struct Record {
  std::string_view tag;
  std::string bytes;
  std::size_t end = 0;  ///< where the next one begins
};

/// The bytes but for zeros at their end.
[[nodiscard]] std::string_view without_zeros(std::string_view bytes);

/// The record that begins at a byte of the file; nothing if the file ends before it does, or has nothing but
/// zeros from some byte of it on.
/// @param zeros  where the zeros at the file's end begin
/// @throws BadRecord if there is something else
[[nodiscard]] std::optional<Record> record_at(std::string_view file, std::size_t begin, std::size_t zeros);

}  // namespace frontlux::planner::detail
