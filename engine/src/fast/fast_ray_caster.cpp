#include "embree/box_snapshot.hpp"
#include "embree/scene_query.hpp"
#include "fast/map_tables.hpp"
#include "packet/table_query.hpp"
#include "parallel/by_policy.hpp"
#include "walk/snapshot_ray_caster.hpp"
#include "walk/walk.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <vector>

namespace frontlux {
namespace {

using detail::MapTables;

/// The blockers of a map in Embree's scenes, made when they are first needed.
class BoxesOnDemand {
  // To make them, or to follow a scan with those of a map of 0.1 to 0.3 m, takes as long as to walk so many
  // queries through the grid or more.
  static constexpr std::uint64_t kWorthBoxes = 1U << 14U;

 public:
  explicit BoxesOnDemand(const VoxelGrid& grid) : grid_(grid) {}
  BoxesOnDemand(const VoxelGrid& grid, const BoxesOnDemand& before) : grid_(grid), latest_(before.latest()) {}

  [[nodiscard]] const detail::BoxSnapshot& get() const {
    if (made_.load(std::memory_order_acquire) == nullptr) {
      const std::lock_guard lock(making_);
      // Isolated: a thread that waits here for its loops must not take up a query that waits for this lock.
      if (made_.load(std::memory_order_relaxed) == nullptr) run_isolated([this] { make(); });
    }
    return *made_.load(std::memory_order_acquire);
  }
  /// Whether boxes are there, or so much has been asked of the map, with these queries, that they soon pay
  /// off.
  [[nodiscard]] bool are_worth_it(std::size_t queries) const {
    return made_.load(std::memory_order_acquire) != nullptr ||
           asked_.fetch_add(queries, std::memory_order_relaxed) + queries >= kWorthBoxes;
  }
  /// Of those that are kept, be they of an earlier moment.
  [[nodiscard]] std::size_t memory_bytes() const {
    const auto kept = latest();
    return kept ? kept->memory_bytes() : 0;
  }

 private:
  void make() const {
    const auto before = latest();
    auto boxes = before ? std::make_shared<const detail::BoxSnapshot>(grid_, *before)
                        : std::make_shared<const detail::BoxSnapshot>(grid_);
    const std::lock_guard lock(keeping_);
    latest_ = std::move(boxes);
    made_.store(latest_.get(), std::memory_order_release);
  }
  // Waits for none that are being made.
  [[nodiscard]] std::shared_ptr<const detail::BoxSnapshot> latest() const {
    const std::lock_guard lock(keeping_);
    return latest_;
  }

  VoxelGrid grid_;
  mutable std::mutex making_, keeping_;
  mutable std::shared_ptr<const detail::BoxSnapshot> latest_;  // of this moment or an earlier one
  mutable std::atomic<const detail::BoxSnapshot*> made_{nullptr};
  mutable std::atomic<std::uint64_t> asked_{0};
};

/// A map as it was at one moment, with its open voxels in tables and its blockers in scenes.
class FastSnapshot {
 public:
  explicit FastSnapshot(const VoxelGrid& grid)
      : grid_(grid),
        boxes_(grid),
        tables_([&](UnknownPolicy unknown) { return std::make_unique<MapTables>(grid, unknown); }) {}
  FastSnapshot(const VoxelGrid& grid, const FastSnapshot& before)
      : grid_(grid), boxes_(grid, before.boxes_), tables_([&](UnknownPolicy unknown) {
          return std::make_unique<MapTables>(grid, before.tables_[unknown]);
        }) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  [[nodiscard]] const BoxesOnDemand& boxes() const { return boxes_; }
  [[nodiscard]] const MapTables& tables(UnknownPolicy unknown) const { return tables_[unknown]; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return boxes_.memory_bytes() + tables_[UnknownPolicy::kBlock].memory_bytes() +
           tables_[UnknownPolicy::kPass].memory_bytes();
  }

 private:
  VoxelGrid grid_;
  BoxesOnDemand boxes_;
  detail::ByPolicy<MapTables> tables_;
};

class FastRayCaster final : public detail::SnapshotRayCaster<FastSnapshot> {
 public:
  explicit FastRayCaster(const VoxelGrid& grid)
      : SnapshotRayCaster(std::make_shared<const FastSnapshot>(grid)) {}

 private:
  static constexpr std::size_t kWalks = 32;  // through the grid, by one thread
  static constexpr std::size_t kBatch = std::min(detail::BoxScene::kMaxBatch, detail::TableQuery::kMaxBatch);

  using Numbers = std::vector<std::size_t>;  // of queries

  // Tables answer what they can. The rest goes to the scene, or walks through the grid as long as that is
  // little. `ask` calls the tables or the scene.
  template <class Query, class Answer, class Ask>
  void answer(std::span<const Query> queries, std::span<Answer> answers, UnknownPolicy unknown,
              const Ask& ask) const {
    const auto now = snapshot();
    const auto* whole = now->tables(unknown).whole();
    const Numbers rest =
        whole ? ask_whole(detail::TableQuery(now->grid(), *whole, unknown, packets_), queries, answers, ask)
              : ask_sectors(*now, queries, answers, unknown, ask);
    if (rest.empty()) return;
    if (!now->boxes().are_worth_it(rest.size())) {
      for_each_chunk(rest.size(), kWalks, [&](std::size_t begin, std::size_t end) {
        for (const std::size_t i : std::span(rest).subspan(begin, end - begin))
          answers[i] = walk(now->grid(), queries[i], unknown);
      });
      return;
    }
    const detail::SceneQuery scene(now->boxes().get(), unknown);
    for_each_chunk(rest.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      ask_some(std::span(rest).subspan(begin, end - begin), queries, answers,
               [&](auto... batch) { ask(scene, batch...); });
    });
  }

