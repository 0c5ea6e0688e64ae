#include "assignment/corridor_blocks.hpp"
#include "assignment/occlusion.hpp"
#include "assignment/view_offsets.hpp"
#include "assignment/visibility_flood.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/view_region.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

using detail::BlockCells, detail::CorridorBlocks, detail::Occlusion, detail::VisibilityFlood;

constexpr std::size_t kBatch = 256;             // frontiers that one thread decides together
constexpr std::size_t kSome = 48, kMany = 512;  // rays for one frontier in a round
constexpr std::size_t kSpread = 64;  // cells from all over the region, tested before any are listed
constexpr int kNearby = 4;           // [voxels] greatest distance of the first cells tested

// What all frontiers of an agent need.
struct Search {
  const RayCaster& caster;
  std::span<const VoxelKey> frontiers;
  std::span<const FrontierViewpoint> previous_viewpoints;
  std::span<const VoxelKey> unseen;
  ViewRegion region;
  CorridorBlocks blocks;
  std::optional<VisibilityFlood> flood;
  Occlusion occlusion;  // without `flood`
  std::vector<std::array<int, 3>> nearby, spread;

  [[nodiscard]] bool in_view(const VoxelKey& frontier, const VoxelKey& cell) const {
    return region.contains(frontier.x - cell.x, frontier.y - cell.y, frontier.z - cell.z);
  }
};

// Decides some frontiers by rounds of rays, a few for each undecided one. The cells tested are first those
// that saw the frontier before, then cells nearby, the viewpoints of its neighbours, some cells of the whole
// region, and last all others.
class Batch {
 public:
  Batch(const Search& search, std::size_t begin, std::size_t end)
      : search_(search), begin_(begin), seen_from_(end - begin), candidates_(end - begin) {
    for (std::size_t i = begin; i < end; ++i)
      if (search.blocks.may_be_near(search.frontiers[i], search.region.reach(),
                                    search.region.greatest_height()) &&
          !std::binary_search(search.unseen.begin(), search.unseen.end(), search.frontiers[i]))
        undecided_.push_back(static_cast<std::uint32_t>(i - begin));
  }

  void decide() {
    add_previous_viewpoints();
    cast();
    for (const std::uint32_t i : undecided_)
      if (search_.blocks.may_be_near(frontier(i), kNearby, kNearby)) add_offsets(i, search_.nearby, 2);
    cast();
    test_neighbours_viewpoints();
    test_neighbours_viewpoints();
    if (search_.flood)
      decide_by_flood(*search_.flood);
    else
      decide_by_blocks();
  }

  [[nodiscard]] const std::vector<std::optional<VoxelKey>>& seen_from() const { return seen_from_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  // Cells that a frontier has not tested yet.
  struct Candidates {
    std::vector<const CorridorBlocks::Cube*> cubes;
    std::size_t next_cube = 0;
    std::vector<BlockCells> blocks;  // some of their cells may be out of view
    std::size_t next_block = 0;
  };

  [[nodiscard]] const VoxelKey& frontier(std::uint32_t i) const { return search_.frontiers[begin_ + i]; }

  void add(std::uint32_t i, const VoxelKey& cell) {
    segments_.push_back({cell, frontier(i)});
    frontier_of_segment_.push_back(i);
  }

  // Casts the segments added, and removes the frontiers that they decide.
  void cast() {
    if (segments_.empty()) return;
    visible_.resize(segments_.size());
    search_.caster.visible(std::span<const KeySegment>(segments_), visible_, UnknownPolicy::kPass);
    rays_ += segments_.size();
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      const std::uint32_t i = frontier_of_segment_[k];
      if (visible_[k] == 0 || seen_from_[i]) continue;
      seen_from_[i] = segments_[k].from;
      candidates_[i] = {};
    }
    std::erase_if(undecided_, [this](std::uint32_t i) { return seen_from_[i].has_value(); });
    segments_.clear();
    frontier_of_segment_.clear();
  }

  void add_previous_viewpoints() {
    const auto& previous = search_.previous_viewpoints;
    for (const std::uint32_t i : undecided_) {
      const auto found = std::lower_bound(
          previous.begin(), previous.end(), frontier(i),
          [](const FrontierViewpoint& before, const VoxelKey& key) { return before.frontier < key; });
      if (found != previous.end() && found->frontier == frontier(i) && search_.blocks.contains(found->cell) &&
          search_.in_view(frontier(i), found->cell))
        add(i, found->cell);
    }
  }

