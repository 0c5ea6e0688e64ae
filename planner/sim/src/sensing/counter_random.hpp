#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace frontlux::sim {

/// Random numbers without a state: the number is a function of what it is drawn for, so it does not matter in
/// which order, or on which thread, the draws are made.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t index) : key_(scrambled(scrambled(seed) + index)) {}

  /// 64 random bits, the seed of something else.
  [[nodiscard]] std::uint64_t bits(std::uint64_t draw) const { return scrambled(key_ + draw * kStep); }

  /// Between 0 and 1, neither of them included. `draw` numbers the draws for one index.
  [[nodiscard]] double uniform(std::uint64_t draw) const {
    return (static_cast<double>(scrambled(key_ + draw * kStep) >> 12) + 0.5) * 0x1p-52;
  }

  /// Normally distributed, mean 0, deviation 1. Takes two draws.
  [[nodiscard]] double normal(std::uint64_t draw) const {
    return std::sqrt(-2.0 * std::log(uniform(draw))) * std::cos(2.0 * std::numbers::pi * uniform(draw + 1));
  }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15;

  // The output function of SplitMix64: every bit of the result depends on every bit of the input.
  static std::uint64_t scrambled(std::uint64_t bits) {
    bits += kStep;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EB;
    return bits ^ (bits >> 31);
  }

  std::uint64_t key_;
};

}  // namespace frontlux::sim
