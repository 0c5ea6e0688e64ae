#pragma once

#include "parallel/answer_each.hpp"
#include "parallel/latest.hpp"
#include "walk/path_count.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <memory>
#include <optional>
#include <span>

namespace frontlux::detail {

/// A caster that answers from a snapshot of the map. `update` makes the next snapshot while queries go on
/// with the present one. All of them count in the same manner: voxel by voxel through the grid.
/// @tparam Snapshot  has `grid()`, and is made from a grid and the snapshot before
template <class Snapshot>
class SnapshotRayCaster : public RayCaster {
 protected:
  explicit SnapshotRayCaster(const std::shared_ptr<const Snapshot>& first)
      : RayCaster(first->grid().lattice()), latest_(first) {}

  [[nodiscard]] std::shared_ptr<const Snapshot> snapshot() const { return latest_.get(); }
  /// What `use` makes of it; `update` waits meanwhile.
  template <class Use>
  [[nodiscard]] auto with_snapshot(const Use& use) const {
    return latest_.with(use);
  }

 private:
  template <class Path>
  void count_paths(std::span<const Path> paths, std::span<PathCount> counts, UnknownPolicy unknown) const {
    const auto now = snapshot();
    answer_each(paths, counts, [&](const Path& path) { return count_path(now->grid(), path, unknown); });
  }
  void do_count(std::span<const Ray> rays, std::span<PathCount> counts, UnknownPolicy unknown) const final {
    count_paths(rays, counts, unknown);
  }
  void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const final {
    count_paths(segments, counts, unknown);
  }
  void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const final {
    count_paths(segments, counts, unknown);
  }

  void do_update(const VoxelGrid& grid) final {
    latest_.set(std::make_shared<const Snapshot>(grid, *snapshot()));
  }
  [[nodiscard]] std::optional<VoxelGrid> do_grid() const final { return snapshot()->grid(); }

  Latest<Snapshot> latest_;
};

}  // namespace frontlux::detail