  // @return what is not answered
  template <class Query, class Answer, class Ask>
  Numbers ask_whole(const detail::TableQuery& table, std::span<const Query> queries,
                    std::span<Answer> answers, const Ask& ask) const {
    std::mutex mutex;
    Numbers rest;
    for_each_chunk(queries.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      std::array<std::uint16_t, kBatch> left;
      const std::size_t size = ask(table, queries.subspan(begin, end - begin),
                                   answers.subspan(begin, end - begin), std::span(left));
      if (size == 0) return;
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < size; ++i) rest.push_back(begin + left[i]);
    });
    return rest;
  }

  // Each by the table of the sector in which it starts, or by a walk through the grid where there is none
  // yet.
  // @return what is not answered
  template <class Query, class Answer, class Ask>
  Numbers ask_sectors(const FastSnapshot& now, std::span<const Query> queries, std::span<Answer> answers,
                      UnknownPolicy unknown, const Ask& ask) const {
    constexpr std::uint32_t kNowhere = ~0U;
    struct Placed {
      std::uint32_t sector;
      std::size_t number;
      auto operator<=>(const Placed&) const = default;
    };
    const MapTables& tables = now.tables(unknown);
    std::mutex mutex;
    Numbers rest;
    for_each_chunk(queries.size(), kBatch, [&](std::size_t begin, std::size_t end) {
      std::array<Placed, kBatch> all;
      const std::span placed(all.data(), end - begin);
      for (std::size_t i = begin; i < end; ++i) {
        const auto key = start_of(now.grid().lattice(), queries[i]);
        placed[i - begin] = {key ? tables.sector_of(*key) : kNowhere, i};
      }
      std::sort(placed.begin(), placed.end());
      for (std::size_t first = 0, last = 0; first < placed.size(); first = last) {
        const std::uint32_t sector = placed[first].sector;
        std::array<std::size_t, kBatch> numbers;
        while (last < placed.size() && placed[last].sector == sector) {
          numbers[last - first] = placed[last].number;
          ++last;
        }
        const std::span<const std::size_t> theirs(numbers.data(), last - first);
        if (sector == kNowhere || !tables.is_worth_a_table(sector, theirs.size())) {
          for (const std::size_t i : theirs) answers[i] = walk(now.grid(), queries[i], unknown);
          continue;
        }
        std::array<std::uint16_t, kBatch> left;
        std::iota(left.begin(), left.end(), std::uint16_t{0});
        std::size_t left_size = theirs.size();
        if (const auto* table = tables.sector(sector))
          ask_some(theirs, queries, answers, [&](auto... batch) {
            const detail::TableQuery query(now.grid(), *table, unknown, packets_);
            left_size = ask(query, batch..., std::span(left));
          });
        if (left_size == 0) continue;
        const std::lock_guard lock(mutex);
        for (std::size_t i = 0; i < left_size; ++i) rest.push_back(theirs[left[i]]);
      }
    });
    return rest;
  }

  // Calls `ask_them` with the queries of some numbers next to each other.
  // @param numbers  at most `kBatch`
  template <class Query, class Answer, class AskThem>
  static void ask_some(std::span<const std::size_t> numbers, std::span<const Query> queries,
                       std::span<Answer> answers, const AskThem& ask_them) {
    std::array<Query, kBatch> some;
    std::array<Answer, kBatch> their_answers;
    for (std::size_t i = 0; i < numbers.size(); ++i) some[i] = queries[numbers[i]];
    ask_them(std::span<const Query>(some.data(), numbers.size()),
             std::span(their_answers.data(), numbers.size()));
    for (std::size_t i = 0; i < numbers.size(); ++i) answers[numbers[i]] = their_answers[i];
  }

  static std::optional<VoxelKey> start_of(const Lattice& lattice, const Ray& ray) {
    return lattice.key(ray.origin);
  }
  static std::optional<VoxelKey> start_of(const Lattice&, const KeySegment& segment) { return segment.from; }

  static Hit walk(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown) {
    return detail::walk_ray(grid, ray, unknown);
  }
  template <class Segment>
  static std::uint8_t walk(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown) {
    return detail::walk_visible(grid, segment, unknown) ? 1 : 0;
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    answer(rays, hits, unknown, [](const auto& by, auto... batch) { return by.cast(batch...); });
  }
  [[nodiscard]] std::optional<RayStop> do_cast_end(const Ray& ray, UnknownPolicy unknown,
                                                   Eigen::Vector3f& end) const override {
    const auto stop = with_snapshot([&](const FastSnapshot& now) -> std::optional<RayStop> {
      const auto* whole = now.tables(unknown).whole();
      if (whole == nullptr) return std::nullopt;
      return detail::TableQuery(now.grid(), *whole, unknown, packets_).end_alone(ray, end);
    });
    if (stop) return stop;
    const auto now = snapshot();
    if (now->tables(unknown).whole() == nullptr) return std::nullopt;
    Hit hit;  // not by `do_cast`, which would walk through the table once more
    if (now->boxes().are_worth_it(1))
      detail::SceneQuery(now->boxes().get(), unknown).cast({&ray, 1}, {&hit, 1});
    else
      hit = walk(now->grid(), ray, unknown);
    if (hit.stop != RayStop::kInvalid) end = hit.end;
    return hit.stop;
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    const auto now = snapshot();
    if (!now->boxes().are_worth_it(segments.size())) {
      for_each_chunk(segments.size(), kWalks, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) visible[i] = walk(now->grid(), segments[i], unknown);
      });
      return;
    }
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
