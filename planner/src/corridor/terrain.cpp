#include "corridor/terrain.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

namespace {

VoxelWindow footprint(const Terrain::Options& options) {
  return {{-options.half_x, -options.half_y, 0}, {options.half_x, options.half_y, 0}};
}

}  // namespace

Terrain::Terrain(Options options)
    : options_(std::move(options)),
      free_(options_.box),
      occupied_(options_.box),
      no_hole_(options_.box, true),
      no_ground_(options_.box, true),
      level_(options_.box, footprint(options_), true),
      without_ground_(options_.box,
                      {{-options_.reach, -options_.reach, -options_.depth.value_or(0)},
                       {options_.reach, options_.reach, 0}},
                      true) {
  if (options_.gap_width > 0) gaps_.emplace(Gaps{VoxelColumns(options_.box), VoxelColumns(options_.box)});
  if (options_.depth && !options_.exempt.empty())
    start_area_.emplace(
        StartArea{VoxelColumns(options_.box, true), Erosion(options_.box, footprint(options_), true)});
}

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
  for (const VoxelColumns* read : {&free_, &occupied_})
    for (const std::size_t number : read->stale.numbers()) no_ground_.stale.add(number);
  for (const std::size_t number : no_ground_.stale.numbers()) {
    const std::size_t first = number * words;
    for (std::size_t w = 0; w < words; ++w) clear[w] = ~occupied_.bits[first + w];
    and_along_z(clear, -options_.below, options_.above, true, no_ground);
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t hole = free_.bits[first + w] & no_ground[w];
      if (gaps_) {
        gaps_->holes.bits[first + w] = hole;
        gaps_->grounded.bits[first + w] = ~no_ground[w];
      } else {
        no_hole_.bits[first + w] = ~hole;
      }
      const std::uint64_t below = free_.bits[first + w] << 1 | (w > 0 ? free_.bits[first + w - 1] >> 63 : 0);
      if (start_area_) start_area_->filled.bits[first + w] = ~(hole & below);
      // What is occupied has no ground if the voxel above it is occupied as well.
      const std::uint64_t above = (~clear[w] >> 1) | (w + 1 < words ? ~clear[w + 1] << 63 : 0);
      no_ground_.bits[first + w] = options_.depth ? clear[w] | above : clear[w];
    }
    (gaps_ ? gaps_->holes : no_hole_).stale.add(number);
    if (start_area_) start_area_->filled.stale.add(number);
  }
  if (gaps_) close_gaps();
  level_.erode(no_hole_);
  without_ground_.erode(no_ground_);
  for (VoxelColumns* done : {&free_, &occupied_, &no_hole_, &no_ground_}) done->clear_stale();
  if (!start_area_) return;
  start_area_->level.erode(start_area_->filled);
  start_area_->filled.clear_stale();
}

// Where columns are stale, or those beside them that decide.
void Terrain::close_gaps() {
  const int reach = options_.gap_width;
  VoxelColumns& holes = gaps_->holes;
  const VoxelColumns& grounded = gaps_->grounded;
  for (const std::size_t number : holes.stale.numbers()) {
    const auto [x, y] = holes.place(number);
    for (int by = -reach; by <= reach; ++by)
      for (const auto& [nx, ny] : {std::pair(x + by, y), {x, y + by}})
        if (holes.has_column(nx, ny)) no_hole_.stale.add(holes.number(nx, ny));
  }
  holes.clear_stale();
  const auto ground = [&](int x, int y, std::size_t word) {
    return grounded.has_column(x, y) ? grounded.bits[grounded.column(x, y) + word] : 0;
  };
  for (const std::size_t number : no_hole_.stale.numbers()) {
    const auto [x, y] = no_hole_.place(number);
    for (std::size_t w = 0; w < no_hole_.words(); ++w) {
      std::uint64_t bridged = 0;
      for (int back = 1; back <= reach; ++back)
        for (int on = 1; back + on <= reach + 1; ++on)
          bridged |= (ground(x - back, y, w) & ground(x + on, y, w)) |
                     (ground(x, y - back, w) & ground(x, y + on, w));
      const std::size_t word = no_hole_.column(x, y) + w;
      no_hole_.bits[word] = ~(holes.bits[word] & ~bridged);
    }
  }
}

// Whether all that is near is a hole. Beams that graze the floor make single ones where there is none.
bool Terrain::is_open_all_around(const VoxelKey& floor) const {
  const int reach = options_.reach;
  const auto near = intersection(grown({floor, floor}, reach, reach, 0), options_.box);
  return all_of(*near, [this](const VoxelKey& key) { return !no_hole_.holds(key); });
}

bool Terrain::carries(const VoxelKey& floor) const {
  const auto holds_floor = [&](const KeyBox& box) { return box.contains(floor); };
  if (!holds_floor(options_.box)) return false;
  if (std::ranges::any_of(options_.exempt, holds_floor))
    return options_.depth ? start_area_->level.whole(floor) : !is_open_all_around(floor);
  return level_.whole(floor) && !without_ground_.whole(floor);
}

}  // namespace frontlux::planner::detail
