#pragma once

#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <string>
#include <string_view>

namespace frontlux::app {

/// The shortest decimals that read back as the same number, in every locale.
[[nodiscard]] std::string to_text(float number);
[[nodiscard]] std::string to_text(double number);

/// A number for people: seven digits.
[[nodiscard]] std::string rounded(double number);

/// "12.3 MiB"
[[nodiscard]] std::string to_text_bytes(std::size_t bytes);

/// "1, 2, 3"
[[nodiscard]] std::string to_text(const Eigen::Vector3f& point);
[[nodiscard]] std::string to_text(const VoxelKey& key);

/// "occupied", "free", "unknown"
[[nodiscard]] std::string to_text(Occupancy state);

/// A line of output: the label, padded, and what it names.
[[nodiscard]] std::string row(std::string_view label, std::string_view value);

/// A finite number.
/// @param name of the option, for the message
/// @throws BadInput
[[nodiscard]] double parse_number(std::string_view name, std::string_view text);

/// A finite number above 0 [m].
/// @throws BadInput
[[nodiscard]] double parse_length(std::string_view name, std::string_view text);

/// The edge of a map's voxel, 1 mm to 1 km, from the option --resolution.
/// @throws BadInput
[[nodiscard]] double parse_resolution(std::string_view text);

/// Three finite numbers with commas between them.
/// @param name of the option, for the message
/// @throws BadInput
[[nodiscard]] Eigen::Vector3f parse_vector(std::string_view name, std::string_view text);

}  // namespace frontlux::app
