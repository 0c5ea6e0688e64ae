#include "batch.hpp"
#include "path_count.hpp"
#include "published.hpp"
#include "scene_query.hpp"
#include "snapshot.hpp"

#include <frontlux/ray_caster.hpp>

#include <memory>

namespace frontlux {
namespace {

class EmbreeRayCaster final : public RayCaster {
 public:
  explicit EmbreeRayCaster(const VoxelGrid& grid)
      : RayCaster(grid.lattice()),
        device_(detail::make_box_scene_device()),
        snapshot_(std::make_shared<detail::Snapshot>(grid, device_)) {}

  [[nodiscard]] std::size_t memory_bytes() const override {
    return detail::memory_bytes(*device_) + snapshot_.snapshot()->box_bytes();
  }

 private:
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    const auto snapshot = snapshot_.snapshot();
    const detail::SceneQuery query(*snapshot, unknown);
    detail::for_each_piece(rays.size(), detail::BoxScene::kMaxBatch, [&](std::size_t begin, std::size_t end) {
      query.cast(rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
    });
  }

  template <class Segment>
  void look(std::span<const Segment> segments, std::span<std::uint8_t> visible, UnknownPolicy unknown) const {
    const auto snapshot = snapshot_.snapshot();
    const detail::SceneQuery query(*snapshot, unknown);
    detail::for_each_piece(
        segments.size(), detail::BoxScene::kMaxBatch, [&](std::size_t begin, std::size_t end) {
          query.visible(segments.subspan(begin, end - begin), visible.subspan(begin, end - begin));
        });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    look(segments, visible, unknown);
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    look(segments, visible, unknown);
  }

  // Voxels have to be looked at one by one: the boxes do not tell.
  template <class Path>
  void count_paths(std::span<const Path> paths, std::span<PathCount> counts, UnknownPolicy unknown) const {
    const auto snapshot = snapshot_.snapshot();
    detail::for_each_piece(paths.size(), detail::BoxScene::kMaxBatch,
                           [&](std::size_t begin, std::size_t end) {
                             for (std::size_t i = begin; i < end; ++i)
                               counts[i] = detail::count_path(snapshot->grid(), paths[i], unknown);
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

  void do_update(const VoxelGrid& grid) override {
    snapshot_.replace(std::make_shared<detail::Snapshot>(grid, *snapshot_.snapshot()));
  }

  std::shared_ptr<detail::BoxSceneDevice> device_;
  detail::Published<detail::Snapshot> snapshot_;
};

}  // namespace

std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<EmbreeRayCaster>(grid);
}

}  // namespace frontlux
