#include "octomap/octomap_adapter.hpp"

#include <frontlux/octomap.hpp>

#include <memory>
#include <utility>

namespace frontlux {
namespace {

UnknownPolicy policy(bool ignore_unknown_cells) {
  return ignore_unknown_cells ? UnknownPolicy::kPass : UnknownPolicy::kBlock;
}

}  // namespace

struct OctreeRayCaster::Snapshot {
  detail::OctreePointer tree;
  std::unique_ptr<RayCaster> caster;

  explicit Snapshot(detail::OctreePointer read_from)
      : tree(std::move(read_from)), caster(make_ray_caster(read())) {}

  [[nodiscard]] VoxelGrid read() const {
    return std::visit([](const auto& t) { return make_voxel_grid(*t); }, tree);
  }
};

OctreeRayCaster::OctreeRayCaster(const octomap::OcTree& tree)
    : snapshot_(std::make_unique<Snapshot>(detail::borrowed(tree))) {}
OctreeRayCaster::OctreeRayCaster(const octomap::ColorOcTree& tree)
    : snapshot_(std::make_unique<Snapshot>(detail::borrowed(tree))) {}
OctreeRayCaster::OctreeRayCaster(const Octree& tree)
    : snapshot_(std::make_unique<Snapshot>(detail::to_read(tree))) {}
OctreeRayCaster::~OctreeRayCaster() = default;
OctreeRayCaster::OctreeRayCaster(OctreeRayCaster&&) noexcept = default;
OctreeRayCaster& OctreeRayCaster::operator=(OctreeRayCaster&&) noexcept = default;

bool OctreeRayCaster::castRay(const octomap::point3d& origin, const octomap::point3d& direction,
                              octomap::point3d& end, bool ignoreUnknownCells, double maxRange) const {
  const Ray ray{detail::from_octomap(origin), detail::from_octomap(direction), maxRange};
  Eigen::Vector3f center;
  const RayStop stop = snapshot_->caster->cast(ray, policy(ignoreUnknownCells), center);
  if (stop != RayStop::kInvalid) end = detail::to_octomap(center);
  return stop == RayStop::kOccupied;
}

void OctreeRayCaster::castRays(std::span<const Ray> rays, std::span<Hit> hits,
                               bool ignoreUnknownCells) const {
  snapshot_->caster->cast(rays, hits, policy(ignoreUnknownCells));
}

// The caster stays the same object: users hold references to it.
void OctreeRayCaster::refresh() {
  const VoxelGrid grid = snapshot_->read();
  std::unique_ptr<RayCaster>& caster = snapshot_->caster;
  if (grid.resolution() == caster->lattice().resolution())
    caster->update(grid);
  else
    caster = make_ray_caster(grid);
}

const RayCaster& OctreeRayCaster::caster() const { return *snapshot_->caster; }

}  // namespace frontlux
