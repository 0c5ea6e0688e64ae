#include "octomap/octomap_adapter.hpp"

#include <frontlux/live_map.hpp>

#include <utility>
#include <vector>

namespace frontlux {
namespace {

// So that the tree reports changes from now on.
const Octree& watched(const Octree& tree) {
  std::visit(
      [](const auto& t) {
        detail::there(t)->enableChangeDetection(true);
        t->resetChangeDetection();
      },
      tree);
  return tree;
}

}  // namespace

struct LiveMap::State {
  Octree tree;
  OctreeMirror mirror;
  std::unique_ptr<RayCaster> caster;
  std::vector<VoxelKey> keys{};

  explicit State(Octree map)
      : tree(std::move(map)), mirror(watched(tree)), caster(make_ray_caster(mirror.grid())) {}

  MapChange take_in(const VoxelGrid& before) {
    watched(tree);
    caster->update(mirror.grid());
    keys.clear();
    keys = changed_keys(before, mirror.grid());
    return {mirror.grid(), keys};
  }
};

LiveMap::LiveMap(octomap::OcTree& tree) : LiveMap(Octree(detail::borrowed(tree))) {}
LiveMap::LiveMap(octomap::ColorOcTree& tree) : LiveMap(Octree(detail::borrowed(tree))) {}
LiveMap::LiveMap(Octree tree) : state_(std::make_unique<State>(std::move(tree))) {}
LiveMap::~LiveMap() = default;
LiveMap::LiveMap(LiveMap&&) noexcept = default;
LiveMap& LiveMap::operator=(LiveMap&&) noexcept = default;

MapChange LiveMap::update() {
  const VoxelGrid before = state_->mirror.grid();
  state_->mirror.update();
  return state_->take_in(before);
}

MapChange LiveMap::rebuild() {
  const VoxelGrid before = state_->mirror.grid();
  state_->mirror.rebuild();
  return state_->take_in(before);
}

const VoxelGrid& LiveMap::grid() const { return state_->mirror.grid(); }
const RayCaster& LiveMap::caster() const { return *state_->caster; }

}  // namespace frontlux
