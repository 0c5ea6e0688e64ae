#pragma once

#include <frontlux/ray_caster.hpp>

#include <memory>

namespace frontlux::detail {

/// `make_embree_ray_caster` without its table: Embree and what settles its rounding answer every ray. For the
/// tests, where the table would leave them little to do.
[[nodiscard]] std::unique_ptr<RayCaster> make_scene_ray_caster(const VoxelGrid& grid);

}  // namespace frontlux::detail
