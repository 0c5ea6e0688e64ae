#pragma once

#include "walk/walk.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace frontlux::detail {

/// A line's path through a grid, voxel by voxel: the inner loop of every walk. The processor cannot predict
/// which axis is next, so a step takes no branch on it: all three axes move, two of them by zero. The
/// counters of the three axes are fields of one word.
/// @tparam kBack  whether the path is that of the same line from its other end, taken back; exact times only
template <class Time, bool kBack = false>
class GridPath {
 public:
  /// @param steps_left  per axis, how many steps the path may take before `overstepped`; at most 2^17
  GridPath(const VoxelGrid& grid, UnknownPolicy unknown, const VoxelKey& start, const Crossings<Time>& line,
           const std::array<int, 3>& steps_left)
      : grid_(grid), flip_(unknown == UnknownPolicy::kBlock ? ~std::uint64_t{0} : 0), line_(line) {
    const auto key = as_array(start);
    in_brick_ = left_ = kNotNegative;
    for (std::size_t i = 0; i < 3; ++i) {
      const int inside = key[i] & 7;
      corner_[i] = key[i] & ~7;
      local_ += inside << (3 * i);
      local_step_[i] = line.step[i] * (1 << (3 * i));
      in_brick_ += one(i) * (line.step[i] > 0 ? 7 - inside : inside);
      left_ += one(i) * steps_left[i];
    }
    enter_tile();
  }

  /// One step. @return the time at which it is taken
  [[gnu::always_inline]] Time advance() {
    const Time tx = line_.t_max[0], ty = line_.t_max[1], tz = line_.t_max[2];
    // Ties go to z before y before x (rule 5): walked backward to x before y before z.
    const bool x_before_y = kBack ? tx <= ty : tx < ty;
    const Time first = x_before_y ? tx : ty;
    const bool z_next = kBack ? tz < first : tz <= first;
    const std::int64_t z = -static_cast<std::int64_t>(z_next), not_z = ~z;
    const std::int64_t x = -static_cast<std::int64_t>(x_before_y) & not_z, y = ~x & not_z;
    take(x, y, z);
    local_ += (x & local_step_[0]) + (y & local_step_[1]) + (z & local_step_[2]);
    const std::int64_t taken = (x & one(0)) + (y & one(1)) + (z & one(2));
    in_brick_ -= taken;
    left_ -= taken;
    return z_next ? tz : first;
  }

  /// Whether the path took more steps along an axis than it may.
  [[nodiscard]] bool overstepped() const { return (left_ & kNotNegative) != kNotNegative; }
  /// Whether it took all of them.
  [[nodiscard]] bool exhausted() const { return left_ == kNotNegative; }

  /// How many steps are left, per axis; -1 along one that overstepped.
  [[nodiscard]] std::array<int, 3> steps_left() const {
    std::array<int, 3> steps{};
    for (std::size_t i = 0; i < 3; ++i)
      steps[i] = static_cast<int>((left_ >> (21 * i)) & (2 * kZero - 1)) - static_cast<int>(kZero);
    return steps;
  }
  /// The line's crossings as seen from the present voxel.
  [[nodiscard]] const Crossings<Time>& line() const { return line_; }

  /// Fetches the brick that the last step led into; to be called after each step that did not overstep.
  /// @return whether it lies in another tile
  [[gnu::always_inline]] bool fetch_brick() {
    return (in_brick_ & kNotNegative) != kNotNegative && enter_next_brick();
  }

  [[nodiscard]] bool blocked() const {
    const std::uint64_t word = (*plane_)[static_cast<std::size_t>(local_ >> 6)] ^ flip_;
    return ((word >> (local_ & 63)) & 1U) != 0;
  }

  [[nodiscard]] bool free() const {
    return ((brick_->free[static_cast<std::size_t>(local_ >> 6)] >> (local_ & 63)) & 1U) != 0;
  }

  [[nodiscard]] VoxelKey key() const { return key_at(static_cast<int>(local_)); }
  /// The key from which a step overstepped.
  [[nodiscard]] VoxelKey key_before_overstep() const {
    std::int64_t local = local_;
    for (std::size_t i = 0; i < 3; ++i)
      if ((left_ & not_negative(i)) == 0) local -= local_step_[i];
    return key_at(static_cast<int>(local));
  }
  [[nodiscard]] const Tile& tile() const { return *tile_; }
  [[nodiscard]] Occupancy state() const { return brick_->at(key()); }

