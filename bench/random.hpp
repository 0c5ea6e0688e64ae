#pragma once

#include <frontlux/split_mix.hpp>

#include <cstdint>

namespace frontlux::bench {

/// A number in [0, 1) that depends on nothing but what it is drawn for, so that a workload is the same
/// in every run and does not change when another workload draws more or fewer numbers.
[[nodiscard]] constexpr double uniform(std::uint64_t stream, std::uint64_t index) {
  return SplitMix64(SplitMix64(stream).bits() + (index - 1) * SplitMix64::kStep).unit();
}

}  // namespace frontlux::bench
