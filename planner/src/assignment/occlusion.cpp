#include "assignment/occlusion.hpp"

#include <algorithm>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxWords = std::uint64_t{1} << 25;

// Bits from `low` to `high` of a word that starts at `base`.
std::uint64_t run(int low, int high, int base) {
  low = std::max(low - base, 0);
  high = std::min(high - base, 63);
  return low > high ? 0 : (~std::uint64_t{0} >> (63 - high)) & (~std::uint64_t{0} << low);
}

}  // namespace

Occlusion::Occlusion(const VoxelGrid& grid, const KeyBox& box) {
  const auto known = grid.known_bounds();
  if (!known) return;
  const auto high = std::array<int, 3>{std::min(box.max.x, known->max.x), std::min(box.max.y, known->max.y),
                                       std::min(box.max.z, known->max.z)};
  low_ = {std::max(box.min.x, known->min.x), std::max(box.min.y, known->min.y),
          std::max(box.min.z, known->min.z)};
  for (std::size_t a = 0; a < 3; ++a)
    if (high[a] < low_[a]) return;
  const auto size = [&](std::size_t a) { return static_cast<std::uint64_t>(high[a] - low_[a] + 1); };
  words_ = (size(2) + 63) / 64;
  if (size(0) * size(1) * words_ > kMaxWords) return;
  for (std::size_t a = 0; a < 3; ++a) size_[a] = static_cast<int>(size(a));
  bits_.assign(size(0) * size(1) * words_, 0);
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick == nullptr && state != Occupancy::kOccupied) return;
    const int edge = 1 << block.log2_edge;
    const int x0 = block.corner.x - low_[0], y0 = block.corner.y - low_[1], z0 = block.corner.z - low_[2];
    for (int x = std::max(0, x0); x < std::min(size_[0], x0 + edge); ++x)
      for (int y = std::max(0, y0); y < std::min(size_[1], y0 + edge); ++y) {
        std::uint64_t* column = &bits_[static_cast<std::size_t>(x * size_[1] + y) * words_];
        if (brick == nullptr) {
          for (std::size_t w = 0; w < words_; ++w)
            column[w] |= run(std::max(0, z0), std::min(size_[2], z0 + edge) - 1, static_cast<int>(w) * 64);
          continue;
        }
        for (int z = std::max(0, z0); z < std::min(size_[2], z0 + edge); ++z)
          column[z >> 6] |=
              ((brick->occupied[static_cast<std::size_t>(z - z0)] >> (8 * (y - y0) + x - x0)) & 1U)
              << (z & 63);
      }
  });
}

bool Occlusion::occupied(const std::array<int, 3>& low, const std::array<int, 3>& high) const {
  const int first = low[2] >> 6, last = high[2] >> 6;
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y) {
      const std::uint64_t* column = &bits_[static_cast<std::size_t>(x * size_[1] + y) * words_];
      for (int w = first; w <= last; ++w)
        if ((~column[w] & run(low[2], high[2], w * 64)) != 0) return false;
    }
  return true;
}

// A line from a voxel's centre to the target's crosses the middle of a layer between them at a point, and its
// path visits the voxel that holds the point, or both that share it. Seen from the target the point lies at
// the share m / d of the offset, with d layers to the voxel and m to the layer in question; so the points of
// all lines from the box lie in a rectangle. Its sides, as m grows, are lines: in fixed point, rounded
// outwards.
bool Occlusion::hides(const VoxelKey& target, const KeyBox& from) const {
  if (bits_.empty()) return false;
  constexpr int kFraction = 32;
  constexpr double kOne = 0x1p32;
  constexpr std::int64_t kHalf = std::int64_t{1} << (kFraction - 1);
  const std::array<int, 3> t = {target.x, target.y, target.z};
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
      low_at[b] = (std::int64_t{t[b] - low_[b]} << kFraction) + kHalf - 1;
      high_at[b] = (std::int64_t{t[b] - low_[b]} << kFraction) + kHalf;
    }
    for (int m = 1; m < nearest; ++m) {
      bool inside = true;
      for (std::size_t b = 0; b < 3; ++b) {
        low_at[b] += low_step[b];
        high_at[b] += high_step[b];
        low[b] = b == axis ? t[b] - low_[b] + side * m : static_cast<int>(low_at[b] >> kFraction);
        high[b] = b == axis ? low[b] : static_cast<int>(high_at[b] >> kFraction);
        inside = inside && low[b] >= 0 && high[b] < size_[b];
      }
      if (inside && occupied(low, high)) return true;
    }
  }
  return false;
}

}  // namespace frontlux::planner::detail
