#pragma once

#include "walk/walk.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>

#include <optional>

namespace frontlux::detail {

/// The end of a ray that no voxel stops: the first voxel out of range or the last one of the key range. Found
/// by arithmetic instead of voxel by voxel, for which castRay needs 0.5 ms on an unlimited ray.
/// @param key        voxel of the ray's origin
/// @param direction  as castRay normalises it, of unit length
/// @return kOutOfRange or kLeftMap; none where rounding in castRay's own traversal could decide: then the
/// walk must
std::optional<RayEnd> find_free_end(const Lattice& lattice, const Ray& ray, const VoxelKey& key,
                                    const Eigen::Vector3f& direction);

/// Most voxels that it looks at.
inline constexpr int kMostStepsToEnd = 32;
/// castRay reaches a crossing by at most 2^17 additions, each off by half an ulp of a time below 2^18 voxels:
/// 1e-11 of that time. Its first crossing, and ours, are off by an ulp of a coordinate below 2^17 voxels,
/// over the direction. 1e-9 leaves a factor of 50 and more.
inline constexpr double kRelativeErrorOfTimes = 1e-9;

/// By how much a crossing near a ray's end may be off. All in voxels.
/// @param between  time from one crossing of its axis to the next
/// @param last     when the ray ends
inline double error_of_crossing(double between, double last) {
  return kRelativeErrorOfTimes * (between + last + kMostStepsToEnd);
}
/// How far a point of the ray has to be from a voxel's faces to be surely in it. In voxels.
inline double margin_of_entry(double last) { return 1e-6 + kRelativeErrorOfTimes * last; }

}  // namespace frontlux::detail
