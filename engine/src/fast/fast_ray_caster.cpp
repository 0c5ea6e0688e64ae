#include "embree/box_snapshot.hpp"
#include "embree/scene_query.hpp"
#include "packet/open_voxels.hpp"
#include "packet/table_query.hpp"
#include "parallel/by_policy.hpp"
#include "walk/snapshot_ray_caster.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace frontlux {
namespace {

/// A map as it was at one moment, with its blockers in scenes and its open voxels in tables.
class FastSnapshot {
 public:
  explicit FastSnapshot(const VoxelGrid& grid) : boxes_(grid), tables_(tables_of(grid)) {}
  FastSnapshot(const VoxelGrid& grid, const FastSnapshot& before)
      : boxes_(grid, before.boxes_), tables_(tables_of(grid)) {}

  [[nodiscard]] const VoxelGrid& grid() const { return boxes_.grid(); }
  [[nodiscard]] const detail::BoxSnapshot& boxes() const { return boxes_; }
  [[nodiscard]] const detail::OpenVoxels& table(UnknownPolicy unknown) const { return tables_[unknown]; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return boxes_.memory_bytes() + table(UnknownPolicy::kBlock).memory_bytes() +
           table(UnknownPolicy::kPass).memory_bytes();
  }

 private:
  static detail::ByPolicy<detail::OpenVoxels> tables_of(const VoxelGrid& grid) {
    return detail::ByPolicy<detail::OpenVoxels>(
        [&grid](UnknownPolicy unknown) { return std::make_unique<detail::OpenVoxels>(grid, unknown); });
  }

  detail::BoxSnapshot boxes_;
  detail::ByPolicy<detail::OpenVoxels> tables_;
};

class FastRayCaster final : public detail::SnapshotRayCaster<FastSnapshot> {
 public:
  explicit FastRayCaster(const VoxelGrid& grid)
      : SnapshotRayCaster(std::make_shared<const FastSnapshot>(grid)) {}

 private:
  static constexpr std::size_t kBatch = std::min(detail::BoxScene::kMaxBatch, detail::TableQuery::kMaxBatch);

  // The table answers what it can. The rest goes to the scene. `ask` calls the one or the other.
  template <class Query, class Answer, class Ask>
  void answer(std::span<const Query> queries, std::span<Answer> answers, UnknownPolicy unknown,
              const Ask& ask) const {
    const auto now = snapshot();
    const detail::TableQuery table(now->grid(), now->table(unknown), unknown, packets_);
    const detail::SceneQuery scene(now->boxes(), unknown);
    for_each_chunk(queries.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      const auto some = queries.subspan(begin, end - begin);
      const auto some_answers = answers.subspan(begin, end - begin);
      std::array<std::uint16_t, kBatch> rest;
      const std::size_t size = ask(table, some, some_answers, std::span(rest));
      if (size == 0) return;
      std::array<Query, kBatch> long_ones;
      std::array<Answer, kBatch> their_answers;
      for (std::size_t i = 0; i < size; ++i) long_ones[i] = some[rest[i]];
      ask(scene, std::span<const Query>(long_ones.data(), size), std::span(their_answers.data(), size));
      for (std::size_t i = 0; i < size; ++i) some_answers[rest[i]] = their_answers[i];
    });
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    answer(rays, hits, unknown, [](const auto& by, auto... batch) { return by.cast(batch...); });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    const auto now = snapshot();
    const detail::SceneQuery scene(now->boxes(), unknown);
    for_each_chunk(segments.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      scene.visible(segments.subspan(begin, end - begin), visible.subspan(begin, end - begin));
    });
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    answer(segments, visible, unknown, [](const auto& by, auto... batch) { return by.visible(batch...); });
  }

  [[nodiscard]] std::size_t do_memory_bytes() const override { return snapshot()->memory_bytes(); }

  const detail::PacketWalk& packets_ = detail::packet_walk();
};

// To build the fast caster takes time for each brick of mixed states; each ray then saves a tenth to a third
// of a microsecond (docs/benchmarking.md).
bool repay_building(std::uint64_t rays, const VoxelGrid& grid) {
  constexpr std::uint64_t kRaysPerBrick = 12;
  std::uint64_t bricks = 0;
  grid.for_each_block(
      [&](const Block&, const Brick* brick, Occupancy) { bricks += brick != nullptr ? 1 : 0; });
  return rays >= kRaysPerBrick * bricks;
}

}  // namespace

std::unique_ptr<RayCaster> make_ray_caster(const VoxelGrid& grid, std::uint64_t expected_rays) {
  if (expected_rays != kManyRays && !repay_building(expected_rays, grid)) return make_grid_ray_caster(grid);
  return std::make_unique<FastRayCaster>(grid);
}

}  // namespace frontlux
