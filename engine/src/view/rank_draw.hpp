#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/split_mix.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace frontlux::detail {

/// Random numbers that depend on a seed and a voxel and on nothing else.
class VoxelRandom {
 public:
  VoxelRandom(std::uint64_t seed, const VoxelKey& voxel)
      : random_(SplitMix64::mix(SplitMix64::mix(seed + SplitMix64::kStep) ^
                                (std::uint64_t{voxel.z} << 32U | std::uint64_t{voxel.y} << 16U | voxel.x))) {}

  /// Uniform among 0, 1, ..., count - 1, without bias: a product that falls into the incomplete last round is
  /// drawn again. @pre count > 0
  std::uint32_t below(std::uint32_t count) {
    std::uint64_t product = std::uint64_t{bits()} * count;
    if (static_cast<std::uint32_t>(product) < count) {
      const std::uint32_t incomplete = (0U - count) % count;
      while (static_cast<std::uint32_t>(product) < incomplete) product = std::uint64_t{bits()} * count;
    }
    return static_cast<std::uint32_t>(product >> 32U);
  }

 private:
  std::uint32_t bits() { return static_cast<std::uint32_t>(random_.bits() >> 32U); }

  SplitMix64 random_;
};

/// Draws sets of ranks, all sets of a size with equal chance. Holds memory to be used again.
class RankDraw {
 public:
  /// `count` different ranks below `population`, ascending; all of them without a random number if it has no
  /// more. They are valid until the next call.
  const std::vector<std::uint32_t>& draw(std::uint32_t population, std::uint32_t count, VoxelRandom random) {
    ranks_.clear();
    if (count >= population) {
      for (std::uint32_t rank = 0; rank < population; ++rank) ranks_.push_back(rank);
      return ranks_;
    }
    // Floyd's algorithm, with one bit for each rank.
    const std::size_t words = population / 64U + 1U;
    if (taken_.size() < words) taken_.resize(words);
    for (std::uint32_t last = population - count; last < population; ++last) {
      const std::uint32_t rank = random.below(last + 1U);
      const bool again = (taken_[rank / 64U] >> rank % 64U & 1U) != 0;
      const std::uint32_t chosen = again ? last : rank;
      taken_[chosen / 64U] |= std::uint64_t{1} << chosen % 64U;
    }
    ranks_.resize(count);
    std::size_t size = 0;
    for (std::size_t w = 0; w < words; ++w)
      for (std::uint64_t word = std::exchange(taken_[w], 0); word != 0; word &= word - 1)
        ranks_[size++] =
            static_cast<std::uint32_t>(w * 64U) + static_cast<std::uint32_t>(std::countr_zero(word));
    return ranks_;
  }

 private:
  std::vector<std::uint64_t> taken_;  // zeros between calls
  std::vector<std::uint32_t> ranks_;
};

}  // namespace frontlux::detail
