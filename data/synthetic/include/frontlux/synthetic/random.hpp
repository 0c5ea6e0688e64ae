#pragma once

#include <frontlux/split_mix.hpp>

#include <cstdint>

namespace frontlux::synthetic {

/// The random numbers of a scene.
class Random : public SplitMix64 {
 public:
  /// @param seed    of the whole scene
  /// @param stream  which of its independent sequences: one part may draw more without changing another
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : SplitMix64(mix(seed) + mix(~stream)) {}
};

}  // namespace frontlux::synthetic
