#include "embree/embree_ray_caster.hpp"

#include "parallel/batch.hpp"
#include "walk/path_count.hpp"
#include "parallel/published.hpp"
#include "embree/scene_query.hpp"
#include "embree/snapshot.hpp"
#include "packet/table_query.hpp"

#include <frontlux/ray_caster.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace frontlux {
namespace {

class EmbreeRayCaster final : public RayCaster {
 public:
  /// @param packets  null keeps the table out of use
  EmbreeRayCaster(const VoxelGrid& grid, const detail::PacketWalk* packets)
      : RayCaster(grid.lattice()),
        packets_(packets),
        device_(detail::make_box_scene_device()),
        snapshot_(std::make_shared<detail::Snapshot>(grid, device_)) {}

  [[nodiscard]] std::size_t memory_bytes() const override {
    return detail::memory_bytes(*device_) + snapshot_.snapshot()->memory_bytes();
  }

 private:
  static constexpr std::size_t kBatch = std::min(detail::BoxScene::kMaxBatch, detail::TableQuery::kMaxBatch);

  // The table answers what it can, the scene what is left.
  template <class Query, class Answer, class ByTable, class ByScene>
  static void answer(std::span<const Query> queries, std::span<Answer> answers, const ByTable& by_table,
                     const ByScene& by_scene) {
    detail::for_each_piece(queries.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      const auto some = queries.subspan(begin, end - begin);
      const auto some_answers = answers.subspan(begin, end - begin);
      std::array<std::uint16_t, kBatch> left;
      const std::size_t size = by_table(some, some_answers, std::span(left));
      if (size == 0) return;
      std::array<Query, kBatch> hard;
      std::array<Answer, kBatch> hard_answers;
      for (std::size_t i = 0; i < size; ++i) hard[i] = some[left[i]];
      by_scene(std::span<const Query>(hard.data(), size), std::span(hard_answers.data(), size));
      for (std::size_t i = 0; i < size; ++i) some_answers[left[i]] = hard_answers[i];
    });
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    const auto snapshot = snapshot_.snapshot();
    const detail::TableQuery table(snapshot->grid(), snapshot->open(unknown), unknown, packets_);
    const detail::SceneQuery scene(*snapshot, unknown);
    answer(
        rays, hits, [&](auto some, auto out, auto left) { return table.cast(some, out, left); },
        [&](auto some, auto out) { scene.cast(some, out); });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    const auto snapshot = snapshot_.snapshot();
    const detail::SceneQuery scene(*snapshot, unknown);
    detail::for_each_piece(segments.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      scene.visible(segments.subspan(begin, end - begin), visible.subspan(begin, end - begin));
    });
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    const auto snapshot = snapshot_.snapshot();
    const detail::TableQuery table(snapshot->grid(), snapshot->open(unknown), unknown, packets_);
    const detail::SceneQuery scene(*snapshot, unknown);
    answer(
        segments, visible, [&](auto some, auto out, auto left) { return table.visible(some, out, left); },
        [&](auto some, auto out) { scene.visible(some, out); });
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

  [[nodiscard]] std::optional<VoxelGrid> do_grid() const override { return snapshot_.snapshot()->grid(); }

  const detail::PacketWalk* packets_;
  std::shared_ptr<detail::BoxSceneDevice> device_;
  detail::Published<detail::Snapshot> snapshot_;
};

}  // namespace

std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<EmbreeRayCaster>(grid, detail::packet_walk());
}

std::unique_ptr<RayCaster> detail::make_scene_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<EmbreeRayCaster>(grid, nullptr);
}

}  // namespace frontlux
