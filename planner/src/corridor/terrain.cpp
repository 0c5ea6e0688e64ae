#include "corridor/terrain.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

Terrain::Terrain(Options options)
    : options_(std::move(options)),
      free_(options_.box),
      occupied_(options_.box),
      open_(options_.box),
      grounded_(options_.box),
      closed_(options_.box, true),
      empty_(options_.box, true),
      filled_(options_.box, true),
      level_(options_.box, {{-options_.half_x, -options_.half_y, 0}, {options_.half_x, options_.half_y, 0}},
             true),
      bare_(options_.box,
            {{-options_.reach, -options_.reach, -options_.gap.value_or(0)},
             {options_.reach, options_.reach, 0}},
            true),
      firm_(options_.box, {{-options_.half_x, -options_.half_y, 0}, {options_.half_x, options_.half_y, 0}},
            true) {}

void Terrain::read(const VoxelGrid& grid) {
  free_.read(grid, Occupancy::kFree);
  occupied_.read(grid, Occupancy::kOccupied);
  decide();
}

void Terrain::read(const VoxelGrid& grid, std::span<const VoxelKey> changed) {
  free_.read(grid, Occupancy::kFree, changed);
  occupied_.read(grid, Occupancy::kOccupied, changed);
  decide();
}

void Terrain::decide() {
  const std::size_t words = free_.words();
  std::vector<std::uint64_t> clear(words), no_ground(words);
  for (std::size_t i = 0; i < free_.stale.size(); ++i) {
    if (free_.stale[i] == 0 && occupied_.stale[i] == 0) continue;
    const std::size_t first = i * words;
    for (std::size_t w = 0; w < words; ++w) clear[w] = ~occupied_.bits[first + w];
    and_along_z(clear, -options_.below, options_.above, true, no_ground);
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t hole = free_.bits[first + w] & no_ground[w];
      const std::uint64_t below = free_.bits[first + w] << 1 | (w > 0 ? free_.bits[first + w - 1] >> 63 : 0);
      open_.bits[first + w] = hole;
      grounded_.bits[first + w] = ~no_ground[w];
      filled_.bits[first + w] = ~(hole & below);
      // What is occupied has no ground if the voxel above it is occupied as well.
      const std::uint64_t above = (~clear[w] >> 1) | (w + 1 < words ? ~clear[w + 1] << 63 : 0);
      empty_.bits[first + w] = options_.gap ? clear[w] | above : clear[w];
    }
    open_.stale[i] = empty_.stale[i] = filled_.stale[i] = 1;
  }
  close_gaps();
  level_.erode(closed_);
  bare_.erode(empty_);
  if (options_.gap && !options_.exempt.empty()) firm_.erode(filled_);
  for (VoxelColumns* done : {&free_, &occupied_, &open_, &closed_, &empty_, &filled_}) done->settle();
}

// Where columns are stale, or those beside them that decide.
void Terrain::close_gaps() {
  const int size_x = open_.size_x(), size_y = open_.size_y(), reach = options_.bridge;
  const auto is_inside = [&](int x, int y) { return x >= 0 && x < size_x && y >= 0 && y < size_y; };
  for (int x = 0; x < size_x; ++x)
    for (int y = 0; y < size_y; ++y) {
      if (open_.stale[open_.flag(x, y)] == 0) continue;
      for (int by = -reach; by <= reach; ++by)
        for (const auto& [nx, ny] : {std::pair(x + by, y), {x, y + by}})
          if (is_inside(nx, ny)) closed_.stale[closed_.flag(nx, ny)] = 1;
    }
  const auto ground = [&](int x, int y, std::size_t word) {
    return is_inside(x, y) ? grounded_.bits[grounded_.column(x, y) + word] : 0;
  };
  for (int x = 0; x < size_x; ++x)
    for (int y = 0; y < size_y; ++y) {
      if (closed_.stale[closed_.flag(x, y)] == 0) continue;
      for (std::size_t w = 0; w < open_.words(); ++w) {
        std::uint64_t bridged = 0;
        for (int back = 1; back <= reach; ++back)
          for (int on = 1; back + on <= reach + 1; ++on)
            bridged |= (ground(x - back, y, w) & ground(x + on, y, w)) |
                       (ground(x, y - back, w) & ground(x, y + on, w));
        const std::size_t word = open_.column(x, y) + w;
        closed_.bits[word] = ~(open_.bits[word] & ~bridged);
      }
    }
}

// Whether all that is near is a hole. Beams that graze the floor make single ones where there is none.
bool Terrain::is_open_all_around(const VoxelKey& floor) const {
  const int reach = options_.reach;
  const auto near = intersection(grown({floor, floor}, reach, reach, 0), options_.box);
  return all_of(*near, [this](const VoxelKey& key) { return !closed_.holds(key); });
}

bool Terrain::carries(const VoxelKey& floor) const {
  const auto holds_floor = [&](const KeyBox& box) { return box.contains(floor); };
  if (!holds_floor(options_.box)) return false;
  if (std::ranges::any_of(options_.exempt, holds_floor))
    return options_.gap ? firm_.whole(floor) : !is_open_all_around(floor);
  return level_.whole(floor) && !bare_.whole(floor);
}

}  // namespace frontlux::planner::detail
