#include "assignment/occlusion.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace frontlux::planner::detail {

Occlusion::Occlusion(const VoxelGrid& grid, const KeyBox& box) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 29;
  const auto known = grid.known_bounds();
  const auto part = known ? intersection(box, *known) : std::nullopt;
  if (!part || BitColumns::bytes(*part) > kMaxBytes) return;
  walls_.emplace(*part);
  walls_->add_occupied(grid);
}

bool Occlusion::occupied(const KeyBox& box) const {
  const int shift = walls_->shift(box.min);
  for (int x = box.min.x; x <= box.max.x; ++x)
    for (int y = box.min.y; y <= box.max.y; ++y) {
      const std::uint64_t* word = walls_->at(make_key(x, y, box.min.z));
      for (int z = box.min.z; z <= box.max.z; z += 64, ++word)
        if ((~BitColumns::read(word, shift) & BitColumns::bits_to(box.max.z - z)) != 0) return false;
    }
  return true;
}

// A line from a voxel's centre to the target's crosses the middle of a layer between them at a point, and its
// path visits the voxel that holds the point, or both that share it. Seen from the target the point lies at
// the fraction m / d of the offset, with d layers to the voxel and m to the layer in question; so the points
// of all lines from the box lie in a rectangle. Its sides are lines in m: in fixed point, rounded outwards.
bool Occlusion::hides(const VoxelKey& target, const KeyBox& from) const {
  if (!walls_) return false;
  constexpr int kFraction = 32;
  constexpr double kOne = 0x1p32;
  constexpr std::int64_t kHalf = std::int64_t{1} << (kFraction - 1);
  const KeyBox& box = walls_->box();
  const std::array<int, 3> t = {target.x, target.y, target.z}, first = {box.min.x, box.min.y, box.min.z},
                           last = {box.max.x, box.max.y, box.max.z};
  const std::array<int, 3> near = {from.min.x - t[0], from.min.y - t[1], from.min.z - t[2]};
  const std::array<int, 3> far = {from.max.x - t[0], from.max.y - t[1], from.max.z - t[2]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int nearest = std::max(near[axis], -far[axis]), side = near[axis] > 0 ? 1 : -1;
    if (nearest < 2) continue;
    const int farthest = side > 0 ? far[axis] : -near[axis];
    std::array<std::int64_t, 3> low_at{}, high_at{}, low_step{}, high_step{};
    std::array<int, 3> low{}, high{};
    for (std::size_t b = 0; b < 3; ++b) {
      if (b == axis) continue;
      low_step[b] = static_cast<std::int64_t>(kOne * near[b] / (near[b] < 0 ? nearest : farthest)) - 1;
      high_step[b] = static_cast<std::int64_t>(kOne * far[b] / (far[b] > 0 ? nearest : farthest)) + 1;
      high_at[b] = (std::int64_t{t[b]} << kFraction) + kHalf;
      low_at[b] = high_at[b] - 1;
    }
    for (int m = 1; m < nearest; ++m) {
      bool inside = true;
      for (std::size_t b = 0; b < 3; ++b) {
        low_at[b] += low_step[b];
        high_at[b] += high_step[b];
        low[b] = b == axis ? t[b] + side * m : static_cast<int>(low_at[b] >> kFraction);
        high[b] = b == axis ? low[b] : static_cast<int>(high_at[b] >> kFraction);
        inside = inside && low[b] >= first[b] && high[b] <= last[b];
      }
      if (inside && occupied({make_key(low[0], low[1], low[2]), make_key(high[0], high[1], high[2])}))
        return true;
    }
  }
  return false;
}

}  // namespace frontlux::planner::detail
