#include <frontlux/brick_table.hpp>
#include <frontlux/file.hpp>
#include <frontlux/frontier_set.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux {
namespace {

using detail::BrickTable, detail::Layers;

constexpr std::uint64_t kColumn = 0x01'01'01'01'01'01'01'01;  // the eight voxels of a layer with x = 0

// One layer of free voxels and those of the layers beside it.
struct Square {
  std::uint64_t here, west, east;
};

const Layers& free_in(const VoxelGrid& grid, const VoxelKey& corner, int dx, int dy, int dz) {
  static const Layers kNone{};
  const auto at = offset_key(corner, 8 * dx, 8 * dy, 8 * dz);
  return at ? grid.brick(*at).free : kNone;
}

// Voxels of `here` whose neighbour along x is free.
std::uint64_t beside_x(const Square& s) {
  return ((s.here & ~(kColumn << 7)) << 1) | ((s.here & ~kColumn) >> 1) | ((s.west >> 7) & kColumn) |
         ((s.east & kColumn) << 7);
}

// The layer moved by one along y in both directions; `south` and `north` are the layers that move in.
std::uint64_t beside_y(std::uint64_t here, std::uint64_t south, std::uint64_t north) {
  return (here << 8) | (here >> 8) | (south >> 56) | (north << 56);
}

Layers beside_faces(const VoxelGrid& grid, const VoxelKey& corner) {
  const Layers& here = free_in(grid, corner, 0, 0, 0);
  const Layers &west = free_in(grid, corner, -1, 0, 0), &east = free_in(grid, corner, 1, 0, 0);
  const Layers &south = free_in(grid, corner, 0, -1, 0), &north = free_in(grid, corner, 0, 1, 0);
  const Layers &below = free_in(grid, corner, 0, 0, -1), &above = free_in(grid, corner, 0, 0, 1);
  Layers beside;
  for (std::size_t z = 0; z < 8; ++z)
    beside[z] = beside_x({here[z], west[z], east[z]}) | beside_y(here[z], south[z], north[z]) |
                (z == 0 ? below[7] : here[z - 1]) | (z == 7 ? above[0] : here[z + 1]);
  return beside;
}

// Free voxels of one layer, spread to all eight neighbours in the layer and to themselves.
std::uint64_t spread_in_layer(const std::array<const Layers*, 9>& around, std::size_t z) {
  std::array<std::uint64_t, 3> rows{};
  for (std::size_t y = 0; y < 3; ++y) {
    const Square square{(*around[3 * y + 1])[z], (*around[3 * y])[z], (*around[3 * y + 2])[z]};
    rows[y] = square.here | beside_x(square);
  }
  return rows[1] | beside_y(rows[1], rows[0], rows[2]);
}

Layers beside_corners(const VoxelGrid& grid, const VoxelKey& corner) {
  const auto around = [&](int dz) {
    std::array<const Layers*, 9> layers{};
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        layers[static_cast<std::size_t>(3 * (y + 1) + x + 1)] = &free_in(grid, corner, x, y, dz);
    return layers;
  };
  std::array<std::uint64_t, 10> spread{};
  spread[0] = spread_in_layer(around(-1), 7);
  const auto beside = around(0);
  for (std::size_t z = 0; z < 8; ++z) spread[z + 1] = spread_in_layer(beside, z);
  spread[9] = spread_in_layer(around(1), 0);
  Layers all;
  for (std::size_t z = 0; z < 8; ++z) all[z] = spread[z] | spread[z + 1] | spread[z + 2];
  return all;
}

// The frontiers in one brick, 64 voxels at a time.
Layers frontiers_in_brick(const VoxelGrid& grid, const VoxelKey& corner, const KeyBox& bounds,
                          Adjacency adjacency) {
  const Brick& brick = grid.brick(corner);
  const Layers inside = detail::part_inside(corner, bounds);
  Layers frontiers;
  std::uint64_t any = 0;
  for (std::size_t z = 0; z < 8; ++z) any |= frontiers[z] = inside[z] & ~(brick.free[z] | brick.occupied[z]);
  if (any == 0) return frontiers;
  const Layers beside =
      adjacency == Adjacency::kFaces ? beside_faces(grid, corner) : beside_corners(grid, corner);
  for (std::size_t z = 0; z < 8; ++z) frontiers[z] &= beside[z];
  return frontiers;
}

// The brick of a key, by its place among all bricks; and its number, in the order of keys.
VoxelKey brick_of(const VoxelKey& key) { return make_key(key.x >> 3, key.y >> 3, key.z >> 3); }
KeyBox bricks_of(const KeyBox& box) { return {brick_of(box.min), brick_of(box.max)}; }
std::uint64_t number_of(const VoxelKey& brick) {
  return (std::uint64_t{brick.x} << 32) | (std::uint64_t{brick.y} << 16) | brick.z;
}
VoxelKey corner_of(std::uint64_t number) {
  const auto along = [number](int shift) { return static_cast<int>((number >> shift) & 0x1FFF) * 8; };
  return make_key(along(32), along(16), along(0));
}

}  // namespace

