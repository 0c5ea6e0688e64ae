#include "view/changed_surroundings.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>

namespace frontlux::detail {
namespace {

void check(const Block& block) {
  const auto text = [](int number) { return std::to_string(number); };
  const VoxelKey& c = block.corner;
  if (block.log2_edge < 0 || block.log2_edge > 16 || ((c.x | c.y | c.z) & ((1 << block.log2_edge) - 1)) != 0)
    throw std::invalid_argument("view quality: changed block at (" + text(c.x) + ", " + text(c.y) + ", " +
                                text(c.z) + ") with log2_edge " + text(block.log2_edge) +
                                " has to be aligned to its edge and within the key range");
}

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

ChangedSurroundings::ChangedSurroundings(std::span<const Block> changed, const TargetIndex& targets_before,
                                         const TargetIndex& targets_now,
                                         ViewQualityOptions::Sampling sampling) {
  add_voxels(changed);
  add_targets(targets_before, targets_now, sampling == ViewQualityOptions::Sampling::kBuckets);
}

void ChangedSurroundings::add_voxels(std::span<const Block> changed) {
  // The way to a target passes through voxels whose centres are up to half a voxel off the straight line,
  // along each axis; castRay's own rounding may lead it a little further.
  constexpr int kOffTheLine = 1;
  std::vector<std::uint64_t> singles;
  for (const Block& block : changed) {
    check(block);
    if (block.log2_edge == 0)
      singles.push_back(cell_code(block.corner));
    else
      boxes_.push_back(CellBox::of(block.corner, block.log2_edge).grown(kOffTheLine));
  }
  std::sort(singles.begin(), singles.end());
  for_each_cube(singles,
                [&](const CellBox& box, std::uint64_t) { boxes_.push_back(box.grown(kOffTheLine)); });
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
