#pragma once

#include "world/solid.hpp"

#include <Eigen/Core>

#include <cstdint>

namespace frontlux::sim {

/// A generator's result: what is solid, and where to start. All in decimetres.
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
