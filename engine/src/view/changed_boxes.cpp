#include "view/changed_boxes.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace frontlux::detail {
namespace {

// Calls visit(cube, hull) for each cube of 8 voxels a side that holds some of the codes, which are sorted,
// with the box around those.
template <class Visit>
void for_each_cube(std::span<const std::uint64_t> codes, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < codes.size(); begin = end) {
    const KeyBox cube = cube_of_code(codes[begin]);
    KeyBox box{cube.max, cube.min};
    for (end = begin; end < codes.size() && codes[end] >> kBlockCode == codes[begin] >> kBlockCode; ++end) {
      const VoxelKey key = cell_of_code(codes[end]);
      box = hull(box, {key, key});
    }
    visit(cube, box);
  }
}

}  // namespace

std::vector<KeyBox> changed_boxes(std::span<const VoxelKey> changed, const TargetIndex& before,
                                  const TargetIndex& now, bool whole_cubes) {
  // A ray to a target passes through voxels whose centres are up to half a voxel off the straight line along
  // each axis, and a little more by castRay's own rounding.
  constexpr int kOffTheLine = 1;
  std::vector<KeyBox> boxes;
  std::vector<std::uint64_t> codes(changed.size());
  std::transform(changed.begin(), changed.end(), codes.begin(), cell_code);
  std::sort(codes.begin(), codes.end());
  for_each_cube(codes, [&](const KeyBox&, const KeyBox& box) { boxes.push_back(grown(box, kOffTheLine)); });

  codes.clear();
  std::set_symmetric_difference(before.codes().begin(), before.codes().end(), now.codes().begin(),
                                now.codes().end(), std::back_inserter(codes));
  for_each_cube(codes,
                [&](const KeyBox& cube, const KeyBox& box) { boxes.push_back(whole_cubes ? cube : box); });
  return boxes;
}

}  // namespace frontlux::detail
