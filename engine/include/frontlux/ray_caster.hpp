#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace frontlux {

/// Answers ray queries on a snapshot of a map, exactly as `octomap::OcTree::castRay` would
/// (docs/ray_contract.md).
///
/// Every query is a batch: spans in, spans out, `results[i]` belongs to input `i` and depends on nothing
/// else, not on its neighbours, not on the number of threads. Batches are spread over TBB's current arena:
/// call inside a `tbb::task_arena` to choose the number of threads.
///
/// Rays that cannot be cast (not finite, outside the key range, without direction) are answered, not thrown:
/// `RayStop::kInvalid`, or not visible.
///
/// Thread safety: const members may run at the same time as each other and as `update`; a query answers
/// from the map as it was when the query began. Calls of `update` must not overlap.
class RayCaster {
 public:
  virtual ~RayCaster() = default;
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// The closest blocker along each ray, or where the ray ended without one.
  /// @throws std::invalid_argument if the spans differ in size
  void cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const;

  /// One ray, on the calling thread.
  [[nodiscard]] Hit cast(const Ray& ray, UnknownPolicy unknown) const;

  /// For each segment 1 if castRay's path from `from` towards `to` reaches the voxel of `to` and no voxel
  /// strictly between the two blocks, else 0. The voxels that hold `from` and `to` never block.
  /// @throws std::invalid_argument if the spans differ in size
  void visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
               UnknownPolicy unknown) const;

  /// The same between voxel centres, in exact integer arithmetic: a path through an edge or corner steps
  /// along z before y before x. The answer depends only on the offset between the keys and on the voxels
  /// between them.
  /// @throws std::invalid_argument if the spans differ in size
  void visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
               UnknownPolicy unknown) const;

  /// How many unknown, free and occupied voxels each ray crosses before it stops where `cast` says. With
  /// `UnknownPolicy::kPass` and a range, `unknown` is what a sensor beam would uncover at most.
  /// @throws std::invalid_argument if the spans differ in size
  void count(std::span<const Ray> rays, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// The same from the voxel of `from`, included, to that of `to`, excluded, on the path that `visible`
  /// follows: `kReached` where it says 1. The voxel of `from` never blocks. Of a segment within one voxel
  /// nothing is counted.
  /// @throws std::invalid_argument if the spans differ in size
  void count(std::span<const Segment> segments, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// The same between voxel centres, in exact integer arithmetic.
  /// @throws std::invalid_argument if the spans differ in size
  void count(std::span<const KeySegment> segments, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// Follows a map that has changed. What changed is found by comparing `grid` with the snapshot held, which
  /// passes over the parts they share: cheap for an edited copy, right for any grid.
  /// @throws std::invalid_argument if the resolution differs from the one this caster was made with
  void update(const VoxelGrid& grid);

  /// The map from which it answers at the moment; nothing of a caster that keeps no grid (OctoMap's).
  [[nodiscard]] std::optional<VoxelGrid> grid() const { return do_grid(); }

  /// Bytes this caster holds beside the grid's own (acceleration structure; 0 for a caster without one).
  [[nodiscard]] virtual std::size_t memory_bytes() const { return 0; }

 protected:
  explicit RayCaster(const Lattice& lattice) : lattice_(lattice) {}
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }

 private:
  // Spans are of equal size and not empty; rays and segments are unchecked.
  virtual void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const = 0;
  virtual void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                          UnknownPolicy unknown) const = 0;
  virtual void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                          UnknownPolicy unknown) const = 0;
  virtual void do_count(std::span<const Ray> rays, std::span<PathCount> counts,
                        UnknownPolicy unknown) const = 0;
  virtual void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                        UnknownPolicy unknown) const = 0;
  virtual void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                        UnknownPolicy unknown) const = 0;
  virtual void do_update(const VoxelGrid& grid) = 0;
  [[nodiscard]] virtual std::optional<VoxelGrid> do_grid() const { return std::nullopt; }

  Lattice lattice_;
};

/// Walks the grid voxel by voxel: castRay's own traversal, with its rounding, over `VoxelGrid`. The oracle.
/// Costs nothing to build, and shares the grid's memory.
[[nodiscard]] std::unique_ptr<RayCaster> make_grid_ray_caster(const VoxelGrid& grid);

/// The fast one. Keeps two things beside the grid: a table of open voxels, through which rays are walked in
/// packets, and a BVH of boxes in Embree for the rays that are too long for that, or outside the table. What
/// rounding could decide either way is settled by the grid's walk.
/// @throws std::runtime_error if Embree cannot make its device
[[nodiscard]] std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid);

/// The one of the two that is sooner done: the grid's walk for a few rays, Embree once they repay its
/// building.
/// @param expected_rays  how many rays will be cast, about, before the map changes everywhere or the caster
/// goes
/// @throws std::runtime_error if Embree cannot make its device
[[nodiscard]] std::unique_ptr<RayCaster> make_ray_caster(const VoxelGrid& grid, std::uint64_t expected_rays);

}  // namespace frontlux
