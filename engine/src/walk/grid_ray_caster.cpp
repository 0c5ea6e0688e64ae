#include "parallel/batch.hpp"
#include "walk/path_count.hpp"
#include "parallel/published.hpp"
#include "walk/walk.hpp"

#include <frontlux/ray_caster.hpp>

namespace frontlux {
namespace {

class GridRayCaster final : public RayCaster {
 public:
  explicit GridRayCaster(const VoxelGrid& grid)
      : RayCaster(grid.lattice()), grid_(std::make_shared<VoxelGrid>(grid)) {}

 private:
  static constexpr std::size_t kGrain = 256;

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    const auto grid = grid_.snapshot();
    detail::for_each_piece(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) hits[i] = detail::walk_ray(*grid, rays[i], unknown);
    });
  }

  template <class Segment>
  void walk(std::span<const Segment> segments, std::span<std::uint8_t> visible, UnknownPolicy unknown) const {
    const auto grid = grid_.snapshot();
    detail::for_each_piece(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        visible[i] = static_cast<std::uint8_t>(detail::walk_visible(*grid, segments[i], unknown));
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

  template <class Path>
  void count_paths(std::span<const Path> paths, std::span<PathCount> counts, UnknownPolicy unknown) const {
    const auto grid = grid_.snapshot();
    detail::for_each_piece(paths.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) counts[i] = detail::count_path(*grid, paths[i], unknown);
    });
  }
  void do_count(std::span<const Ray> rays, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(rays, counts, unknown);
  }
  void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(segments, counts, unknown);
  }
  void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(segments, counts, unknown);
  }

  void do_update(const VoxelGrid& grid) override { grid_.replace(std::make_shared<VoxelGrid>(grid)); }

  [[nodiscard]] std::optional<VoxelGrid> do_grid() const override { return *grid_.snapshot(); }

  detail::Published<VoxelGrid> grid_;
};

}  // namespace

std::unique_ptr<RayCaster> make_grid_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<GridRayCaster>(grid);
}

}  // namespace frontlux
