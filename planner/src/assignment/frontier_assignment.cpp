#include "assignment/corridor_blocks.hpp"
#include "assignment/occlusion.hpp"
#include "assignment/view_offsets.hpp"
#include "assignment/visibility_flood.hpp"

#include <frontlux/planner/frontier_assignment.hpp>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

using detail::BlockCells;
using detail::CorridorBlocks;
using detail::Occlusion;
using detail::VisibilityFlood;

constexpr std::size_t kPiece = 256;             // frontiers that are decided together, on one thread
constexpr std::size_t kSome = 48, kMany = 512;  // rays for one frontier at a time
constexpr std::size_t kSpread = 64;             // cells from all over the region, tried before any are listed
constexpr int kNearby = 4;                      // [voxels] how far the first cells tried may be

// What all frontiers of an agent need.
struct Search {
  const RayCaster& caster;
  std::span<const VoxelKey> frontiers;
  std::span<const FrontierSight> tried_first;
  std::span<const VoxelKey> unseen;
  ViewRegion view;
  CorridorBlocks blocks;
  std::optional<VisibilityFlood> approach;
  Occlusion shadow;  // without `approach`
  std::vector<std::array<int, 3>> nearby, spread;
};

// Decides some frontiers by rounds of rays, a few for each that is undecided: from where it was seen before,
// from cells nearby, from where its neighbours are seen, from some cells of everywhere, from all others.
class Piece {
 public:
  Piece(const Search& search, std::size_t begin, std::size_t end)
      : search_(search), begin_(begin), seen_from_(end - begin), left_(end - begin) {
    for (std::size_t i = begin; i < end; ++i)
      if (search.blocks.may_be_near(search.frontiers[i], search.view.reach(),
                                    search.view.greatest_height()) &&
          !std::binary_search(search.unseen.begin(), search.unseen.end(), search.frontiers[i]))
        open_.push_back(static_cast<std::uint32_t>(i - begin));
  }

  void decide() {
    try_first();
    for (const std::uint32_t i : open_)
      if (search_.blocks.may_be_near(frontier(i), kNearby, kNearby)) try_offsets(i, search_.nearby, 2);
    cast();
    ask_neighbours();
    ask_neighbours();
    if (search_.approach)
      decide_by_flood();
    else
      decide_by_blocks();
  }

