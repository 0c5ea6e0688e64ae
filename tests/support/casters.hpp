#pragma once

#include "octomap/quiet_octomap.hpp"
#include "support/test.hpp"

#include <frontlux/caster_kind.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>

namespace frontlux::test {

inline constexpr UnknownPolicy kPolicies[] = {UnknownPolicy::kBlock, UnknownPolicy::kPass};

/// A caster of each kind, with its name; the last is OctoMap's, which needs the tree for as long as it is
/// there.
struct Casters {
  VoxelGrid grid;
  std::vector<std::pair<std::string, std::unique_ptr<RayCaster>>> all;

  explicit Casters(const octomap::OcTree& tree) : grid(make_voxel_grid(tree)) {
    for (const auto& [name, kind] : kCasterNames) all.emplace_back(name, make_ray_caster(kind, grid, tree));
  }
};

/// Those that need no tree: the walk, Embree, and the fast one.
inline std::array<std::unique_ptr<RayCaster>, 3> casters_of(const VoxelGrid& grid) {
  return {make_grid_ray_caster(grid), make_embree_ray_caster(grid), make_ray_caster(grid)};
}

/// To the last bit.
inline bool same(const Hit& a, const Hit& b) {
  return a.stop == b.stop && a.state == b.state && a.key == b.key &&
         std::memcmp(&a.end, &b.end, sizeof a.end) == 0 &&
         std::memcmp(&a.entry, &b.entry, sizeof a.entry) == 0 && a.distance == b.distance;
}

}  // namespace frontlux::test
