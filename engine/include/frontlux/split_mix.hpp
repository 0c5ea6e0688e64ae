#pragma once

#include <cstdint>

namespace frontlux {

/// Random numbers that are the same with every compiler and standard library, which `std::uniform_*` does not
/// promise: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014), a
/// hash of a state that grows by a constant. Seed it with `mix` of what the numbers are drawn for, and they
/// depend on nothing else.
class SplitMix64 {
 public:
  /// What the state grows by with each number.
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15U;

  /// Every bit of the result depends on every bit of `z`; different numbers have different results.
  [[nodiscard]] static constexpr std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

  /// Numbers that depend on this state only.
  constexpr explicit SplitMix64(std::uint64_t state) : state_(state) {}

  /// 64 random bits.
  constexpr std::uint64_t bits() { return mix(state_ += kStep); }

  /// Uniform in [0, 1).
  constexpr double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

  /// Uniform in [low, high).
  constexpr double between(double low, double high) { return low + (high - low) * unit(); }

  /// Uniform among low, low + 1, ..., high. @pre low <= high
  constexpr int whole(int low, int high) {
    const auto numbers = static_cast<std::uint64_t>(std::int64_t{high} - low) + 1;
    return static_cast<int>(low + static_cast<std::int64_t>(bits() % numbers));
  }

  /// True once in `n` times on average.
  constexpr bool one_in(int n) { return whole(1, n) == 1; }

 private:
  std::uint64_t state_;
};

}  // namespace frontlux
