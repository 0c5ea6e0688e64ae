#include "view/changed_surroundings.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace frontlux::detail {
namespace {

// The smallest box around each run of ascending codes within a cube of 8 voxels a side.
template <class Add>
void for_each_cube(std::span<const std::uint64_t> codes, const Add& add) {
  for (std::size_t begin = 0, end = 0; begin < codes.size(); begin = end) {
    CellBox box = CellBox::of(cell_of_code(codes[begin]));
    for (end = begin + 1; end < codes.size() && codes[end] >> kBlockCode == codes[begin] >> kBlockCode; ++end)
      box.add(CellBox::of(cell_of_code(codes[end])));
    add(box, codes[begin]);
  }
}

}  // namespace

ChangedSurroundings::ChangedSurroundings(std::span<const VoxelKey> changed, const TargetIndex& targets_before,
                                         const TargetIndex& targets_now,
                                         ViewQualityOptions::Sampling sampling) {
  add_voxels(changed);
  add_targets(targets_before, targets_now, sampling == ViewQualityOptions::Sampling::kBuckets);
}

void ChangedSurroundings::add_voxels(std::span<const VoxelKey> changed) {
  // The way to a target passes through voxels whose centres are up to half a voxel off the straight line,
  // along each axis; castRay's own rounding may lead it a little further.
  constexpr int kOffTheLine = 1;
  std::vector<std::uint64_t> cubes;  // of 8 voxels a side
  for (const VoxelKey& key : changed)
    if (const std::uint64_t cube = cell_code(key) >> kBlockCode; cubes.empty() || cubes.back() != cube)
      cubes.push_back(cube);
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  for (const std::uint64_t cube : cubes)
    boxes_.push_back(CellBox::of(cell_of_code(cube << kBlockCode), 3).grown(kOffTheLine));
}

void ChangedSurroundings::add_targets(const TargetIndex& before, const TargetIndex& now, bool whole_cubes) {
  std::vector<std::uint64_t> differing;
  std::set_symmetric_difference(before.codes().begin(), before.codes().end(), now.codes().begin(),
                                now.codes().end(), std::back_inserter(differing));
  for_each_cube(differing, [&](const CellBox& box, std::uint64_t code) {
    // A bucket's size counts for all viewpoints that draw from it.
    boxes_.push_back(whole_cubes ? CellBox::of(cell_of_code(code >> kBlockCode << kBlockCode), 3) : box);
  });
}

}  // namespace frontlux::detail
