#pragma once

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace frontlux::detail {

/// A box of cells in a BoxGroup: six fields of ten bits, the first and the last cell along x, y and z.
enum class PackedBox : std::uint64_t {};

[[nodiscard]] constexpr PackedBox pack(const std::array<int, 3>& first, const std::array<int, 3>& last) {
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < 3; ++i)
    bits |= (static_cast<std::uint64_t>(first[i]) | static_cast<std::uint64_t>(last[i]) << 10) << (20 * i);
  return PackedBox{bits};
}
[[nodiscard]] constexpr int first_cell(PackedBox box, unsigned axis) {
  return static_cast<int>((static_cast<std::uint64_t>(box) >> (20 * axis)) & 1023);
}
[[nodiscard]] constexpr int last_cell(PackedBox box, unsigned axis) {
  return static_cast<int>((static_cast<std::uint64_t>(box) >> (20 * axis + 10)) & 1023);
}

/// The boxes of one cube of kEdge voxels, or of all storage nodes in which every voxel blocks. Immutable.
struct BoxGroup {
  static constexpr int kEdge = 32;
  static constexpr int kUnitEdge = 16;
  static constexpr int kUnits = 8;

  VoxelKey corner;    ///< of cell (0, 0, 0)
  int log2_cell = 0;  ///< edge of a cell in voxels: 2^log2_cell
  std::vector<PackedBox> boxes;
  std::vector<std::uint32_t> unit_end;  ///< of a cube: where the boxes of each of its units end
  KeyBox bounds;                        ///< around all boxes, if there are any
  std::uint64_t face_area = 0;          ///< sum over the boxes of their largest faces, in voxels

  [[nodiscard]] KeyBox box(std::size_t index) const;
};

/// Boxes of blockers that together cover the shell: every blocker with a face neighbour that does not block.
/// A ray from free space meets the shell first. It enters a box where it enters a blocker, so the box that it
/// enters first gives the first blocker.
///
/// Boxes may overlap, and each lies inside its unit: a cube of BoxGroup::kUnitEdge voxels, or a whole storage
/// node. So a change makes only the units at and beside it stale, and all other groups remain shared.
struct Blockers {
  std::vector<std::shared_ptr<const BoxGroup>> groups;  ///< whole nodes, then cubes with boxes by corner

  [[nodiscard]] std::size_t box_count() const;
};

/// @param unknown whether unknown voxels are blockers
[[nodiscard]] Blockers make_blockers(const VoxelGrid& grid, UnknownPolicy unknown);

/// The same as `make_blockers(after, unknown)`, from those of an earlier grid: only stale units are built
/// again.
[[nodiscard]] Blockers update_blockers(const Blockers& blockers, const VoxelGrid& before,
                                       const VoxelGrid& after, UnknownPolicy unknown);

}  // namespace frontlux::detail
