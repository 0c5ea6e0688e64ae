#include "assignment/unseen_frontiers.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>

namespace frontlux::planner::detail {
namespace {

constexpr int kLog2Cube = 3;  // [voxels] of the cubes in which changes are noted

using Cube = std::array<int, 3>;

Cube cube_of(const VoxelKey& key) { return {key.x >> kLog2Cube, key.y >> kLog2Cube, key.z >> kLog2Cube}; }

// The cubes within some distance of those in which something has changed.
class Surroundings {
 public:
  static constexpr std::int64_t kMost = std::int64_t{1} << 24;

  // Nothing if they span too many. @pre there is a cube
  static std::optional<Surroundings> make(std::span<const Cube> changed, const Cube& distance) {
    Surroundings around;
    Cube high = around.low_ = changed.front();
    for (const Cube& cube : changed)
      for (std::size_t a = 0; a < 3; ++a) {
        around.low_[a] = std::min(around.low_[a], cube[a]);
        high[a] = std::max(high[a], cube[a]);
      }
    std::int64_t count = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      around.low_[a] -= distance[a];
      around.size_[a] = high[a] + distance[a] + 1 - around.low_[a];
      count *= around.size_[a];  // no more than 2^14 each
    }
    if (count > kMost) return std::nullopt;
    around.marked_.resize(static_cast<std::size_t>(count));
    for (const Cube& cube : changed) around.mark(cube, distance);
    return around;
  }

  [[nodiscard]] bool contain(const Cube& cube) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (cube[a] < low_[a] || cube[a] >= low_[a] + size_[a]) return false;
    return marked_[row(cube[0], cube[1]) + static_cast<std::size_t>(cube[2] - low_[2])] != 0;
  }

 private:
  void mark(const Cube& cube, const Cube& distance) {
    for (int x = cube[0] - distance[0]; x <= cube[0] + distance[0]; ++x)
      for (int y = cube[1] - distance[1]; y <= cube[1] + distance[1]; ++y)
        std::fill_n(
            marked_.begin() + static_cast<std::ptrdiff_t>(
                                  row(x, y) + static_cast<std::size_t>(cube[2] - distance[2] - low_[2])),
            2 * distance[2] + 1, std::uint8_t{1});
  }

  [[nodiscard]] std::size_t row(int x, int y) const {
    return (static_cast<std::size_t>(x - low_[0]) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y - low_[1])) *
           static_cast<std::size_t>(size_[2]);
  }

  Cube low_{}, size_{};
  std::vector<std::uint8_t> marked_;
};

}  // namespace

void UnseenFrontiers::update(const MapChange& change, std::span<const VoxelKey> corridor,
                             const ViewRegion& view) {
  std::vector<VoxelKey> changed;
  if (!keys_.empty()) {
    std::set_difference(corridor.begin(), corridor.end(), corridor_.begin(), corridor_.end(),
                        std::back_inserter(changed));
    if (grid_)
      std::ranges::copy_if(change.keys, std::back_inserter(changed), [&](const VoxelKey& key) {
        return grid_->at(key) == Occupancy::kOccupied && change.grid.at(key) != Occupancy::kOccupied;
      });
  }
  corridor_.assign(corridor.begin(), corridor.end());
  grid_ = change.grid;
  if (changed.empty()) return;
  std::vector<Cube> cubes;
  for (const VoxelKey& key : changed)
    if (const Cube cube = cube_of(key); cubes.empty() || cubes.back() != cube) cubes.push_back(cube);
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  const int across = (view.reach() >> kLog2Cube) + 1, up = (view.greatest_height() >> kLog2Cube) + 1;
  const auto around = Surroundings::make(cubes, {across, across, up});
  std::erase_if(keys_, [&](const VoxelKey& key) { return !around || around->contain(cube_of(key)); });
}

}  // namespace frontlux::planner::detail
