#include "octomap/octomap_adapter.hpp"

#include <frontlux/caster_kind.hpp>

#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

// @param tree  as `make_octomap_ray_caster` takes it
template <class Tree>
std::unique_ptr<RayCaster> make(CasterKind kind, const VoxelGrid& grid, const Tree& tree) {
  switch (kind) {
    case CasterKind::kEmbree:
      return make_embree_ray_caster(grid);
    case CasterKind::kGrid:
      return make_grid_ray_caster(grid);
    case CasterKind::kOctomap:
      return make_octomap_ray_caster(tree);
    case CasterKind::kFast:
      return make_ray_caster(grid);
  }
  throw std::invalid_argument("ray caster: kind is " + std::to_string(static_cast<int>(kind)) +
                              ", which is none of the values of CasterKind");
}

}  // namespace

std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind, const VoxelGrid& grid,
                                           const octomap::OcTree& tree) {
  return make(kind, grid, tree);
}
std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind, const VoxelGrid& grid,
                                           const octomap::ColorOcTree& tree) {
  return make(kind, grid, tree);
}
std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind, const VoxelGrid& grid, const Octree& tree) {
  static_cast<void>(detail::to_read(tree));  // whatever the kind, there has to be one
  return make(kind, grid, tree);
}

}  // namespace frontlux
