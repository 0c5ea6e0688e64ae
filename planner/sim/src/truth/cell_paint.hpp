#pragma once

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace frontlux::sim {

namespace cell {
/// What the ground truth stores of a voxel.
enum Flag : std::uint8_t {
  kSolid = 1,          ///< a surface passes through it, deeper than the margin
  kWallBelow = 2,      ///< a surface on its lower face across x; two more bits for y and z
  kReached = 16,       ///< by the flood
  kNextToReached = 32  ///< by a face
};
}  // namespace cell

/// A block of voxels in metres.
struct CellFrame {
  Eigen::Vector3d corner;             ///< [m] lowest corner of the lowest voxel
  double edge = 0.0;                  ///< [m] of a voxel
  double margin = 0.0;                ///< [m]
  Eigen::Vector3<std::int64_t> size;  ///< in voxels

  /// The voxels from `low` to `high`, both included, grown on all sides [m].
  [[nodiscard]] Eigen::AlignedBox3d box(const Eigen::Vector3<std::int64_t>& low,
                                        const Eigen::Vector3<std::int64_t>& high, double grown) const {
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(grown);
    return {corner + low.cast<double>() * edge - room,
            corner + (high.cast<double>() + Eigen::Vector3d::Ones()) * edge + room};
  }
};

/// Marks the cells (x fastest) that surfaces pass through, and the faces that they lie on, in parallel over
/// TBB's current arena. The faces of a solid cell are not marked.
/// @throws std::invalid_argument if that would take minutes: many large triangles pass through the same cells
/// @pre cells.size() is the product of frame.size, and the mesh is valid
void paint(const TriangleMesh& mesh, const CellFrame& frame, std::vector<std::uint8_t>& cells);

}  // namespace frontlux::sim
