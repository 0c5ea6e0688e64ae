#include "packet/open_voxels.hpp"

#include "packet/open_radii.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <new>
#include <optional>
#include <utility>
#include <vector>

namespace frontlux::detail {
namespace {

// 128 MiB a table. Only pages that bricks are written to take memory.
constexpr std::uint64_t kMaxBits = std::uint64_t{1} << 30U;
constexpr std::size_t kWords = std::tuple_size_v<decltype(Brick::free)>;

// The bricks that hold a box.
KeyBox in_bricks(const KeyBox& box) {
  return {make_key(box.min.x & ~7, box.min.y & ~7, box.min.z & ~7),
          make_key(box.max.x | 7, box.max.y | 7, box.max.z | 7)};
}

std::size_t bricks_along(int min, int max) { return static_cast<std::size_t>((max - min + 1) / 8); }

// Bits that count up to so many.
std::uint32_t bits_for(std::size_t count) { return static_cast<std::uint32_t>(std::bit_width(count - 1)); }

}  // namespace

void OpenVoxels::Release::operator()(std::uint64_t* words) const { std::free(words); }

OpenVoxels::OpenVoxels(const VoxelGrid& grid, UnknownPolicy unknown, const std::optional<KeyBox>& known,
                       const KeyBox& window)
    : unknown_(unknown), window_(window) {
  if (!known) return;
  known_ = in_bricks(*known);
  const auto bounds = intersection(known_, window_);
  if (!bounds) return;
  bounds_ = *bounds;
  // Powers of two along x and y, so that each axis has bits of its own; with a border on either side.
  std::array<std::size_t, 3> needed{};
  for (std::size_t a = 0; a < 3; ++a) needed[a] = bricks_along(bounds_min(a), bounds_max(a)) + 2;
  const auto size = [](const std::array<std::size_t, 3>& bricks) {
    return static_cast<std::uint64_t>(bricks[2]) << (9 + bits_for(bricks[0]) + bits_for(bricks[1]));
  };
  bricks_ = {std::size_t{1} << bits_for(needed[0]), std::size_t{1} << bits_for(needed[1]),
             needed[2] + std::max<std::size_t>(needed[2] / 4, 4)};
  if (size(bricks_) > kMaxBits) bricks_ = needed;
  if (size(bricks_) > kMaxBits) return;
  for (std::size_t a = 0; a < 3; ++a)
    layout_.corner[a] = bounds_min(a) - 8 * static_cast<int>(1 + (bricks_[a] - needed[a]) / 2);
  const std::uint32_t x_bits = bits_for(bricks_[0]), y_bits = bits_for(bricks_[1]);
  layout_.y_shift = 9 + x_bits;
  layout_.z_shift = layout_.y_shift + y_bits;
  const auto field = [](std::uint32_t shift, std::uint32_t width) { return ((1U << width) - 1U) << shift; };
  layout_.bits = {field(0, 3) | field(9, x_bits), field(3, 3) | field(layout_.y_shift, y_bits),
                  field(6, 3) | field(layout_.z_shift, bits_for(bricks_[2]))};
  bricks_[0] = std::size_t{1} << x_bits;
  bricks_[1] = std::size_t{1} << y_bits;

  word_count_ = size(bricks_) / 64;
  words_.reset(static_cast<std::uint64_t*>(std::calloc(word_count_, sizeof(std::uint64_t))));
  if (!words_) throw std::bad_alloc();
  radii_.assign(word_count_ / kWords, 0);
  write_bricks(grid, bounds_);
  measure_radii(bounds_);
}

bool OpenVoxels::update(const VoxelGrid& before, const VoxelGrid& after) {
  std::vector<KeyBox> changes;
  std::optional<KeyBox> changed;
  for_each_change(before, after, [&](const Block& block) {
    const KeyBox box = cube(block.corner, 1 << block.log2_edge);
    changes.push_back(box);
    if (!is_forgotten(block, after)) changed = changed ? hull(*changed, box) : box;
  });
  if (changes.empty()) return true;
  if (empty()) return false;
  const KeyBox known = changed ? hull(known_, *changed) : known_;
  const KeyBox bounds = *intersection(known, window_);  // of the old one at least
  if (!has_room_for(bounds)) return false;
  const KeyBox old = std::exchange(bounds_, bounds);
  known_ = known;
  // What lies in the larger bounds is no border any more.
  if (bounds_ != old && unknown_ == UnknownPolicy::kPass) changes = {bounds_};
  changed.reset();
  for (const KeyBox& change : changes)
    if (const auto box = intersection(change, bounds_)) {
      write_bricks(after, *box);
      changed = changed ? hull(*changed, *box) : *box;
    }
  if (changed) measure_radii(*changed);
  return true;
}

std::size_t OpenVoxels::memory_bytes() const {
  if (empty()) return 0;
  // Rows along x follow each other too closely for a page between their bricks to stay untouched.
  const std::size_t rows =
      bricks_along(bounds_.min.y, bounds_.max.y) * bricks_along(bounds_.min.z, bounds_.max.z);
  return rows * bricks_[0] * kWords * sizeof words_[0] + radii_.size() * sizeof radii_[0];
}

bool OpenVoxels::has_room_for(const KeyBox& bounds) const {
  const auto fits = [&](std::size_t a, int min, int max) {
    return min >= layout_.corner[a] + 8 && max < layout_.corner[a] + 8 * (static_cast<int>(bricks_[a]) - 1);
  };
  return fits(0, bounds.min.x, bounds.max.x) && fits(1, bounds.min.y, bounds.max.y) &&
         fits(2, bounds.min.z, bounds.max.z);
}

// @param box  of whole bricks
void OpenVoxels::write_bricks(const VoxelGrid& grid, const KeyBox& box) {
  for_each_chunk(bricks_along(box.min.z, box.max.z), 1, [&](std::size_t begin, std::size_t end) {
    for (auto z = box.min.z + 8 * begin; z < box.min.z + 8 * end; z += 8)
      for (std::uint32_t y = box.min.y; y <= box.max.y; y += 8)
        for (std::uint32_t x = box.min.x; x <= box.max.x; x += 8) {
          const VoxelKey key = make_key(x, y, static_cast<std::int64_t>(z));
          const Brick& brick = grid.brick(key);
          std::uint64_t* out = &words_[layout_.index(key) / 64];
          for (std::size_t w = 0; w < kWords; ++w) {
            const std::uint64_t open = unknown_ == UnknownPolicy::kBlock ? brick.free[w] : ~brick.occupied[w];
            if (open != out[w]) out[w] = open;
          }
        }
  });
}

void OpenVoxels::measure_radii(const KeyBox& changed) {
  BrickBox box{};
  const std::array min{changed.min.x, changed.min.y, changed.min.z},
      max{changed.max.x, changed.max.y, changed.max.z};
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = static_cast<std::size_t>(min[a] - layout_.corner[a]) / 8;
    box.end[a] = static_cast<std::size_t>(max[a] - layout_.corner[a]) / 8 + 1;
  }
  measure_open_radii(words_.get(), bricks_, box, radii_);
}

}  // namespace frontlux::detail
