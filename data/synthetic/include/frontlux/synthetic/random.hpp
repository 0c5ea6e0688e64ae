#pragma once

#include <cstdint>

namespace frontlux::synthetic {

/// Random numbers that are the same with every compiler and standard library, which `std::uniform_*` does not
/// promise: SplitMix64, a hash of (seed, stream) and a counter.
class Random {
 public:
  /// @param seed    of the whole scene
  /// @param stream  which of its independent sequences, so that one part may draw more without moving another
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mix(seed) + mix(~stream)) {}

  /// 64 random bits.
  std::uint64_t bits() { return mix(state_ += 0x9E3779B97F4A7C15U); }

  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

  /// Uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * unit(); }

  /// Uniform among low, low + 1, ..., high. @pre low <= high
  int whole(int low, int high) {
    return low + static_cast<int>(bits() % (static_cast<std::uint64_t>(high - low) + 1));
  }

  /// True once in `n` times on average.
  bool one_in(int n) { return whole(1, n) == 1; }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace frontlux::synthetic
