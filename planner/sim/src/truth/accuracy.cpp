#include <frontlux/key_box.hpp>
#include <frontlux/sim/accuracy.hpp>

#include <array>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

// A wall on a face belongs to neither voxel, and is mapped as the one behind it.
bool is_open_all_around(const GroundTruth& truth, const VoxelKey& key) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<int, 3> step{};
    step[axis] = -1;
    const auto below = offset_key(key, step[0], step[1], step[2]);
    if (!truth.open(key, axis) || !below || !truth.bounds().contains(*below) || !truth.open(*below, axis))
      return false;
  }
  return true;
}

}  // namespace

Accuracy measure_accuracy(const GroundTruth& truth, const VoxelGrid& map) {
  if (map.resolution() != truth.lattice().resolution())
    throw std::invalid_argument("accuracy: the map has voxels of " + std::to_string(map.resolution()) +
                                " m, the ground truth of " + std::to_string(truth.lattice().resolution()) +
                                " m");
  Accuracy accuracy;
  accuracy.surface = truth.surface_voxels();
  map.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    const auto box = intersection(cube(block.corner, 1 << block.log2_edge), truth.bounds());
    if (!box) return;
    for_each_key(*box, [&](const VoxelKey& key) {
      const Occupancy is = brick != nullptr ? brick->at(key) : state;
      if (is == Occupancy::kFree) {
        ++accuracy.free;
        accuracy.false_free += truth.holds_surface(key) ? 1 : 0;
      } else if (is == Occupancy::kOccupied) {
        ++accuracy.occupied;
        const Truth true_state = truth.at(key);
        accuracy.surface_found += true_state == Truth::kSurface ? 1 : 0;
        accuracy.false_occupied += true_state == Truth::kFree && is_open_all_around(truth, key) ? 1 : 0;
      }
    });
  });
  return accuracy;
}

}  // namespace frontlux::sim
