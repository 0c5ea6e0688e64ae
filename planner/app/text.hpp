#pragma once

#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>

namespace frontlux::app {

/// The shortest decimals that read back as the same number, in every locale.
[[nodiscard]] std::string to_text(float number);
[[nodiscard]] std::string to_text(double number);
[[nodiscard]] std::string to_text(std::integral auto number) { return std::to_string(number); }

/// The double that is written with the same decimals as this float.
[[nodiscard]] double as_written(float number);

/// "1, 2, 3"
[[nodiscard]] std::string to_text(const Eigen::Vector3f& point);
[[nodiscard]] std::string to_text(const VoxelKey& key);

/// "occupied", "free", "unknown"
[[nodiscard]] std::string to_text(Occupancy state);

/// Numbers for people: seven significant digits; so many digits after the point; "12.3 MiB".
[[nodiscard]] std::string rounded(double number);
[[nodiscard]] std::string fixed(double number, int digits);
[[nodiscard]] std::string bytes_text(std::size_t bytes);

/// A fraction from 0 to 1 for people: "97.2 %". What is not all never reads as "100 %".
/// @param digits after the point
[[nodiscard]] std::string percent(double fraction, int digits = 1);

/// A line of output: the label, padded, and what it names.
[[nodiscard]] std::string row(std::string_view label, std::string_view value);

}  // namespace frontlux::app
