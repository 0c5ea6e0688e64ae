#pragma once

#include "world/solid.hpp"

#include <frontlux/split_mix.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <span>

namespace frontlux::sim {

/// The random numbers of the world generators. Each stream of a seed has its own, so parts of a layout that
/// draw from different streams do not change each other.
class LayoutRandom : public SplitMix64 {
 public:
  explicit LayoutRandom(std::uint64_t seed, std::uint64_t stream = 0) : SplitMix64(mix(mix(seed) + stream)) {}

  /// True in `percent` of 100 draws.
  bool chance(int percent) { return whole(1, 100) <= percent; }
  /// Adds `left` to some widths, one by one, none above `widest`.
  void widen(std::span<int> widths, int widest, int left) {
    while (left > 0)
      if (int& one = widths[static_cast<std::size_t>(whole(0, static_cast<int>(widths.size()) - 1))];
          one < widest) {
        ++one;
        --left;
      }
  }
};

/// What a generator makes: what is solid, and where to start. All in decimetres.
struct Building {
  Rect inside;
  Solid solid;
  Eigen::Vector3i start = Eigen::Vector3i::Zero();
};

[[nodiscard]] Building build_maze(std::uint64_t seed);
[[nodiscard]] Building build_factory(std::uint64_t seed);
[[nodiscard]] Building build_station(std::uint64_t seed);
[[nodiscard]] Building build_storage(std::uint64_t seed);
[[nodiscard]] Building build_room(std::uint64_t seed);

}  // namespace frontlux::sim