 private:
  // Fields of 21 bits. The highest is set while the count below it is not negative, and keeps it from
  // borrowing from the next field.
  static constexpr std::int64_t kZero = std::int64_t{1} << 20;
  static constexpr std::int64_t one(std::size_t axis) { return std::int64_t{1} << (21 * axis); }
  static constexpr std::int64_t not_negative(std::size_t axis) { return one(axis) * kZero; }
  static constexpr std::int64_t kNotNegative = not_negative(0) | not_negative(1) | not_negative(2);

  [[nodiscard]] VoxelKey key_at(int local) const {
    return as_key({corner_[0] + (local & 7), corner_[1] + ((local >> 3) & 7), corner_[2] + (local >> 6)});
  }

  // Adds to the time of the axis whose mask is set.
  [[gnu::always_inline]] void take(std::int64_t x, std::int64_t y, std::int64_t z) {
#ifdef __SSE2__
    // The same comparisons again, in the registers that hold the times: a mask from an integer register would
    // arrive there so late that a step took a fifth longer.
    if constexpr (std::is_same_v<Time, double>) {
      const __m128d tx = _mm_set_sd(line_.t_max[0]), ty = _mm_set_sd(line_.t_max[1]),
                    tz = _mm_set_sd(line_.t_max[2]);
      const __m128d x_before_y = _mm_cmplt_sd(tx, ty), not_z = _mm_cmplt_sd(_mm_min_sd(tx, ty), tz);
      const auto add = [](double& t, const __m128d& before, const __m128d& delta) {
        t = _mm_cvtsd_f64(_mm_add_sd(before, delta));
      };
      const __m128d dx = _mm_set_sd(line_.t_delta[0]), dy = _mm_set_sd(line_.t_delta[1]),
                    dz = _mm_set_sd(line_.t_delta[2]);
      add(line_.t_max[0], tx, _mm_and_pd(_mm_and_pd(x_before_y, not_z), dx));
      add(line_.t_max[1], ty, _mm_and_pd(_mm_andnot_pd(x_before_y, not_z), dy));
      add(line_.t_max[2], tz, _mm_andnot_pd(not_z, dz));
      return;
    }
#endif
    line_.t_max[0] += only_if(x, line_.t_delta[0]);
    line_.t_max[1] += only_if(y, line_.t_delta[1]);
    line_.t_max[2] += only_if(z, line_.t_delta[2]);
  }
  [[gnu::always_inline]] static Time only_if(std::int64_t mask, Time value) {
    if constexpr (std::is_same_v<Time, double>)
      return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) & mask);
    else
      return value & mask;
  }

  [[gnu::always_inline]] bool enter_next_brick() {
    int changed = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if ((in_brick_ & not_negative(i)) != 0) continue;
      in_brick_ += 8 * one(i);
      local_ -= 8 * local_step_[i];
      const int before = corner_[i];
      corner_[i] += 8 * line_.step[i];
      changed |= before ^ corner_[i];
    }
    const bool other_tile = (changed & ~63) != 0;
    if (other_tile)
      enter_tile();
    else
      enter_brick();
    return other_tile;
  }
  [[gnu::always_inline]] void enter_tile() {
    tile_ = &grid_.tile(as_key(corner_));
    enter_brick();
  }
  [[gnu::always_inline]] void enter_brick() {
    brick_ = &tile_->brick(as_key(corner_));
    plane_ = flip_ != 0 ? &brick_->free : &brick_->occupied;  // "not free" blocks, or "occupied"
  }

  const VoxelGrid& grid_;
  std::uint64_t flip_;
  Crossings<Time> line_;
  std::array<int, 3> corner_{};  // lowest key of the brick
  std::int64_t local_ = 0;       // voxel in the brick: 64 z + 8 y + x
  std::array<std::int64_t, 3> local_step_{};
  std::int64_t in_brick_ = 0;  // steps until the brick ends, per axis
  std::int64_t left_ = 0;
  const Tile* tile_ = nullptr;
  const Brick* brick_ = nullptr;
  const std::array<std::uint64_t, 8>* plane_ = nullptr;
};

}  // namespace frontlux::detail
