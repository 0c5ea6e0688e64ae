#pragma once

#include <frontlux/octomap.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::bench {

/// What single calls of castRay answered. Sized once and written in place, so that no allocation is timed.
struct CastRayAnswers {
  /// What `end` holds before a call: castRay leaves some of them untouched.
  static inline const Eigen::Vector3f kUntouched{-1.5F, -2.5F, -3.5F};

  explicit CastRayAnswers(std::size_t count) : occupied(count, 0), end(count, kUntouched) {}

  std::vector<std::uint8_t> occupied;  ///< castRay's return value
  std::vector<Eigen::Vector3f> end;
};

/// One castRay after the other, in blocks over TBB's current arena.
/// @pre the answers have as many places as there are rays
/// @{
void cast_ray_loop(const Octree& tree, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers);
void cast_ray_loop(const OctreeRayCaster& caster, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers);
void cast_ray_loop(const RayCaster& caster, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers);
/// @}

/// Memory of the tree as OctoMap counts it [bytes].
[[nodiscard]] std::size_t memory_bytes(const Octree& tree);

}  // namespace frontlux::bench