  void add_offsets(std::uint32_t i, const std::vector<std::array<int, 3>>& offsets, std::size_t most) {
    std::size_t added = 0;
    for (const auto& [x, y, z] : offsets) {
      const auto cell = offset_key(frontier(i), -x, -y, -z);
      if (!cell || !search_.blocks.contains(*cell)) continue;
      add(i, *cell);
      if (++added == most) return;
    }
  }

  // Frontiers next to each other are often seen from the same cell.
  void test_neighbours_viewpoints() {
    constexpr std::size_t kSteps = 64;
    for (const std::uint32_t i : undecided_) {
      std::optional<VoxelKey> added;
      const auto add_viewpoint_of = [&](std::size_t neighbour) {
        const auto& cell = seen_from_[neighbour];
        if (!cell || cell == added || !search_.in_view(frontier(i), *cell)) return false;
        added = cell;
        add(i, *cell);
        return true;
      };
      for (std::size_t k = i; k > 0 && i - k < kSteps && !add_viewpoint_of(k - 1);) --k;
      for (std::size_t k = i + 1; k < seen_from_.size() && k - i <= kSteps && !add_viewpoint_of(k);) ++k;
    }
    cast();
  }

  // For corridors with many cells. A frontier that none of some cells of the whole region sees mostly stays
  // undecided to the end. Only for such frontiers is it worth finding the cells from which rays may arrive.
  void decide_by_flood(const VisibilityFlood& flood) {
    for (const std::uint32_t i : undecided_) add_offsets(i, search_.spread, kSpread);
    cast();
    test_neighbours_viewpoints();
    const std::vector<std::uint32_t> undecided = std::move(undecided_);
    VisibilityFlood::Row row;
    std::vector<VoxelKey> cells;
    for (const std::uint32_t i : undecided) {
      undecided_ = {i};
      test_neighbours_viewpoints();
      if (undecided_.empty()) continue;
      cells.clear();
      flood.cells(frontier(i), row, cells);
      // Some of the whole region first.
      const std::size_t stride = std::max<std::size_t>(1, cells.size() / kSome);
      for (std::size_t k = stride / 2; k < cells.size(); k += stride) add(i, cells[k]);
      cast();
      if (stride == 1) continue;
      for (std::size_t k = 0; k < cells.size() && !undecided_.empty();) {
        for (const std::size_t end = std::min(cells.size(), k + kMany); k < end; ++k)
          if (k % stride != stride / 2) add(i, cells[k]);
        cast();
      }
    }
    undecided_.clear();
  }

  // For corridors with few cells, and for regions that are too high for columns of bits.
  void decide_by_blocks() {
    for (const std::uint32_t i : undecided_)
      candidates_[i].cubes = search_.blocks.cubes_near(frontier(i), search_.region);
    for (std::size_t cubes = 2; add_one_per_block(cubes); cubes *= 4) {
      cast();
      test_neighbours_viewpoints();
    }
    for (std::size_t cells = 64; add_rest(cells); cells = std::min<std::size_t>(4 * cells, 1024)) {
      cast();
      test_neighbours_viewpoints();
    }
  }

  // For every frontier one cell of each block in the next cubes. Returns whether there was a cube left.
  bool add_one_per_block(std::size_t count) {
    bool any = false;
    for (const std::uint32_t i : undecided_) {
      Candidates& mine = candidates_[i];
      for (std::size_t n = 0; n < count && mine.next_cube < mine.cubes.size(); ++n) {
        any = true;
        add_one_per_block(i, *mine.cubes[mine.next_cube++]);
      }
    }
    return any;
  }

  void add_one_per_block(std::uint32_t i, const CorridorBlocks::Cube& cube) {
    const VoxelKey& f = frontier(i);
    if (search_.occlusion.hides(f, frontlux::cube(cube.corner, CorridorBlocks::kCube))) return;
    cube.for_each_block([&](const BlockCells& block) {
      if (!search_.region.may_contain_voxel({f, f}, frontlux::cube(block.corner, CorridorBlocks::kBlock)))
        return;
      BlockCells cells = block;
      int bit = middle_bit(cells.bits);
      if (!search_.in_view(f, cells.key(bit))) {
        cells = detail::feasible_cells(block, f, search_.region);
        if (cells.bits == 0) return;
        bit = middle_bit(cells.bits);
      }
      cells.bits &= ~(std::uint64_t{1} << bit);
      add(i, cells.key(bit));
      if (cells.bits != 0) candidates_[i].blocks.push_back(cells);
    });
  }

