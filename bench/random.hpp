#pragma once

#include <cstdint>

namespace frontlux::bench {

/// A number in [0, 1) that depends on nothing but what it is drawn for, so that a workload is the same
/// in every run and does not change when another workload draws more or fewer numbers.
[[nodiscard]] constexpr double uniform(std::uint64_t stream, std::uint64_t index) {
  // Two rounds of splitmix64's finaliser.
  const auto mix = [](std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31U);
  };
  const std::uint64_t bits = mix(mix(stream + 0x9E3779B97F4A7C15U) + index * 0x9E3779B97F4A7C15U);
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

}  // namespace frontlux::bench
