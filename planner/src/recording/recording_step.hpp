#pragma once

#include <frontlux/planner/recording.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace frontlux::planner::detail {

/// @param number  that the step must have
/// @throws std::invalid_argument naming the value that is out of bounds
[[nodiscard]] std::string step_bytes(const RecordedStep& step, const RecordingHead& head,
                                     std::uint64_t number);

/// @throws BadRecord naming the value that is out of bounds
[[nodiscard]] RecordedStep step_from(std::string_view bytes, const RecordingHead& head, std::uint64_t number);

}  // namespace frontlux::planner::detail