  // For every frontier at least so many of its other cells. Returns whether there was a block left.
  bool add_rest(std::size_t count) {
    bool any = false;
    for (const std::uint32_t i : undecided_) {
      Candidates& mine = candidates_[i];
      for (std::size_t n = 0; n < count && mine.next_block < mine.blocks.size();) {
        any = true;
        const BlockCells block = mine.blocks[mine.next_block++];
        if (search_.occlusion.hides(frontier(i), frontlux::cube(block.corner, CorridorBlocks::kBlock)))
          continue;
        BlockCells cells = detail::feasible_cells(block, frontier(i), search_.region);
        for (; cells.bits != 0; cells.bits &= cells.bits - 1, ++n)
          add(i, cells.key(std::countr_zero(cells.bits)));
      }
    }
    return any;
  }

  // The middle one of the bits that are set.
  static int middle_bit(std::uint64_t bits) {
    for (int skip = std::popcount(bits) / 2; skip > 0; --skip) bits &= bits - 1;
    return std::countr_zero(bits);
  }

  const Search& search_;
  std::size_t begin_;
  std::vector<std::optional<VoxelKey>> seen_from_;
  std::vector<Candidates> candidates_;
  std::vector<std::uint32_t> undecided_;
  std::vector<KeySegment> segments_;
  std::vector<std::uint32_t> frontier_of_segment_;
  std::vector<std::uint8_t> visible_;
  std::uint64_t rays_ = 0;
};

}  // namespace

AssignedFrontiers find_visible_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                         std::span<const VoxelKey> frontiers, const FrontierAgent& agent) {
  if (frontiers.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument(std::to_string(frontiers.size()) + " frontiers are more than 32 bits count");
  ViewRegion region(agent.view, grid.resolution());
  if (frontiers.empty() || agent.corridor.empty()) return {};
  const KeyBox bounds = bounds_of(frontiers);
  const int reach = region.reach();
  auto nearby = detail::nearby_offsets(region, kNearby);
  auto spread = detail::spread_offsets(region, kSpread);
  CorridorBlocks blocks(agent.corridor);
  auto flood = blocks.deep() ? VisibilityFlood::make(grid, agent.corridor, region, bounds) : std::nullopt;
  Occlusion occlusion = flood ? Occlusion() : Occlusion(grid, grown(bounds, reach));
  const Search search{caster,
                      frontiers,
                      agent.previous_viewpoints,
                      agent.unseen,
                      std::move(region),
                      std::move(blocks),
                      std::move(flood),
                      std::move(occlusion),
                      std::move(nearby),
                      std::move(spread)};
  std::vector<AssignedFrontiers> found((frontiers.size() + kBatch - 1) / kBatch);
  for_each_index(found.size(), [&](std::size_t b) {
    const std::size_t begin = b * kBatch;
    Batch batch(search, begin, std::min(frontiers.size(), begin + kBatch));
    batch.decide();
    for (std::size_t i = 0; i < batch.seen_from().size(); ++i)
      if (const auto& cell = batch.seen_from()[i]) {
        found[b].frontiers.push_back(static_cast<std::uint32_t>(begin + i));
        found[b].seen_from.push_back(*cell);
      }
    found[b].rays = batch.rays();
  });
  AssignedFrontiers all;
  for (const AssignedFrontiers& part : found) {
    all.frontiers.insert(all.frontiers.end(), part.frontiers.begin(), part.frontiers.end());
    all.seen_from.insert(all.seen_from.end(), part.seen_from.begin(), part.seen_from.end());
    all.rays += part.rays;
  }
  return all;
}

FrontierAssignment assign_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                    std::span<const VoxelKey> frontiers,
                                    std::span<const FrontierAgent> agents) {
  FrontierAssignment result;
  result.unassigned.resize(frontiers.size());
  std::iota(result.unassigned.begin(), result.unassigned.end(), 0U);
  std::vector<VoxelKey> unassigned(frontiers.begin(), frontiers.end());
  for (const FrontierAgent& agent : agents) {
    AssignedFrontiers assigned = find_visible_frontiers(caster, grid, unassigned, agent);
    std::size_t kept = 0, next = 0;
    for (std::size_t i = 0; i < unassigned.size(); ++i) {
      if (next < assigned.frontiers.size() && assigned.frontiers[next] == i) {
        assigned.frontiers[next++] = result.unassigned[i];
        continue;
      }
      result.unassigned[kept] = result.unassigned[i];
      unassigned[kept++] = unassigned[i];
    }
    result.unassigned.resize(kept);
    unassigned.resize(kept);
    result.assigned.push_back(std::move(assigned));
  }
  return result;
}

}  // namespace frontlux::planner
