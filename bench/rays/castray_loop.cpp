#include "rays/castray_loop.hpp"

#include "octomap/own_castray.hpp"

#include <frontlux/parallel.hpp>

namespace frontlux::bench {
namespace {

template <class CastOne>
void in_blocks(std::size_t count, const CastOne& cast_one) {
  for_each_chunk(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) cast_one(i);
  });
}

// `cast` has the arguments and the answer of castRay.
template <class Cast>
void loop(std::span<const Ray> rays, UnknownPolicy unknown, CastRayAnswers& answers, const Cast& cast) {
  const bool ignore_unknown = unknown == UnknownPolicy::kPass;
  in_blocks(rays.size(), [&](std::size_t i) {
    const Ray& ray = rays[i];
    const octomap::point3d origin(ray.origin.x(), ray.origin.y(), ray.origin.z());
    const octomap::point3d direction(ray.direction.x(), ray.direction.y(), ray.direction.z());
    octomap::point3d end(CastRayAnswers::kUntouched.x(), CastRayAnswers::kUntouched.y(),
                         CastRayAnswers::kUntouched.z());
    answers.occupied[i] = cast(origin, direction, end, ignore_unknown, ray.max_range) ? 1 : 0;
    answers.end[i] = {end.x(), end.y(), end.z()};
  });
}

}  // namespace

void cast_ray_loop(const Octree& tree, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers) {
  std::visit(
      [&](const auto& octree) {
        loop(rays, unknown, answers, [&](auto&... ray) { return detail::own_castray(*octree, ray...); });
      },
      tree);
}

void cast_ray_loop(const OctreeRayCaster& caster, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers) {
  loop(rays, unknown, answers, [&](auto&... ray) { return caster.castRay(ray...); });
}

void cast_ray_loop(const RayCaster& caster, std::span<const Ray> rays, UnknownPolicy unknown,
                   CastRayAnswers& answers) {
  in_blocks(rays.size(), [&](std::size_t i) {
    const Hit hit = caster.cast(rays[i], unknown);
    answers.occupied[i] = hit.occupied() ? 1 : 0;
    answers.end[i] = hit.stop == RayStop::kInvalid ? CastRayAnswers::kUntouched : hit.end;
  });
}

std::size_t memory_bytes(const Octree& tree) {
  return std::visit([](const auto& octree) { return static_cast<std::size_t>(octree->memoryUsage()); }, tree);
}

}  // namespace frontlux::bench