struct FrontierSet::State {
  using Bricks = BrickTable<bool>;  // a set of numbers
  static constexpr std::uint64_t kMostBricks = std::uint64_t{1} << 22;

  double resolution;
  KeyBox bounds;
  Adjacency adjacency;
  std::size_t most;
  BrickTable<Layers> bricks{};   // frontiers, by number; bricks that have none any more stay
  std::vector<VoxelKey> keys{};  // the same, sorted

  // Finds the frontiers of some bricks again: of all, or of none if there is not enough memory.
  void refresh(const VoxelGrid& grid, const Bricks& stale) {
    std::vector<VoxelKey> added, removed;
    std::vector<std::pair<std::uint64_t, Layers>> differ;  // by number, and then by place
    for (const auto& entry : stale.entries()) {
      const VoxelKey corner = corner_of(entry.number);
      const Layers* known = bricks.find(entry.number);
      const Layers before = known == nullptr ? Layers{} : *known;
      const Layers after = frontiers_in_brick(grid, corner, bounds, adjacency);
      if (after == before) continue;
      differ.emplace_back(entry.number, after);
      for (std::size_t z = 0; z < 8; ++z) {
        append(corner, z, after[z] & ~before[z], added);
        append(corner, z, before[z] & ~after[z], removed);
      }
      if (added.size() > most) refuse();
    }
    std::sort(added.begin(), added.end());
    std::sort(removed.begin(), removed.end());
    if (differ.empty()) return;
    if (keys.size() - removed.size() > most - added.size()) refuse();
    std::vector<VoxelKey> merged = with_changes(added, removed);
    for (auto& [at, layers] : differ) at = bricks.index(at);
    for (const auto& [at, layers] : differ) bricks.value(at) = layers;
    keys = std::move(merged);
  }

  [[noreturn]] void refuse() const {
    throw std::length_error("there are more than " + std::to_string(most) + " frontiers");
  }

  static void append(const VoxelKey& corner, std::size_t z, std::uint64_t layer, std::vector<VoxelKey>& to) {
    for (; layer != 0; layer &= layer - 1) {
      const int bit = std::countr_zero(layer);
      to.push_back(make_key(corner.x + (bit & 7), corner.y + (bit >> 3), corner.z + static_cast<int>(z)));
    }
  }

  [[nodiscard]] std::vector<VoxelKey> with_changes(const std::vector<VoxelKey>& added,
                                                   const std::vector<VoxelKey>& removed) const {
    std::vector<VoxelKey> rest;
    rest.reserve(keys.size() + added.size());
    std::set_difference(keys.begin(), keys.end(), removed.begin(), removed.end(), std::back_inserter(rest));
    const auto kept = static_cast<std::ptrdiff_t>(rest.size());
    rest.insert(rest.end(), added.begin(), added.end());
    std::inplace_merge(rest.begin(), rest.begin() + kept, rest.end());
    return rest;
  }

