#pragma once

#include "voxel/cell_code.hpp"

#include <frontlux/view_region.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::detail {

/// Targets by cubes of 8 voxels a side, and these by cubes of 64, so that the targets near a place are found
/// without looking at the others. They are in the order of `cell_code`, which depends on nothing else: the
/// targets around a place keep their order whatever happens elsewhere.
class TargetIndex {
 public:
  /// A run of targets, and the cube that holds them.
  struct Cube {
    KeyBox box;
    std::uint32_t begin = 0, end = 0;  ///< of targets; for cubes of 64 of cubes of 8
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };

  /// @param targets  in any order; repeated ones count once
  /// @throws std::invalid_argument if they are more than 2^32 - 1
  explicit TargetIndex(std::span<const VoxelKey> targets);

  /// Their codes, ascending.
  [[nodiscard]] std::span<const std::uint64_t> codes() const { return codes_; }
  /// Their voxels, in the same order.
  [[nodiscard]] std::span<const VoxelKey> keys() const { return keys_; }
  /// Cubes of 8 voxels a side with targets, in order.
  [[nodiscard]] std::span<const Cube> cubes() const { return cubes_; }

  /// Lists the cubes, by number and in order, that may have a voxel in view from a voxel of a box.
  void list_cubes(const ViewRegion& view, const KeyBox& from, std::vector<std::uint32_t>& cubes) const;

 private:
  std::vector<std::uint64_t> codes_;
  std::vector<VoxelKey> keys_;
  std::vector<Cube> cubes_, regions_;
};

}  // namespace frontlux::detail
