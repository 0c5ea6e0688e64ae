#pragma once

#include <frontlux/planner/recording.hpp>

#include <string>
#include <string_view>

namespace frontlux::planner::detail {

/// @throws std::invalid_argument naming the value that is out of bounds
[[nodiscard]] std::string head_bytes(const RecordingHead& head);

/// @throws BadRecord naming the value that is out of bounds
[[nodiscard]] RecordingHead head_from(std::string_view bytes);

}  // namespace frontlux::planner::detail
