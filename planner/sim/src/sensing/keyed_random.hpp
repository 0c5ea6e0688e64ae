#pragma once

#include <frontlux/split_mix.hpp>

#include <cstdint>

namespace frontlux::sim {

/// Random numbers for one of many things. They depend on the seed and the thing's number alone, so it does
/// not matter in which order, or on which threads, things are drawn for.
[[nodiscard]] inline SplitMix64 random_of(std::uint64_t seed, std::uint64_t number) {
  return SplitMix64(SplitMix64(SplitMix64(seed).bits() + number).bits());
}

}  // namespace frontlux::sim
