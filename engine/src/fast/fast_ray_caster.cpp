#include "embree/box_snapshot.hpp"
#include "embree/scene_query.hpp"
#include "packet/open_voxels.hpp"
#include "packet/table_query.hpp"
#include "parallel/by_policy.hpp"
#include "parallel/spare.hpp"
#include "walk/snapshot_ray_caster.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace frontlux {
namespace {

using detail::OpenVoxels;

/// A table and the map that it was made of.
struct MapTable {
  OpenVoxels table;
  VoxelGrid grid;
};

/// The open voxels of a map under one policy.
class TableOfMoment {
 public:
  TableOfMoment(const VoxelGrid& grid, UnknownPolicy unknown, std::shared_ptr<detail::Spare<MapTable>> spare)
      : spare_(std::move(spare)), of_(spare_->take()) {
    if (of_ && of_->table.update(of_->grid, grid))
      of_->grid = grid;
    else
      of_ = std::make_unique<MapTable>(MapTable{OpenVoxels(grid, unknown), grid});
  }
  ~TableOfMoment() { spare_->give_back(std::move(of_)); }
  TableOfMoment(const TableOfMoment&) = delete;
  TableOfMoment& operator=(const TableOfMoment&) = delete;

  [[nodiscard]] const OpenVoxels& table() const { return of_->table; }
  [[nodiscard]] const std::shared_ptr<detail::Spare<MapTable>>& spare() const { return spare_; }
  /// With the spare one.
  [[nodiscard]] std::size_t memory_bytes() const {
    return table().memory_bytes() +
           spare_->measured([](const MapTable& spare) { return spare.table.memory_bytes(); });
  }

 private:
  std::shared_ptr<detail::Spare<MapTable>> spare_;
  std::unique_ptr<MapTable> of_;
};

/// The blockers of a map in Embree's scenes, made when they are first needed.
class BoxesOnDemand {
 public:
  explicit BoxesOnDemand(const VoxelGrid& grid) : grid_(grid) {}
  BoxesOnDemand(const VoxelGrid& grid, const BoxesOnDemand& before) : grid_(grid), before_(before.latest()) {}

  [[nodiscard]] const detail::BoxSnapshot& get() const {
    if (made_.load(std::memory_order_acquire) == nullptr) {
      const std::lock_guard lock(mutex_);
      // Isolated: a thread that waits here for its loops must not take up a query that waits for this lock.
      if (!boxes_) run_isolated([this] { make(); });
    }
    return *made_.load(std::memory_order_acquire);
  }
  /// Of those that are kept, be they of an earlier moment.
  [[nodiscard]] std::size_t memory_bytes() const {
    const auto kept = latest();
    return kept ? kept->memory_bytes() : 0;
  }

 private:
  void make() const {
    boxes_ = before_ ? std::make_shared<const detail::BoxSnapshot>(grid_, *before_)
                     : std::make_shared<const detail::BoxSnapshot>(grid_);
    before_.reset();
    made_.store(boxes_.get(), std::memory_order_release);
  }
  [[nodiscard]] std::shared_ptr<const detail::BoxSnapshot> latest() const {
    const std::lock_guard lock(mutex_);
    return boxes_ ? boxes_ : before_;
  }

  VoxelGrid grid_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const detail::BoxSnapshot> before_, boxes_;
  mutable std::atomic<const detail::BoxSnapshot*> made_{nullptr};
};

/// A map as it was at one moment, with its open voxels in tables and its blockers in scenes.
class FastSnapshot {
 public:
  explicit FastSnapshot(const VoxelGrid& grid)
      : grid_(grid), boxes_(grid), tables_([&](UnknownPolicy unknown) {
          return std::make_unique<TableOfMoment>(grid, unknown, std::make_shared<detail::Spare<MapTable>>());
        }) {}
  FastSnapshot(const VoxelGrid& grid, const FastSnapshot& before)
      : grid_(grid), boxes_(grid, before.boxes_), tables_([&](UnknownPolicy unknown) {
          return std::make_unique<TableOfMoment>(grid, unknown, before.tables_[unknown].spare());
        }) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  [[nodiscard]] const BoxesOnDemand& boxes() const { return boxes_; }
  [[nodiscard]] const OpenVoxels& table(UnknownPolicy unknown) const { return tables_[unknown].table(); }
  [[nodiscard]] std::size_t memory_bytes() const {
    return boxes_.memory_bytes() + tables_[UnknownPolicy::kBlock].memory_bytes() +
           tables_[UnknownPolicy::kPass].memory_bytes();
  }

 private:
  VoxelGrid grid_;
  BoxesOnDemand boxes_;
  detail::ByPolicy<TableOfMoment> tables_;
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
    std::mutex mutex;
    std::vector<std::size_t> rest;
    for_each_chunk(queries.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      std::array<std::uint16_t, kBatch> left;
      const std::size_t size = ask(table, queries.subspan(begin, end - begin),
                                   answers.subspan(begin, end - begin), std::span(left));
      if (size == 0) return;
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < size; ++i) rest.push_back(begin + left[i]);
    });
    if (rest.empty()) return;
    const detail::SceneQuery scene(now->boxes().get(), unknown);
    for_each_chunk(rest.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      std::array<Query, kBatch> some;
      std::array<Answer, kBatch> their_answers;
      const std::size_t size = end - begin;
      for (std::size_t i = 0; i < size; ++i) some[i] = queries[rest[begin + i]];
      ask(scene, std::span<const Query>(some.data(), size), std::span(their_answers.data(), size));
      for (std::size_t i = 0; i < size; ++i) answers[rest[begin + i]] = their_answers[i];
    });
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    answer(rays, hits, unknown, [](const auto& by, auto... batch) { return by.cast(batch...); });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    const auto now = snapshot();
    const detail::SceneQuery scene(now->boxes().get(), unknown);
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
  constexpr std::uint64_t kRaysPerBrick = 4;
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
