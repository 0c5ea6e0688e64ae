#include "frontier/frontier_brick.hpp"
#include "mapping/brick_table.hpp"

#include <frontlux/planner/frontier_set.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::BrickTable;
using detail::Layers;

// One number for a key, in the order of keys.
std::uint64_t packed(const VoxelKey& key) {
  return (static_cast<std::uint64_t>(key.x) << 32) | (static_cast<std::uint64_t>(key.y) << 16) | key.z;
}
VoxelKey unpacked(std::uint64_t number) {
  return {static_cast<std::uint16_t>(number >> 32), static_cast<std::uint16_t>(number >> 16),
          static_cast<std::uint16_t>(number)};
}

// Whether bricks `d` bricks away along an axis can hold a neighbour of a voxel with this key along it.
bool reaches(std::uint16_t key, int d) { return d == 0 || (key & 7) == (d < 0 ? 0 : 7); }

constexpr int kAllAround = (1 << 27) - 1;

// Bit 9 z + 3 y + x of the brick itself and those around it in which the frontiers may have changed.
int bricks_around(const VoxelKey& key, Adjacency adjacency) {
  int around = 0, bit = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x, ++bit) {
        const bool near = adjacency == Adjacency::kCorners || (x != 0) + (y != 0) + (z != 0) <= 1;
        if (near && reaches(key.x, x) && reaches(key.y, y) && reaches(key.z, z)) around |= 1 << bit;
      }
  return around;
}

}  // namespace

struct FrontierSet::State {
  Lattice lattice;
  KeyBox bounds;
  Adjacency adjacency;
  std::array<int, 512> around{};  // bricks_around of each voxel of a brick
  BrickTable<Layers> bricks{};    // frontiers, by packed corner; bricks that have none any more stay
  std::vector<VoxelKey> keys{};   // the same, sorted

  State(const Lattice& map_lattice, const KeyBox& map_bounds, Adjacency map_adjacency)
      : lattice(map_lattice), bounds(map_bounds), adjacency(map_adjacency) {
    for (unsigned i = 0; i < 512; ++i) around[i] = bricks_around(voxel(i), adjacency);
  }

  static VoxelKey voxel(unsigned i) {
    return {static_cast<std::uint16_t>(i & 7), static_cast<std::uint16_t>((i >> 3) & 7),
            static_cast<std::uint16_t>(i >> 6)};
  }
  static std::size_t number(const VoxelKey& key) {
    return static_cast<std::size_t>(((key.z & 7) << 6) | ((key.y & 7) << 3) | (key.x & 7));
  }

  // Finds anew the frontiers in the bricks around these, as far as their bits tell.
  void refresh(const VoxelGrid& grid, const BrickTable<int>& changed) {
    BrickTable<bool> stale;
    for (const auto& entry : changed.entries())
      for (int bit = 0; bit < 27; ++bit) {
        if (((entry.value >> bit) & 1) == 0) continue;
        const auto at =
            detail::neighbour_brick(unpacked(entry.number), bit % 3 - 1, bit / 3 % 3 - 1, bit / 9 - 1);
        if (at) stale.index(packed(*at));
      }
    refresh(grid, stale);
  }

  void refresh(const VoxelGrid& grid, const BrickTable<bool>& stale) {
    std::vector<VoxelKey> added, removed;
    for (const auto& entry : stale.entries()) {
      const VoxelKey corner = unpacked(entry.number);
      const Layers* known = bricks.find(entry.number);
      const Layers before = known == nullptr ? Layers{} : *known;
      const Layers after = detail::frontiers_in_brick(grid, corner, bounds, adjacency);
      if (after == before) continue;
      bricks[entry.number] = after;
      for (std::size_t z = 0; z < 8; ++z) {
        append(corner, z, after[z] & ~before[z], added);
        append(corner, z, before[z] & ~after[z], removed);
      }
    }
    std::sort(added.begin(), added.end());
    std::sort(removed.begin(), removed.end());
    merge(added, removed);
  }

