#include "view/changed_boxes.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace frontlux::detail {

std::vector<KeyBox> changed_boxes(std::span<const VoxelKey> changed, const TargetIndex& before,
                                  const TargetIndex& now, bool whole_cubes) {
  // A ray to a target passes through voxels whose centres are up to half a voxel off the straight line along
  // each axis, and a little more by castRay's own rounding.
  constexpr int kOffTheLine = 1;
  std::vector<std::uint64_t> codes;  // of cubes of 8 voxels a side
  for (const VoxelKey& key : changed)
    if (const std::uint64_t code = cell_code(key) >> kBlockCode; codes.empty() || codes.back() != code)
      codes.push_back(code);
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  std::vector<KeyBox> boxes;
  for (const std::uint64_t code : codes)
    boxes.push_back(grown(cube_of_code(code << kBlockCode), kOffTheLine));

  codes.clear();
  std::set_symmetric_difference(before.codes().begin(), before.codes().end(), now.codes().begin(),
                                now.codes().end(), std::back_inserter(codes));
  for (std::size_t begin = 0, end = 0; begin < codes.size(); begin = end) {
    const KeyBox cube = cube_of_code(codes[begin]);
    KeyBox box{cube.max, cube.min};  // around the targets of this cube
    for (end = begin; end < codes.size() && codes[end] >> kBlockCode == codes[begin] >> kBlockCode; ++end) {
      const VoxelKey key = cell_of_code(codes[end]);
      box = hull(box, {key, key});
    }
    boxes.push_back(whole_cubes ? cube : box);
  }
  return boxes;
}

}  // namespace frontlux::detail
