#include "embree/box_snapshot.hpp"
#include "embree/scene_query.hpp"
#include "walk/snapshot_ray_caster.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>

namespace frontlux {
namespace {

class EmbreeRayCaster final : public detail::SnapshotRayCaster<detail::BoxSnapshot> {
 public:
  explicit EmbreeRayCaster(const VoxelGrid& grid)
      : SnapshotRayCaster(std::make_shared<const detail::BoxSnapshot>(grid)) {}

 private:
  template <class Query, class Answer, class Batch>
  void answer(std::span<const Query> queries, std::span<Answer> answers, UnknownPolicy unknown,
              const Batch& batch) const {
    const auto now = snapshot();
    const detail::SceneQuery scene(*now, unknown);
    for_each_chunk(queries.size(), detail::BoxScene::kMaxBatch, [&](std::size_t begin, std::size_t end) {
      batch(scene, queries.subspan(begin, end - begin), answers.subspan(begin, end - begin));
    });
  }
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    answer(rays, hits, unknown, [](const auto& scene, auto... batch) { scene.cast(batch...); });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    answer(segments, visible, unknown, [](const auto& scene, auto... batch) { scene.visible(batch...); });
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    answer(segments, visible, unknown, [](const auto& scene, auto... batch) { scene.visible(batch...); });
  }

  [[nodiscard]] std::size_t do_memory_bytes() const override { return snapshot()->memory_bytes(); }
};

}  // namespace

std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<EmbreeRayCaster>(grid);
}

}  // namespace frontlux
