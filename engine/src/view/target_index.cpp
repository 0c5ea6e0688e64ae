#include "view/target_index.hpp"

#include "parallel/parallel_sort.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace frontlux::detail {

TargetIndex::TargetIndex(std::span<const VoxelKey> targets) {
  if (targets.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("view quality: " + std::to_string(targets.size()) +
                                " targets, but at most 2^32 - 1 can be numbered");
  codes_.resize(targets.size());
  std::transform(targets.begin(), targets.end(), codes_.begin(), cell_code);
  parallel_sort(codes_);
  codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
  keys_.resize(codes_.size());
  std::transform(codes_.begin(), codes_.end(), keys_.begin(), cell_of_code);

  for (std::size_t i = 0; i < codes_.size(); ++i) {
    const std::uint64_t code = codes_[i];
    if (i == 0 || code >> kBlockCode != codes_[i - 1] >> kBlockCode) {
      if (i == 0 || code >> kRegionCode != codes_[i - 1] >> kRegionCode) {
        const auto begin = static_cast<std::uint32_t>(cubes_.size());
        regions_.push_back({cube(cell_of_code(code >> kRegionCode << kRegionCode), 64), begin, begin});
      }
      const auto begin = static_cast<std::uint32_t>(i);
      cubes_.push_back({cube_of_code(code), begin, begin});
      ++regions_.back().end;
    }
    ++cubes_.back().end;
  }
}

void TargetIndex::list_cubes(const ViewRegion& view, const KeyBox& from,
                             std::vector<std::uint32_t>& cubes) const {
  cubes.clear();
  for (const Cube& region : regions_) {
    if (!view.may_contain_point(from, region.box)) continue;
    for (std::uint32_t c = region.begin; c < region.end; ++c)
      if (view.may_contain_point(from, cubes_[c].box)) cubes.push_back(c);
  }
}

}  // namespace frontlux::detail
