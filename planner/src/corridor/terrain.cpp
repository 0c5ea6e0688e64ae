#include "corridor/terrain.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

Terrain::Terrain(Options options)
    : options_(std::move(options)),
      free_(options_.box),
      occupied_(options_.box),
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
      closed_.bits[first + w] = ~hole;
      filled_.bits[first + w] = ~(hole & below);
      // What is occupied has no ground if the voxel above it is occupied as well.
      const std::uint64_t above = (~clear[w] >> 1) | (w + 1 < words ? ~clear[w + 1] << 63 : 0);
      empty_.bits[first + w] = options_.gap ? clear[w] | above : clear[w];
    }
    closed_.stale[i] = empty_.stale[i] = filled_.stale[i] = 1;
  }
  level_.erode(closed_);
  bare_.erode(empty_);
  if (options_.gap && !options_.exempt.empty()) firm_.erode(filled_);
  for (VoxelColumns* done : {&free_, &occupied_, &closed_, &empty_, &filled_}) done->settle();
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
