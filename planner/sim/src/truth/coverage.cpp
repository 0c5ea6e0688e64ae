#include <frontlux/sim/coverage.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

void check_resolution(const GroundTruth& truth, const VoxelGrid& known) {
  if (known.resolution() != truth.lattice().resolution())
    throw std::invalid_argument("coverage: the map has voxels of " + std::to_string(known.resolution()) +
                                " m, the ground truth of " + std::to_string(truth.lattice().resolution()) +
                                " m");
}

// Calls `visit` for the voxels of a block within the bounds.
template <class Visit>
void for_each_voxel(const Block& block, const KeyBox& bounds, const Visit& visit) {
  const unsigned edge = 1U << block.log2_edge;
  const auto last = [&](std::uint16_t corner, std::uint16_t limit) {
    return std::min<unsigned>(corner + edge - 1, limit);
  };
  for (unsigned z = std::max(block.corner.z, bounds.min.z); z <= last(block.corner.z, bounds.max.z); ++z)
    for (unsigned y = std::max(block.corner.y, bounds.min.y); y <= last(block.corner.y, bounds.max.y); ++y)
      for (unsigned x = std::max(block.corner.x, bounds.min.x); x <= last(block.corner.x, bounds.max.x); ++x)
        visit(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                       static_cast<std::uint16_t>(z)});
}

}  // namespace

Coverage measure(const GroundTruth& truth, const VoxelGrid& known) {
  check_resolution(truth, known);
  Coverage coverage{0, truth.observable_voxels(), 0, truth.bounding_voxels()};
  known.for_each_block([&](const Block& block, const Brick* brick, Occupancy) {
    for_each_voxel(block, truth.bounds(), [&](const VoxelKey& key) {
      if (brick != nullptr && brick->at(key) == Occupancy::kUnknown) return;
      ++coverage.known_bounding;
      if (truth.contains(key)) ++coverage.known_observable;
    });
  });
  return coverage;
}

}  // namespace frontlux::sim
