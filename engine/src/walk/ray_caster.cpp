#include <frontlux/file.hpp>
#include <frontlux/floating_point_mode.hpp>
#include <frontlux/ray_caster.hpp>

#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

void check(UnknownPolicy unknown) {
  if (unknown != UnknownPolicy::kPass && unknown != UnknownPolicy::kBlock)
    throw std::invalid_argument("there is no policy for unknown voxels of number " +
                                std::to_string(static_cast<int>(unknown)));
}

// Calls `answer`, if there is anything to answer.
template <class Answer>
void answer_all(std::size_t inputs, std::size_t results, const char* what, UnknownPolicy unknown,
                const Answer& answer) {
  if (inputs != results)
    throw std::invalid_argument(std::to_string(inputs) + " " + what + " but room for " +
                                std::to_string(results) + " results: the two spans must be of one size");
  check(unknown);
  if (inputs == 0) return;
  const FloatingPointMode mode(FloatingPointMode::kToNearest);
  answer();
}

}  // namespace

void RayCaster::cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const {
  answer_all(rays.size(), hits.size(), "rays", unknown, [&] { do_cast(rays, hits, unknown); });
}

Hit RayCaster::cast(const Ray& ray, UnknownPolicy unknown) const {
  Hit hit;
  cast({&ray, 1}, {&hit, 1}, unknown);
  return hit;
}

RayStop RayCaster::cast(const Ray& ray, UnknownPolicy unknown, Eigen::Vector3f& end) const {
  check(unknown);
  const FloatingPointMode mode(FloatingPointMode::kToNearest);
  if (const auto stop = do_cast_end(ray, unknown, end)) return *stop;
  Hit hit;
  do_cast({&ray, 1}, {&hit, 1}, unknown);
  if (hit.stop != RayStop::kInvalid) end = hit.end;
  return hit.stop;
}

void RayCaster::visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                        UnknownPolicy unknown) const {
  answer_all(segments.size(), visible.size(), "segments", unknown,
             [&] { do_visible(segments, visible, unknown); });
}

void RayCaster::visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                        UnknownPolicy unknown) const {
  answer_all(segments.size(), visible.size(), "segments", unknown,
             [&] { do_visible(segments, visible, unknown); });
}

void RayCaster::count(std::span<const Ray> rays, std::span<PathCount> counts, UnknownPolicy unknown) const {
  answer_all(rays.size(), counts.size(), "rays", unknown, [&] { do_count(rays, counts, unknown); });
}

void RayCaster::count(std::span<const Segment> segments, std::span<PathCount> counts,
                      UnknownPolicy unknown) const {
  answer_all(segments.size(), counts.size(), "segments", unknown,
             [&] { do_count(segments, counts, unknown); });
}

void RayCaster::count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                      UnknownPolicy unknown) const {
  answer_all(segments.size(), counts.size(), "segments", unknown,
             [&] { do_count(segments, counts, unknown); });
}

void RayCaster::update(const VoxelGrid& grid) {
  if (grid.resolution() != lattice_.resolution())
    throw std::invalid_argument("a caster of resolution " + decimals_of(lattice_.resolution()) +
                                " m cannot be updated to a grid of " + decimals_of(grid.resolution()) + " m");
  const FloatingPointMode mode(FloatingPointMode::kToNearest);
  do_update(grid);
}

}  // namespace frontlux
