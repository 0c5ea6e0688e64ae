#include "view/exact/view_window.hpp"

#include <algorithm>

namespace frontlux::detail {
namespace {

constexpr int kBrick = 8;

// Of the eight bits of each byte every stride-th from `first` on, moved together.
std::uint64_t every_bit(std::uint64_t bytes, int stride, int first) {
  if (stride == 1) return bytes;
  bytes >>= first;
  if (stride == 4) {
    bytes &= 0x1111111111111111U;
    return (bytes | bytes >> 3U) & 0x0303030303030303U;
  }
  bytes &= 0x5555555555555555U;
  bytes = (bytes | bytes >> 1U) & 0x3333333333333333U;
  return (bytes | bytes >> 2U) & 0x0F0F0F0F0F0F0F0FU;
}

std::size_t size(int number) { return static_cast<std::size_t>(number); }

}  // namespace

void ViewWindow::aim(const WindowLayout& layout, const std::array<int, 3>& first_place, int top) {
  layout_ = layout;
  const std::array<int, 3> reach{layout.reach_x, layout.reach_y, layout.reach_z};
  const std::array<int, 3> last_place{first_place[0] + (ViewTile::kColumns - 1) * layout.stride_x,
                                      first_place[1] + (ViewTile::kRows - 1) * layout.stride_y, top};
  const std::array<int, 3> unit{kBrick * layout.stride_x, kBrick * layout.stride_y, 1};
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = first_place[a] - reach[a];
    high_[a] = last_place[a] + reach[a];
    corner_[a] = low_[a] - ((low_[a] % unit[a]) + unit[a]) % unit[a];
  }
  const int across = high_[0] - corner_[0] + 1, along = high_[1] - corner_[1] + 1;
  bytes_across_ = size((across - 1) / unit[0] + 1) + 3;  // what `spread` may look at beyond
  run_ = size((along - 1) / unit[1] + 1) * kBrick;
}

ViewWindow::Bit ViewWindow::bit(const std::array<int, 3>& from_corner) const {
  const std::size_t sx = size(layout_.stride_x), sy = size(layout_.stride_y);
  const std::size_t x = size(from_corner[0]), y = size(from_corner[1]);
  const std::size_t column = (size(from_corner[2]) * sx + x % sx) * bytes_across_ + x / sx / 8;
  return {(column * sy + y % sy) * run_ + y / sy, static_cast<unsigned>(x / sx % 8)};
}

void ViewWindow::clear_packed() {
  packed_.assign(levels() * size(layout_.stride_x * layout_.stride_y) * bytes_across_ * run_, 0);
  present_.assign(levels(), 0);
  spread_.resize(levels() * layout_.level_bytes() / sizeof(std::uint16_t));
}

void ViewWindow::spread_level(std::size_t level, const TrieWalk& walk) {
  const std::size_t level_size = layout_.level_bytes() / sizeof(std::uint16_t);
  std::uint16_t* const out = spread_.data() + level * level_size;
  if (present_[level] == 0) {
    std::fill_n(out, level_size, std::uint16_t{0});
    return;
  }
  const int sx = layout_.stride_x, sy = layout_.stride_y;
  const int x = low_[0] - corner_[0], y = low_[1] - corner_[1];
  for (int column = 0; column < std::min(sx, layout_.columns()); ++column)
    for (int row = 0; row < sy; ++row) {
      const Bit first = bit({(x + column) % sx, y + row, static_cast<int>(level)});
      const SpreadFrom from{packed_.data() + first.byte, size(sy) * run_, size((x + column) / sx)};
      walk.spread(from, size(layout_.run()), size((layout_.columns() - column - 1) / sx + 1),
                  size(sx * layout_.rows()), out + size(column * layout_.rows() + row * layout_.run()));
    }
}

void ViewWindow::fill_free(const VoxelGrid& grid, const TrieWalk& walk) {
  clear_packed();
  const int sx = layout_.stride_x, sy = layout_.stride_y;
  const auto aligned = [](int k) { return std::max(k, 0) / kBrick * kBrick; };
  const auto limit = [](int k) { return std::min(k, Lattice::kKeysPerAxis - 1); };
  for (int bz = aligned(low_[2]); bz <= limit(high_[2]); bz += kBrick)
    for (int by = aligned(corner_[1]); by <= limit(high_[1]); by += kBrick)
      for (int bx = aligned(corner_[0]); bx <= limit(high_[0]); bx += kBrick) {
        const Brick& brick = grid.brick(make_key(bx, by, bz));
        for (int z = std::max(bz, low_[2]); z < std::min(bz + kBrick, high_[2] + 1); ++z) {
          const std::uint64_t free = brick.free[size(z - bz)];
          if (free == 0) continue;
          present_[size(z - low_[2])] = 1;
          for (int column = 0; column < sx; ++column) {
            const std::uint64_t bits = every_bit(free, sx, column);
            for (int row = 0; row < sy; ++row) {
              const Bit first = bit({bx - corner_[0] + column, by - corner_[1] + row, z - low_[2]});
              std::uint8_t* const out = packed_.data() + first.byte;
              for (int k = 0; k < kBrick / sy; ++k)
                out[k] =
                    static_cast<std::uint8_t>(out[k] | (bits >> (8 * (row + k * sy)) & 0xFFU) << first.shift);
            }
          }
        }
      }
  for (std::size_t level = 0; level < levels(); ++level) spread_level(level, walk);
}

void ViewWindow::fill_targets(const TargetIndex& targets, const ViewRegion& view, const TrieWalk& walk,
                              std::vector<VoxelKey>& list) {
  list.clear();
  const auto last = [](int high, int reach) { return std::min(high - reach, Lattice::kKeysPerAxis - 1); };
  targets.list_cubes(
      view,
      {make_key(low_[0] + layout_.reach_x, low_[1] + layout_.reach_y, low_[2] + layout_.reach_z),
       make_key(last(high_[0], layout_.reach_x), last(high_[1], layout_.reach_y),
                last(high_[2], layout_.reach_z))},
      cubes_);
  if (cubes_.empty()) return;
  clear_packed();
  for (const std::uint32_t c : cubes_) {
    const TargetIndex::Cube& cube = targets.cubes()[c];
    for (const VoxelKey& key : targets.keys().subspan(cube.begin, cube.size())) {
      const std::array<int, 3> voxel{key.x, key.y, key.z};
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a) inside = inside && low_[a] <= voxel[a] && voxel[a] <= high_[a];
      if (!inside) continue;
      list.push_back(key);
      const Bit place = bit({voxel[0] - corner_[0], voxel[1] - corner_[1], voxel[2] - low_[2]});
      packed_[place.byte] = static_cast<std::uint8_t>(packed_[place.byte] | 1U << place.shift);
      present_[size(voxel[2] - low_[2])] = 1;
    }
  }
  for (std::size_t level = 0; level < levels(); ++level) spread_level(level, walk);
}

}  // namespace frontlux::detail