  // Finds the frontiers of every brick in which, or next to which, a voxel is free.
  void build(const VoxelGrid& grid) {
    Bricks stale;
    std::uint64_t beside = 0;  // bricks, of blocks of one state: files have no more of the others than bytes
    grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
      if (brick == nullptr && state != Occupancy::kFree) return;
      if (brick == nullptr && beside + surroundings(block) > kMostBricks)
        throw std::length_error(
            "the free space is too large: more than 2^22 bricks of 8 x 8 x 8 voxels are beside it");
      const std::size_t before = stale.entries().size();
      add_surroundings(block, brick != nullptr, stale);
      if (brick == nullptr) beside += stale.entries().size() - before;
    });
    refresh(grid, stale);
  }

  // How many bricks of the bounds are next to a block.
  [[nodiscard]] std::uint64_t surroundings(const Block& block) const {
    const KeyBox voxels = cube(block.corner, 1 << block.log2_edge);
    const auto around = intersection(bricks_of(grown(voxels, 8)), bricks_of(bounds)),
               inside = intersection(bricks_of(voxels), bricks_of(bounds));
    return around ? size_of(*around) - (inside ? size_of(*inside) : 0) : 0;
  }

  // The bricks of the bounds in and next to a block. In a block of one state nothing is unknown.
  void add_surroundings(const Block& block, bool mixed, Bricks& stale) const {
    const KeyBox voxels = cube(block.corner, 1 << block.log2_edge), inside = bricks_of(voxels);
    const auto around = intersection(bricks_of(grown(voxels, 8)), bricks_of(bounds));
    if (!around) return;
    for (int x = around->min.x; x <= around->max.x; ++x)
      for (int y = around->min.y; y <= around->max.y; ++y)
        for (int z = around->min.z; z <= around->max.z; ++z)
          if (!mixed && inside.contains(make_key(x, y, z)))
            z = inside.max.z;  // on to the other side
          else
            stale.index(number_of(make_key(x, y, z)));
  }
};

FrontierSet::FrontierSet(const VoxelGrid& grid, const KeyBox& bounds, Adjacency adjacency, std::size_t most)
    : state_(std::make_unique<State>(State{grid.resolution(), bounds, adjacency, most})) {
  if (adjacency != Adjacency::kFaces && adjacency != Adjacency::kCorners)
    throw std::invalid_argument("frontiers: adjacency has the unknown value " +
                                std::to_string(static_cast<int>(adjacency)));
  state_->build(grid);
}
FrontierSet::~FrontierSet() = default;
FrontierSet::FrontierSet(FrontierSet&&) noexcept = default;
FrontierSet& FrontierSet::operator=(FrontierSet&&) noexcept = default;

void FrontierSet::update(const MapChange& change) {
  if (change.grid.resolution() != state_->resolution)
    throw std::invalid_argument("frontiers: the map has voxels of " + decimals_of(change.grid.resolution()) +
                                " m, those before had " + decimals_of(state_->resolution) + " m");
  State::Bricks stale;
  std::optional<KeyBox> last;
  for (const VoxelKey& key : change.keys) {
    const KeyBox near = bricks_of(grown({key, key}, 1));
    if (near == last) continue;  // sorted keys stay in a brick for a while
    last = near;
    for_each_key(near, [&](const VoxelKey& brick) { stale.index(number_of(brick)); });
  }
  state_->refresh(change.grid, stale);
}

std::span<const VoxelKey> FrontierSet::keys() const { return state_->keys; }

bool FrontierSet::contains(const VoxelKey& key) const {
  const Layers* layers = state_->bricks.find(number_of(brick_of(key)));
  return layers != nullptr && (((*layers)[key.z & 7U] >> Brick::bit(key)) & 1U) != 0;
}

}  // namespace frontlux
