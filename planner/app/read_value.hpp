#pragma once

#include "bad_input.hpp"
#include "choices.hpp"

#include <frontlux/file.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::app {

/// The numbers that an option takes: finite, from `low` to `high`, both included.
template <class Number>
struct Range {
  Number low = std::numeric_limits<Number>::lowest(), high = std::numeric_limits<Number>::max();
};
inline constexpr Range<double> kAnyNumber{}, kAboveZero{std::numeric_limits<double>::denorm_min()},
    kFromZero{0.0}, kProbability{0.0, 1.0};
inline constexpr Range<double> kRangeNoise{0.0, 10.0};  ///< [m]
inline constexpr Range<double> kNoiseGrowth{0.0, 1.0};  ///< [1/m]
inline constexpr Range<double> kVoxelEdges{1e-3, 1e3};  ///< [m]
inline constexpr Range<std::uint64_t> kSeeds{};

/// `read` turns a word of the command line into a value. A number is decimal, has no blanks around it, and is
/// the nearest one that the type holds. Everything else is refused: "nan", "inf", "1e999", "0x1", "1m", "".
/// @throws BadInput "'word' is ...", which does not name the option
void read(std::string_view word, double& number, const Range<double>& range);
void read(std::string_view word, int& number, const Range<int>& range);
void read(std::string_view word, std::uint64_t& number, const Range<std::uint64_t>& range);
void read(std::string_view word, Eigen::Vector3f& point);
void read(std::string_view word, Eigen::AlignedBox3d& box);
inline void read(std::string_view word, std::string& text) { text = word; }

template <Chosen Value>
void read(std::string_view word, Value& value) {
  std::string names;
  for (const Choice<Value>& choice : kChoices<Value>) {
    if (word == choice.name) {
      value = choice.value;
      return;
    }
    names.append(names.empty() ? "" : ", ").append(choice.name);
  }
  throw BadInput(quote(word) + " is none of " + names);
}

template <class Value, class... Limits>
void read(std::string_view word, std::optional<Value>& value, const Limits&... limits) {
  read(word, value.emplace(), limits...);
}

template <class Value>
void read(std::string_view word, std::vector<Value>& values) {
  read(word, values.emplace_back());
}

/// Finite numbers with commas between them; nothing if the word is anything else.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view word);

/// @throws BadInput unless the yaw [rad] of a word `is_within_a_turn`
void check_yaw(std::string_view word, double yaw);

}  // namespace frontlux::app