  static void append(const VoxelKey& corner, std::size_t z, std::uint64_t layer, std::vector<VoxelKey>& to) {
    for (; layer != 0; layer &= layer - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(layer));
      to.push_back({static_cast<std::uint16_t>(corner.x + (bit & 7U)),
                    static_cast<std::uint16_t>(corner.y + (bit >> 3)),
                    static_cast<std::uint16_t>(corner.z + z)});
    }
  }

  void merge(const std::vector<VoxelKey>& added, const std::vector<VoxelKey>& removed) {
    if (added.empty() && removed.empty()) return;
    std::vector<VoxelKey> merged;
    merged.reserve(keys.size() + added.size() - removed.size());
    auto next_added = added.begin(), next_removed = removed.begin();
    for (const VoxelKey& key : keys) {
      if (next_removed != removed.end() && *next_removed == key) {
        ++next_removed;
        continue;
      }
      while (next_added != added.end() && *next_added < key) merged.push_back(*next_added++);
      merged.push_back(key);
    }
    merged.insert(merged.end(), next_added, added.end());
    keys = std::move(merged);
  }

  // Every brick in or around which there is something free.
  void build(const VoxelGrid& grid) {
    BrickTable<int> mixed;
    BrickTable<bool> stale;
    grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
      if (brick != nullptr)
        mixed[packed(block.corner)] = kAllAround;
      else if (state == Occupancy::kFree)
        add_shell(block, stale);
    });
    refresh(grid, mixed);
    refresh(grid, stale);
  }

  // The bricks of the bounds that surround a block; in the block itself nothing is unknown.
  void add_shell(const Block& block, BrickTable<bool>& stale) const {
    const int edge = 1 << block.log2_edge;
    const auto first = [](std::uint16_t corner, std::uint16_t bound) {
      return std::max(corner - 8, bound & ~7);
    };
    const auto last = [edge](std::uint16_t corner, std::uint16_t bound) {
      return std::min(corner + edge, bound & ~7);
    };
    const auto inside = [edge](int k, std::uint16_t corner) { return k >= corner && k < corner + edge; };
    const VoxelKey& c = block.corner;
    for (int z = first(c.z, bounds.min.z); z <= last(c.z, bounds.max.z); z += 8)
      for (int y = first(c.y, bounds.min.y); y <= last(c.y, bounds.max.y); y += 8) {
        const bool through = inside(z, c.z) && inside(y, c.y);
        for (int x = first(c.x, bounds.min.x); x <= last(c.x, bounds.max.x); x += 8) {
          if (through && inside(x, c.x)) x = c.x + edge;  // on to the other side
          if (x <= last(c.x, bounds.max.x))
            stale.index(packed({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                static_cast<std::uint16_t>(z)}));
        }
      }
  }
};

FrontierSet::FrontierSet(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency)
    : state_(std::make_unique<State>(grid.lattice(), bounds, adjacency)) {
  state_->build(grid);
}
FrontierSet::~FrontierSet() = default;
FrontierSet::FrontierSet(FrontierSet&&) noexcept = default;
FrontierSet& FrontierSet::operator=(FrontierSet&&) noexcept = default;

void FrontierSet::update(const MapChange& change) {
  BrickTable<int> around;
  VoxelKey corner;
  std::size_t at = 0;
  bool any = false;
  for (const VoxelKey& key : change.keys) {
    const VoxelKey its_corner = detail::brick_corner(key);
    if (!any || its_corner != corner) {  // sorted keys stay in a brick for a while
      corner = its_corner;
      at = around.index(packed(corner));
      any = true;
    }
    around.value(at) |= state_->around[State::number(key)];
  }
  state_->refresh(change.grid, around);
}

std::span<const VoxelKey> FrontierSet::keys() const { return state_->keys; }

bool FrontierSet::contains(const VoxelKey& key) const {
  const Layers* layers = state_->bricks.find(packed(detail::brick_corner(key)));
  return layers != nullptr && (((*layers)[key.z & 7U] >> Brick::bit(key)) & 1U) != 0;
}

std::vector<FrontierCluster> FrontierSet::clusters(int level) const {
  if (level < 0 || level > 16)
    throw std::invalid_argument("clusters by octree level " + std::to_string(level) +
                                ": give a level from 0 to 16");
  struct Sum {
    std::uint32_t count;
    std::array<std::uint64_t, 3> keys;
  };
  BrickTable<Sum> nodes;
  const auto down = [level](std::uint16_t key) {
    return static_cast<std::uint16_t>((key >> level) << level);
  };
  for (const VoxelKey& key : state_->keys) {
    auto& [count, sum] = nodes[packed({down(key.x), down(key.y), down(key.z)})];
    ++count;
    sum[0] += key.x;
    sum[1] += key.y;
    sum[2] += key.z;
  }
  std::vector<FrontierCluster> clusters;
  clusters.reserve(nodes.entries().size());
  for (const auto& [node, sum] : nodes.entries()) {
    const auto mean = [&](std::size_t axis) {
      const double key = static_cast<double>(sum.keys[axis]) / static_cast<double>(sum.count);
      return (key - Lattice::kOrigin + 0.5) * state_->lattice.resolution();
    };
    clusters.push_back({unpacked(node), sum.count, {mean(0), mean(1), mean(2)}});
  }
  std::sort(clusters.begin(), clusters.end(),
            [](const FrontierCluster& a, const FrontierCluster& b) { return a.corner < b.corner; });
  return clusters;
}

}  // namespace frontlux::planner