  [[nodiscard]] const std::vector<std::optional<VoxelKey>>& seen_from() const { return seen_from_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  // Candidates that a frontier has not tried yet.
  struct Left {
    std::vector<const CorridorBlocks::Cube*> cubes;
    std::size_t next_cube = 0;
    std::vector<BlockCells> blocks;  // with cells not tried, some of them perhaps out of view
    std::size_t next_block = 0;
  };

  [[nodiscard]] const VoxelKey& frontier(std::uint32_t i) const { return search_.frontiers[begin_ + i]; }

  void add(std::uint32_t i, const VoxelKey& cell) {
    segments_.push_back({cell, frontier(i)});
    owners_.push_back(i);
  }

  // Casts what has been added and leaves out the frontiers that it decides.
  void cast() {
    if (segments_.empty()) return;
    visible_.resize(segments_.size());
    search_.caster.visible(std::span<const KeySegment>(segments_), visible_, UnknownPolicy::kPass);
    rays_ += segments_.size();
    for (std::size_t k = 0; k < segments_.size(); ++k)
      if (visible_[k] != 0 && !seen_from_[owners_[k]]) {
        seen_from_[owners_[k]] = segments_[k].from;
        left_[owners_[k]] = {};
      }
    std::erase_if(open_, [this](std::uint32_t i) { return seen_from_[i].has_value(); });
    segments_.clear();
    owners_.clear();
  }

  void try_first() {
    for (const std::uint32_t i : open_) {
      const VoxelKey& f = frontier(i);
      const auto sight = std::lower_bound(
          search_.tried_first.begin(), search_.tried_first.end(), f,
          [](const FrontierSight& before, const VoxelKey& key) { return before.frontier < key; });
      if (sight == search_.tried_first.end() || sight->frontier != f) continue;
      const VoxelKey& cell = sight->cell;
      if (search_.blocks.contains(cell) && search_.view.contains(f.x - cell.x, f.y - cell.y, f.z - cell.z))
        add(i, cell);
    }
    cast();
  }

  void try_offsets(std::uint32_t i, const std::vector<std::array<int, 3>>& offsets, std::size_t most) {
    const VoxelKey& f = frontier(i);
    std::size_t found = 0;
    for (const auto& offset : offsets) {
      const int x = f.x - offset[0], y = f.y - offset[1], z = f.z - offset[2];
      if (((x | y | z) & ~0xFFFF) != 0) continue;
      const VoxelKey cell{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                          static_cast<std::uint16_t>(z)};
      if (!search_.blocks.contains(cell)) continue;
      add(i, cell);
      if (++found == most) return;
    }
  }

  // Frontiers next to each other are often seen from the same cell.
  void ask_neighbours() {
    for (const std::uint32_t i : open_) {
      const VoxelKey& f = frontier(i);
      std::optional<VoxelKey> last;
      const auto ask = [&](std::size_t neighbour) {
        const auto& cell = seen_from_[neighbour];
        if (!cell || cell == last || !search_.view.contains(f.x - cell->x, f.y - cell->y, f.z - cell->z))
          return false;
        last = cell;
        add(i, *cell);
        return true;
      };
      for (std::size_t k = i, steps = 0; k-- > 0 && steps < 64; ++steps)
        if (ask(k)) break;
      for (std::size_t k = i + 1, steps = 0; k < seen_from_.size() && steps < 64; ++k, ++steps)
        if (ask(k)) break;
    }
    cast();
  }

  // Where cells are many: what none of some cells from everywhere sees mostly stays undecided to the end, and
  // only for it is it worth it to find out where rays may arrive from.
  void decide_by_flood() {
    for (const std::uint32_t i : open_) try_offsets(i, search_.spread, kSpread);
    cast();
    ask_neighbours();
    std::vector<std::uint32_t> open = std::move(open_);
    VisibilityFlood::Row row;
    std::vector<VoxelKey> cells;
    for (const std::uint32_t i : open) {
      open_ = {i};
      ask_neighbours();
      if (open_.empty()) continue;
      cells.clear();
      search_.approach->cells(frontier(i), row, cells);
      // Some of everywhere first.
      const std::size_t stride = std::max<std::size_t>(1, cells.size() / kSome);
      for (std::size_t k = stride / 2; k < cells.size(); k += stride) add(i, cells[k]);
      cast();
      if (stride == 1) continue;
      for (std::size_t k = 0; k < cells.size() && !open_.empty();) {
        for (const std::size_t end = std::min(cells.size(), k + kMany); k < end; ++k)
          if (k % stride != stride / 2) add(i, cells[k]);
        cast();
      }
    }
    open_.clear();
  }

  // Where cells are few, or their region is too high for columns of bits.
  void decide_by_blocks() {
    for (const std::uint32_t i : open_) search_.blocks.cubes_near(frontier(i), search_.view, left_[i].cubes);
    for (std::size_t share = 2; take_one_per_block(share); share *= 4) {
      cast();
      ask_neighbours();
    }
    for (std::size_t share = 64; take_rest(share); share = std::min<std::size_t>(4 * share, 1024)) {
      cast();
      ask_neighbours();
    }
  }

  // From the next cubes, this many. Whether there was anything left to take.
  bool take_one_per_block(std::size_t share) {
    bool any = false;
    for (const std::uint32_t i : open_) {
      Left& left = left_[i];
      for (std::size_t n = 0; n < share && left.next_cube < left.cubes.size(); ++n) {
        any = true;
        take_one_per_block(i, *left.cubes[left.next_cube++]);
      }
    }
    return any;
  }

  void take_one_per_block(std::uint32_t i, const CorridorBlocks::Cube& cube) {
    const VoxelKey& f = frontier(i);
    if (search_.shadow.hides(f, frontlux::cube(cube.corner, CorridorBlocks::kCube))) return;
    for (std::uint64_t filled = cube.filled; filled != 0; filled &= filled - 1) {
      const BlockCells block = cube.block(std::countr_zero(filled));
      if (!search_.view.may_contain_voxel({f, f}, frontlux::cube(block.corner, CorridorBlocks::kBlock)))
        continue;
      BlockCells cells = block;
      int bit = middle_bit(cells.bits);
      const VoxelKey middle = cells.key(bit);
      if (!search_.view.contains(f.x - middle.x, f.y - middle.y, f.z - middle.z)) {
        cells = detail::feasible_cells(block, f, search_.view);
        if (cells.bits == 0) continue;
        bit = middle_bit(cells.bits);
      }
      cells.bits &= ~(std::uint64_t{1} << bit);
      add(i, cells.key(bit));
      if (cells.bits != 0) left_[i].blocks.push_back(cells);
    }
  }

  bool take_rest(std::size_t share) {
    bool any = false;
    for (const std::uint32_t i : open_) {
      Left& left = left_[i];
      for (std::size_t n = 0; n < share && left.next_block < left.blocks.size();) {
        any = true;
        const BlockCells block = left.blocks[left.next_block++];
        if (search_.shadow.hides(frontier(i), frontlux::cube(block.corner, CorridorBlocks::kBlock))) continue;
        BlockCells cells = detail::feasible_cells(block, frontier(i), search_.view);
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
  std::vector<Left> left_;
  std::vector<std::uint32_t> open_, owners_;
  std::vector<KeySegment> segments_;
  std::vector<std::uint8_t> visible_;
  std::uint64_t rays_ = 0;
};

KeyBox box_around(std::span<const VoxelKey> frontiers, int reach) {
  KeyBox box{frontiers[0], frontiers[0]};
  for (const VoxelKey& key : frontiers) {
    box.min = {std::min(box.min.x, key.x), std::min(box.min.y, key.y), std::min(box.min.z, key.z)};
    box.max = {std::max(box.max.x, key.x), std::max(box.max.y, key.y), std::max(box.max.z, key.z)};
  }
  const auto moved = [](std::uint16_t k, int by) {
    return static_cast<std::uint16_t>(std::clamp(k + by, 0, 0xFFFF));
  };
  return {{moved(box.min.x, -reach), moved(box.min.y, -reach), moved(box.min.z, -reach)},
          {moved(box.max.x, reach), moved(box.max.y, reach), moved(box.max.z, reach)}};
}

}  // namespace

AssignedFrontiers find_visible_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                     std::span<const VoxelKey> frontiers, const FrontierAgent& agent) {
  if (frontiers.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument(std::to_string(frontiers.size()) + " frontiers are more than 32 bits count");
  ViewRegion view(agent.view, grid.resolution());
  if (frontiers.empty() || agent.corridor.empty()) return {};
  const KeyBox box = box_around(frontiers, view.reach());
  auto nearby = detail::nearby_offsets(view, kNearby);
  auto spread = detail::spread_offsets(view, kSpread);
  CorridorBlocks blocks(agent.corridor);
  auto approach = blocks.deep() ? VisibilityFlood::make(grid, agent.corridor, view, box_around(frontiers, 0))
                                : std::nullopt;
  Occlusion shadow = approach ? Occlusion() : Occlusion(grid, box);
  const Search search{caster,
                      frontiers,
                      agent.tried_first,
                      agent.unseen,
                      std::move(view),
                      std::move(blocks),
                      std::move(approach),
                      std::move(shadow),
                      std::move(nearby),
                      std::move(spread)};
  const std::size_t pieces = (frontiers.size() + kPiece - 1) / kPiece;
  std::vector<AssignedFrontiers> found(pieces);
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t p) {
    const std::size_t begin = p * kPiece;
    Piece piece(search, begin, std::min(frontiers.size(), begin + kPiece));
    piece.decide();
    for (std::size_t i = 0; i < piece.seen_from().size(); ++i)
      if (const auto& cell = piece.seen_from()[i]) {
        found[p].frontiers.push_back(static_cast<std::uint32_t>(begin + i));
        found[p].seen_from.push_back(*cell);
      }
    found[p].rays = piece.rays();
  });
  AssignedFrontiers share;
  for (const AssignedFrontiers& part : found) {
    share.frontiers.insert(share.frontiers.end(), part.frontiers.begin(), part.frontiers.end());
    share.seen_from.insert(share.seen_from.end(), part.seen_from.begin(), part.seen_from.end());
    share.rays += part.rays;
  }
  return share;
}

FrontierAssignment assign_frontiers(const RayCaster& caster, const VoxelGrid& grid,
                                          std::span<const VoxelKey> frontiers,
                                          std::span<const FrontierAgent> agents) {
  FrontierAssignment result;
  std::vector<VoxelKey> left(frontiers.begin(), frontiers.end());
  result.unassigned.resize(frontiers.size());
  for (std::size_t i = 0; i < frontiers.size(); ++i) result.unassigned[i] = static_cast<std::uint32_t>(i);
  for (const FrontierAgent& agent : agents) {
    AssignedFrontiers share = find_visible_frontiers(caster, grid, left, agent);
    std::vector<std::uint32_t> remaining;
    std::vector<VoxelKey> remaining_keys;
    std::size_t next = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (next < share.frontiers.size() && share.frontiers[next] == i) {
        share.frontiers[next++] = result.unassigned[i];
        continue;
      }
      remaining.push_back(result.unassigned[i]);
      remaining_keys.push_back(left[i]);
    }
    result.unassigned = std::move(remaining);
    left = std::move(remaining_keys);
    result.assigned.push_back(std::move(share));
  }
  return result;
}

}  // namespace frontlux::planner
