#pragma once

#include <Eigen/Core>

#include <compare>
#include <cstdint>

namespace frontlux {

/// What a map knows about a voxel.
enum class Occupancy : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

/// Whether unknown voxels stop a ray. `kBlock` is `castRay(..., ignoreUnknownCells = false)`.
enum class UnknownPolicy : std::uint8_t { kBlock, kPass };

/// Discrete address of a voxel: OctoMap's `OcTreeKey`. Voxel (32768, 32768, 32768) has its lower corner at
/// the world's origin.
struct VoxelKey {
  std::uint16_t x = 0;  ///< number of the voxel along x
  std::uint16_t y = 0;  ///< along y
  std::uint16_t z = 0;  ///< along z
  friend constexpr auto operator<=>(const VoxelKey&, const VoxelKey&) = default;
};

/// A half line, in metres, in the frame of the map.
struct Ray {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();     ///< [m]
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< any length; normalised as OctoMap does, in float
  /// [m] Limit on the distance from origin to voxel *centres*; <= 0 or NaN: no limit.
  double max_range = -1.0;
};

/// A straight line from one point to another, in metres, in the frame of the map.
struct Segment {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Vector3f to = Eigen::Vector3f::Zero();    ///< [m]
};

/// A straight line from the centre of one voxel to the centre of another.
struct KeySegment {
  VoxelKey from;  ///< where it begins
  VoxelKey to;    ///< where it ends
};

/// Why a ray or a counted segment ended.
enum class RayStop : std::uint8_t {
  kInvalid,     ///< no ray: origin outside the key range or not finite, or a direction without length
  kOccupied,    ///< in an occupied voxel; the only case in which castRay returns true
  kUnknown,     ///< in an unknown voxel, under `UnknownPolicy::kBlock`
  kOutOfRange,  ///< in the first voxel whose centre lies beyond `Ray::max_range`; a segment: beyond `to`
  kLeftMap,     ///< in the last voxel before the key range (0..65535) ends
  kReached,     ///< in the voxel of `to`: segments only
};

/// Where a ray ended. With `kInvalid` every other field keeps its default.
struct Hit {
  /// Why it ended.
  RayStop stop = RayStop::kInvalid;
  Occupancy state = Occupancy::kUnknown;          ///< of the voxel in which the ray ended
  VoxelKey key;                                   ///< of that voxel
  Eigen::Vector3f end = Eigen::Vector3f::Zero();  ///< [m] its centre: castRay's `end`, bit for bit
  /// [m] Where the ray enters it (the origin, if it starts inside).
  Eigen::Vector3f entry = Eigen::Vector3f::Zero();
  float distance = 0.0F;  ///< [m] from origin to `entry`

  /// What castRay returns.
  [[nodiscard]] bool occupied() const { return stop == RayStop::kOccupied; }
};

/// How many voxels of each state a path crosses before it stops: from the voxel of its origin, included, to
/// the voxel that stopped it, excluded. Excluded are thus a blocker, the first voxel out of range and the
/// voxel of a segment's `to`; a ray that leaves the key range crosses its last voxel, which counts.
///
/// `occupied` is 0 for a ray, which every occupied voxel stops, and at most 1 for a segment, whose first
/// voxel never blocks.
struct PathCount {
  std::uint32_t unknown = 0;         ///< [voxels]
  std::uint32_t free = 0;            ///< [voxels]
  std::uint32_t occupied = 0;        ///< [voxels]
  RayStop stop = RayStop::kInvalid;  ///< with `kInvalid` nothing is counted

  friend constexpr bool operator==(const PathCount&, const PathCount&) = default;
};

}  // namespace frontlux
