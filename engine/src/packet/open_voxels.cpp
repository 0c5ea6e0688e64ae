#include "packet/open_voxels.hpp"

#include "packet/open_radii.hpp"

#include <frontlux/parallel.hpp>

#include <bit>
#include <cstdlib>
#include <new>

namespace frontlux::detail {
namespace {

// 128 MiB a table. Only pages that bricks are written to take memory.
constexpr std::uint64_t kMaxBits = std::uint64_t{1} << 30U;
constexpr std::size_t kWords = std::tuple_size_v<decltype(Brick::free)>;

}  // namespace

void OpenVoxels::Release::operator()(std::uint64_t* words) const { std::free(words); }

OpenVoxels::OpenVoxels(const VoxelGrid& grid, UnknownPolicy unknown) {
  const auto known = grid.known_bounds();
  if (!known) return;
  bounds_ = {make_key(known->min.x & ~7, known->min.y & ~7, known->min.z & ~7),
             make_key(known->max.x | 7, known->max.y | 7, known->max.z | 7)};
  layout_.corner = {bounds_.min.x - 8, bounds_.min.y - 8, bounds_.min.z - 8};

  // Bricks with the border: rounded up to powers of two along x and y, so that each axis has bits of its own.
  const auto bricks = [](std::uint16_t min, std::uint16_t max) {
    return (static_cast<std::uint32_t>(max - min) >> 3U) + 3U;
  };
  const auto bits = [](std::uint32_t count) { return static_cast<std::uint32_t>(std::bit_width(count - 1)); };
  const std::uint32_t x_bits = bits(bricks(bounds_.min.x, bounds_.max.x));
  const std::uint32_t y_bits = bits(bricks(bounds_.min.y, bounds_.max.y));
  const std::uint32_t z_bricks = bricks(bounds_.min.z, bounds_.max.z);
  layout_.y_shift = 9 + x_bits;
  layout_.z_shift = layout_.y_shift + y_bits;
  const std::uint64_t size = static_cast<std::uint64_t>(z_bricks) << layout_.z_shift;
  if (size > kMaxBits) return;
  const auto field = [](std::uint32_t shift, std::uint32_t width) { return ((1U << width) - 1U) << shift; };
  layout_.bits = {field(0, 3) | field(9, x_bits), field(3, 3) | field(layout_.y_shift, y_bits),
                  field(6, 3) | field(layout_.z_shift, bits(z_bricks))};

  word_count_ = size / 64;
  words_.reset(static_cast<std::uint64_t*>(std::calloc(word_count_, sizeof(std::uint64_t))));
  if (!words_) throw std::bad_alloc();
  const std::size_t layers = z_bricks - 2;
  for_each_chunk(layers, 1, [&](std::size_t begin, std::size_t end) {
    for (auto z = bounds_.min.z + 8 * begin; z < bounds_.min.z + 8 * end; z += 8)
      for (std::uint32_t y = bounds_.min.y; y <= bounds_.max.y; y += 8)
        for (std::uint32_t x = bounds_.min.x; x <= bounds_.max.x; x += 8) {
          const VoxelKey key = make_key(x, y, static_cast<std::int64_t>(z));
          const Brick& brick = grid.brick(key);
          std::uint64_t* out = &words_[layout_.index(key) / 64];
          for (std::size_t w = 0; w < kWords; ++w) {
            const std::uint64_t open = unknown == UnknownPolicy::kBlock ? brick.free[w] : ~brick.occupied[w];
            if (open != 0) out[w] = open;
          }
        }
  });
  radii_ = open_radii(words_.get(), std::size_t{1} << x_bits, std::size_t{1} << y_bits, z_bricks);
}

}  // namespace frontlux::detail
