#include "corridor/ground.hpp"

#include <algorithm>
#include <utility>

namespace frontlux::planner::detail {

Ground::Ground(Options options)
    : options_(std::move(options)),
      size_x_(options_.box.max.x - options_.box.min.x + 1),
      size_y_(options_.box.max.y - options_.box.min.y + 1) {
  const std::size_t columns = static_cast<std::size_t>(size_x_) * static_cast<std::size_t>(size_y_);
  for (Flags* flags : {&free_, &occupied_, &carries_}) flags->resize(columns);
}

void Ground::read_voxel(const VoxelGrid& grid, const VoxelKey& key) {
  const Occupancy state = grid.at(key);
  free_[column(key)] = static_cast<std::uint8_t>(state == Occupancy::kFree);
  occupied_[column(key)] = static_cast<std::uint8_t>(state == Occupancy::kOccupied);
}

void Ground::read(const VoxelGrid& grid) {
  const KeyBox& box = options_.box;
  if (options_.layer)
    for (int x = box.min.x; x <= box.max.x; ++x)
      for (int y = box.min.y; y <= box.max.y; ++y) read_voxel(grid, make_key(x, y, *options_.layer));
  decide();
}

void Ground::read(const VoxelGrid& grid, std::span<const VoxelKey> changed) {
  const KeyBox& box = options_.box;
  bool any = false;
  for (const VoxelKey& key : changed) {
    if (key.z != options_.layer || !box.contains({key.x, key.y, box.min.z})) continue;
    read_voxel(grid, key);
    any = true;
  }
  if (any) decide();
}

// The columns within so many voxels, along x and y, of one with a flag.
Ground::Flags Ground::spread(const Flags& flags, int by_x, int by_y) const {
  const auto at = [this](int x, int y) {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_y_) + static_cast<std::size_t>(y);
  };
  Flags rows(flags.size(), 0), all(flags.size(), 0);
  for (int x = 0; x < size_x_; ++x)
    for (int y = 0; y < size_y_; ++y)
      for (int k = std::max(0, y - by_y); flags[at(x, y)] != 0 && k <= std::min(size_y_ - 1, y + by_y); ++k)
        rows[at(x, k)] = 1;
  for (int x = 0; x < size_x_; ++x)
    for (int k = std::max(0, x - by_x); k <= std::min(size_x_ - 1, x + by_x); ++k)
      for (int y = 0; y < size_y_; ++y) all[at(k, y)] |= rows[at(x, y)];
  return all;
}

void Ground::decide() {
  const Flags gap = spread(free_, options_.half_x, options_.half_y);
  const Flags near = spread(occupied_, options_.reach, options_.reach);
  for (std::size_t i = 0; i < carries_.size(); ++i)
    carries_[i] = static_cast<std::uint8_t>(gap[i] == 0 && near[i] != 0);
  const KeyBox& box = options_.box;
  for (const KeyBox& exempt : options_.exempt)
    for (int x = std::max(exempt.min.x, box.min.x); x <= std::min(exempt.max.x, box.max.x); ++x)
      for (int y = std::max(exempt.min.y, box.min.y); y <= std::min(exempt.max.y, box.max.y); ++y)
        carries_[column(make_key(x, y, 0))] = 1;
}

}  // namespace frontlux::planner::detail
