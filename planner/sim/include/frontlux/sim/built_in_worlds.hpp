#pragma once

#include <frontlux/sim/world.hpp>

#include <cstdint>
#include <span>
#include <string_view>

namespace frontlux::sim {

struct BuiltInWorld {
  std::string_view name;
  std::string_view description;  ///< one line: size and contents
};

/// All worlds that `make_world` knows.
[[nodiscard]] std::span<const BuiltInWorld> built_in_worlds();

/// Generates a world. The same name and seed give the same bytes on every machine; another seed gives
/// another layout.
///
/// The world is closed on all sides. The main floor's top lies at z = -0.05 m, and no surface lies on a face
/// of voxels of 0.1, 0.2 or 0.3 m. The surface is closed, without cracks, and faces away from the solids. At
/// the start, which is on the floor, a UGV of 1.0 x 1.0 x 0.7 m fits, and above it a UAV of 0.8 m edge.
/// @throws std::invalid_argument naming the worlds that there are, if there is none of that name
[[nodiscard]] World make_world(std::string_view name, std::uint64_t seed);

}  // namespace frontlux::sim
