#include <frontlux/ray_caster.hpp>

#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

// Whether there is anything to answer.
bool any(std::size_t inputs, std::size_t results, const char* what) {
  if (inputs != results)
    throw std::invalid_argument(std::to_string(inputs) + " " + what + " but room for " +
                                std::to_string(results) + " results: the two spans must be of one size");
  return inputs != 0;
}

}  // namespace

void RayCaster::cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const {
  if (any(rays.size(), hits.size(), "rays")) do_cast(rays, hits, unknown);
}

Hit RayCaster::cast(const Ray& ray, UnknownPolicy unknown) const {
  Hit hit;
  do_cast({&ray, 1}, {&hit, 1}, unknown);
  return hit;
}

void RayCaster::visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                        UnknownPolicy unknown) const {
  if (any(segments.size(), visible.size(), "segments")) do_visible(segments, visible, unknown);
}

void RayCaster::visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                        UnknownPolicy unknown) const {
  if (any(segments.size(), visible.size(), "segments")) do_visible(segments, visible, unknown);
}

void RayCaster::count(std::span<const Ray> rays, std::span<PathCount> counts, UnknownPolicy unknown) const {
  if (any(rays.size(), counts.size(), "rays")) do_count(rays, counts, unknown);
}

void RayCaster::count(std::span<const Segment> segments, std::span<PathCount> counts,
                      UnknownPolicy unknown) const {
  if (any(segments.size(), counts.size(), "segments")) do_count(segments, counts, unknown);
}

void RayCaster::count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                      UnknownPolicy unknown) const {
  if (any(segments.size(), counts.size(), "segments")) do_count(segments, counts, unknown);
}

void RayCaster::update(const VoxelGrid& grid) {
  if (grid.resolution() != lattice_.resolution())
    throw std::invalid_argument("a caster of resolution " + std::to_string(lattice_.resolution()) +
                                " m cannot be updated to a grid of " + std::to_string(grid.resolution()) +
                                " m");
  do_update(grid);
}

}  // namespace frontlux
