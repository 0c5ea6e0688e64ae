#pragma once

#include <cstdint>

namespace frontlux::sim {

/// The dice of the world generators: SplitMix64, the same with every compiler. A number is a hash of (seed,
/// stream, how many were drawn before), so that parts of a layout with streams of their own do not move each
/// other.
class LayoutRandom {
 public:
  explicit LayoutRandom(std::uint64_t seed, std::uint64_t stream = 0) : base_(hash(hash(seed) + stream)) {}

  /// Uniform among low, low + 1, ..., high. @pre low <= high
  int whole(int low, int high) {
    return low + static_cast<int>(bits() % (static_cast<std::uint64_t>(high - low) + 1));
  }

  /// True in `percent` of 100 draws.
  bool chance(int percent) { return whole(1, 100) <= percent; }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15U;

  static std::uint64_t hash(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  std::uint64_t bits() { return hash(base_ + kStep * ++drawn_); }

  std::uint64_t base_;
  std::uint64_t drawn_ = 0;
};

}  // namespace frontlux::sim
