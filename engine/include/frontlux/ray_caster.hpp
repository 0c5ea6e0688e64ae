#pragma once

#include <frontlux/export.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace frontlux {

/// Answers ray queries on a snapshot of a map, exactly as `octomap::OcTree::castRay` would
/// (docs/ray_contract.md).
///
/// Every query is a batch: spans in, spans out. `results[i]` belongs to input `i` and depends on nothing
/// else, not on the other inputs, not on the number of threads. Batches run on the threads of TBB's current
/// arena: call inside a `tbb::task_arena` to choose how many.
///
/// Whatever floating-point mode a thread is in (rounding, flushed denormals, traps), answers are those of
/// castRay in the standard mode.
///
/// Rays that cannot be cast (not finite, outside the key range, without direction) are answered, not thrown:
/// `RayStop::kInvalid`, or not visible.
///
/// Thread safety: const members may run at the same time as each other and as `update`; a query answers
/// from the map as it was when the query began. Calls of `update` must not overlap.
class FRONTLUX_EXPORT RayCaster {
 public:
  virtual ~RayCaster() = default;
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// The closest blocker along each ray, or where the ray ended without one.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const;

  /// One ray, on the calling thread.
  [[nodiscard]] Hit cast(const Ray& ray, UnknownPolicy unknown) const;

  /// What castRay itself tells of one ray, on the calling thread. Takes less time than to make a `Hit`.
  /// @param end  [m] centre of the voxel where the ray ended; left as it is with `kInvalid`
  RayStop cast(const Ray& ray, UnknownPolicy unknown, Eigen::Vector3f& end) const;

  /// For each segment 1 if castRay's path from `from` towards `to` reaches the voxel of `to` and no voxel
  /// strictly between the two blocks, else 0. The voxels that hold `from` and `to` never block.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
               UnknownPolicy unknown) const;

  /// The same between voxel centres, in exact integer arithmetic: a path through an edge or corner steps
  /// along z before y before x. The answer depends only on the offset between the keys and on the voxels
  /// between them.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
               UnknownPolicy unknown) const;

  /// How many unknown, free and occupied voxels each ray crosses before it stops where `cast` stops it. With
  /// `UnknownPolicy::kPass` and a range, `unknown` is the most that a sensor beam could uncover.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void count(std::span<const Ray> rays, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// The same from the voxel of `from`, included, to that of `to`, excluded, on the path of `visible`:
  /// `kReached` where that answers 1. The voxel of `from` never blocks. If both are one voxel, nothing is
  /// counted.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void count(std::span<const Segment> segments, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// The same between voxel centres, in exact integer arithmetic.
  /// @throws std::invalid_argument if the spans differ in size, or for no `UnknownPolicy`
  void count(std::span<const KeySegment> segments, std::span<PathCount> counts, UnknownPolicy unknown) const;

  /// Answers from `grid` from now on. What changed is found by comparing `grid` with the snapshot held; parts
  /// that both share are not read. So an edited copy costs little, and any grid is right.
  /// @throws std::invalid_argument if the resolution differs from the one this caster was made with
  void update(const VoxelGrid& grid);

  /// The map from which it answers at present; none for OctoMap's caster, which keeps no grid.
  [[nodiscard]] std::optional<VoxelGrid> grid() const { return do_grid(); }

  /// The lattice of its map's voxels.
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }

  /// Bytes this caster holds beside the grid's own (acceleration structure; 0 for a caster without one).
  [[nodiscard]] std::size_t memory_bytes() const { return do_memory_bytes(); }

 protected:
  /// For casters of voxels on this lattice.
  explicit RayCaster(const Lattice& lattice) : lattice_(lattice) {}

 private:
  // Spans are of equal size and not empty; rays and segments are unchecked.
  virtual void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const = 0;
  // Of one ray; none if `do_cast` has to answer.
  [[nodiscard]] virtual std::optional<RayStop> do_cast_end(const Ray& /*ray*/, UnknownPolicy /*unknown*/,
                                                           Eigen::Vector3f& /*end*/) const {
    return std::nullopt;
  }
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
  [[nodiscard]] virtual std::size_t do_memory_bytes() const { return 0; }

  Lattice lattice_;
};

/// The default of `make_ray_caster`: so many rays that building the fast caster pays.
inline constexpr std::uint64_t kManyRays = std::numeric_limits<std::uint64_t>::max();

/// The fast caster. It keeps two things beside the grid: a table of open voxels, through which packets of
/// rays walk, and Embree's BVH of boxes. Rays that nothing stops within 400 voxels, segments between voxels
/// further apart than 1000, segments between points if there are many, and whatever lies outside the table
/// go to the BVH. That is made, or follows an update, by the query with which they are 16,384 since then; the
/// ones before walk through the grid, and so do rays in sectors where few start of a map too wide for one
/// table. Where rounding could change an answer, castRay's own arithmetic decides. A batch takes up to 100 kB
/// of a thread's stack.
/// @param expected_rays  about how many rays will be cast before most of the map changes; too few to pay for
///                       building: `make_grid_ray_caster(grid)`
/// @throws std::runtime_error if `FRONTLUX_ISA` in the environment is none of its values (machine.hpp), and
///         by the query that needs the BVH if Embree cannot make its device
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_ray_caster(
    const VoxelGrid& grid, std::uint64_t expected_rays = kManyRays);

/// Embree's BVH of boxes, without tables. Where its rounding could change an answer, the grid's walk decides;
/// of a segment between voxels the grid is asked for the voxel before its end first, which blocks most that
/// are blocked.
/// @throws std::runtime_error if Embree cannot make its device, or for `FRONTLUX_ISA` as above
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid);

/// Walks the grid voxel by voxel: castRay's own traversal, with its rounding, over `VoxelGrid`. The
/// reference. Costs nothing to build, and shares the grid's memory.
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_grid_ray_caster(const VoxelGrid& grid);

}  // namespace frontlux
