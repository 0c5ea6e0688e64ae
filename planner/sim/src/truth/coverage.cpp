#include <frontlux/key_box.hpp>
#include <frontlux/sim/coverage.hpp>

#include <stdexcept>
#include <string>

namespace frontlux::sim {

Coverage measure(const GroundTruth& truth, const VoxelGrid& known) {
  if (known.resolution() != truth.lattice().resolution())
    throw std::invalid_argument("coverage: the map has voxels of " + std::to_string(known.resolution()) +
                                " m, the ground truth of " + std::to_string(truth.lattice().resolution()) +
                                " m");
  Coverage coverage{0, truth.observable_voxels(), 0, truth.bounding_voxels()};
  known.for_each_block([&](const Block& block, const Brick* brick, Occupancy) {
    const auto box = intersection(cube(block.corner, 1 << block.log2_edge), truth.bounds());
    if (!box) return;
    for_each_key(*box, [&](const VoxelKey& key) {
      if (brick != nullptr && brick->at(key) == Occupancy::kUnknown) return;
      ++coverage.known_bounding;
      if (truth.contains(key)) ++coverage.known_observable;
    });
  });
  return coverage;
}

}  // namespace frontlux::sim
