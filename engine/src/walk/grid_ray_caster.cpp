#include "walk/snapshot_ray_caster.hpp"
#include "walk/walk.hpp"

namespace frontlux {
namespace {

class GridSnapshot {
 public:
  explicit GridSnapshot(const VoxelGrid& grid) : grid_(grid) {}
  GridSnapshot(const VoxelGrid& grid, const GridSnapshot&) : grid_(grid) {}
  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }

 private:
  VoxelGrid grid_;
};

class GridRayCaster final : public detail::SnapshotRayCaster<GridSnapshot> {
 public:
  explicit GridRayCaster(const VoxelGrid& grid)
      : SnapshotRayCaster(std::make_shared<const GridSnapshot>(grid)) {}

 private:
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    const auto now = snapshot();
    detail::answer_each(rays, hits,
                        [&](const Ray& ray) { return detail::walk_ray(now->grid(), ray, unknown); });
  }

  template <class AnySegment>
  void walk(std::span<const AnySegment> segments, std::span<std::uint8_t> visible,
            UnknownPolicy unknown) const {
    const auto now = snapshot();
    detail::answer_each(segments, visible, [&](const AnySegment& segment) {
      return detail::walk_visible(now->grid(), segment, unknown);
    });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    walk(segments, visible, unknown);
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    walk(segments, visible, unknown);
  }
};

}  // namespace

std::unique_ptr<RayCaster> make_grid_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<GridRayCaster>(grid);
}

}  // namespace frontlux
