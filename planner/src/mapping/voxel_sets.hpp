#pragma once

#include "mapping/octree_order.hpp"
#include "mapping/ray_path.hpp"

#include <frontlux/brick_table.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::planner::detail {

using frontlux::detail::BrickTable;

/// A set of voxels in a box and one voxel around it, which may lie beyond the key range. A bit for each: for
/// boxes small enough to be cleared for every scan.
class DenseVoxels {
 public:
  static constexpr std::int64_t kMaxBits = std::int64_t{1} << 25;

  /// Nothing if the box is too large.
  [[nodiscard]] static std::optional<DenseVoxels> make(const KeyBox& box) {
    const std::array<int, 3> min = {box.min.x - 1, box.min.y - 1, box.min.z - 1},
                             max = {box.max.x + 1, box.max.y + 1, box.max.z + 1};
    DenseVoxels set;
    std::int64_t bits = 512;
    for (std::size_t i = 0; i < 3; ++i) {
      set.corner_[i] = (min[i] >> 3) * 8;
      set.bricks_[i] = (max[i] >> 3) - (min[i] >> 3) + 1;
      if (bits > kMaxBits / set.bricks_[i]) return std::nullopt;
      bits *= set.bricks_[i];
    }
    set.bytes_.resize(static_cast<std::size_t>(bits / 8));
    return set;
  }

  [[nodiscard]] LinearPlaces places() const {
    const std::array<std::int64_t, 3> stride = {1, bricks_[0] * 8, bricks_[0] * bricks_[1] * 64};
    return {stride, -(corner_[0] * stride[0] + corner_[1] * stride[1] + corner_[2] * stride[2])};
  }

  /// Adds a voxel. @return false if there is no such place
  bool add(std::int64_t place, unsigned /*lane*/ = 0) {
    const auto byte = static_cast<std::uint64_t>(place) >> 3;
    if (byte >= bytes_.size()) return false;
    bytes_[byte] = static_cast<std::uint8_t>(bytes_[byte] | (1U << (place & 7)));
    return true;
  }

  void add(const DenseVoxels& other) {
    for (std::size_t i = 0; i < bytes_.size(); ++i)
      bytes_[i] = static_cast<std::uint8_t>(bytes_[i] | other.bytes_[i]);
  }

  /// Calls `visit(corner)` for every brick of the key range that may hold voxels of the set.
  template <class Visit>
  void for_each_brick(const Visit& visit) const {
    const auto along = [this](std::size_t axis, std::int64_t i) { return corner_[axis] + 8 * i; };
    const auto in_range = [](std::int64_t k) { return k >= 0 && k < Lattice::kKeysPerAxis; };
    for (std::int64_t z = 0; z < bricks_[2]; ++z)
      for (std::int64_t y = 0; y < bricks_[1]; ++y)
        for (std::int64_t x = 0; x < bricks_[0]; ++x)
          if (in_range(along(0, x)) && in_range(along(1, y)) && in_range(along(2, z)))
            visit(make_key(along(0, x), along(1, y), along(2, z)));
  }

  [[nodiscard]] Layers brick(const VoxelKey& corner) const {
    const std::int64_t row = bricks_[0], layer = row * bricks_[1] * 8;  // in bytes: x takes one per brick
    auto byte = static_cast<std::size_t>(places().at(corner) / 8);
    Layers layers{};
    for (std::size_t z = 0; z < 8; ++z, byte += static_cast<std::size_t>(layer))
      for (unsigned y = 0; y < 8; ++y)
        layers[z] |= static_cast<std::uint64_t>(bytes_[byte + y * static_cast<std::size_t>(row)]) << (8 * y);
    return layers;
  }

 private:
  std::array<std::int64_t, 3> corner_{}, bricks_{};
  std::vector<std::uint8_t> bytes_;
};

/// The same for boxes of any size: a table of the bricks that rays meet.
class SparseVoxels {
 public:
  // A field of 21 bits for each axis, moved by a brick so that a step below the key range borrows nothing.
  [[nodiscard]] static LinearPlaces places() { return {kStride, 8 * (kStride[0] + kStride[1] + kStride[2])}; }

  /// Adds a voxel; fast if the last one of the lane was in the same brick.
  bool add(std::int64_t place, unsigned lane = 0) {
    Last& last = last_[lane];
    const std::int64_t number = place & ~kInBrick;
    if (number != last.number) {
      last.index = bricks_.index(static_cast<std::uint64_t>(number));
      last.number = number;
    }
    const auto x = place & 7, y = (place >> 21) & 7, z = (place >> 42) & 7;
    bricks_.value(last.index)[static_cast<std::size_t>(z)] |= std::uint64_t{1} << (8 * y + x);
    return true;
  }

  void add(const SparseVoxels& other) {
    for (const auto& [number, layers] : other.bricks_.entries()) {
      Layers& mine = bricks_[number];
      for (std::size_t z = 0; z < 8; ++z) mine[z] |= layers[z];
    }
  }

  template <class Visit>
  void for_each_brick(const Visit& visit) const {
    for (const auto& entry : bricks_.entries()) {
      const auto along = [&entry](unsigned axis) {
        return static_cast<std::int64_t>((entry.number >> (21 * axis)) & 0x1F'FFFF) - 8;
      };
      const auto in_range = [](std::int64_t k) { return k >= 0 && k < Lattice::kKeysPerAxis; };
      if (in_range(along(0)) && in_range(along(1)) && in_range(along(2)))
        visit(make_key(along(0), along(1), along(2)));
    }
  }

  [[nodiscard]] Layers brick(const VoxelKey& corner) const {
    const Layers* layers = bricks_.find(static_cast<std::uint64_t>(places().at(corner)));
    return layers == nullptr ? Layers{} : *layers;
  }

 private:
  static constexpr std::array<std::int64_t, 3> kStride = {1, std::int64_t{1} << 21, std::int64_t{1} << 42};
  static constexpr std::int64_t kInBrick = 7 * (kStride[0] + kStride[1] + kStride[2]);

  BrickTable<Layers> bricks_;
  struct Last {
    std::int64_t number = -1;
    std::size_t index = 0;
  };
  std::array<Last, PathLanes::kLanes> last_{};
};

}  // namespace frontlux::planner::detail
