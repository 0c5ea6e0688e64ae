#include "assignment/visibility_flood.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace frontlux::planner::detail {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 26;
constexpr int kMaxHeight = 63;  // [voxels]
constexpr double kRounding = 1e-6;

// All bits from those of `seeds` upwards until one is missing in `open`. Adding carries from a seed to the
// end of its run of ones.
std::uint64_t fill(std::uint64_t seeds, std::uint64_t open) {
  seeds &= open;
  return (((open + seeds) ^ open) | seeds) & open;
}

double squared(double a) { return a * a; }

}  // namespace

std::optional<VisibilityFlood> VisibilityFlood::make(const VoxelGrid& grid,
                                                     std::span<const VoxelKey> corridor,
                                                     const ViewRegion& region, const KeyBox& targets) {
  if (region.greatest_height() > kMaxHeight) return std::nullopt;
  const KeyBox cells = bounds_of(corridor), box = hull(cells, targets);
  if (2 * BitColumns::bytes(box) > kMaxBytes) return std::nullopt;
  std::optional<VisibilityFlood> flood = VisibilityFlood(box, cells, region);
  for (Columns* columns : {&flood->up_, &flood->down_}) {
    columns->walls.add_occupied(grid);
    for (const VoxelKey& key : corridor) columns->cells.add(key);
  }
  return flood;
}

// A ray to an offset in the region rises no more than the region's slope, and crosses what it touches.
VisibilityFlood::VisibilityFlood(const KeyBox& box, const KeyBox& corridor, const ViewRegion& region)
    : up_{BitColumns(box), BitColumns(box)},
      down_{BitColumns(box, true), BitColumns(box, true)},
      corridor_(corridor),
      reach_(region.reach()) {
  constexpr double kWidth = std::numbers::pi / 2 / kSectors;
  for (int x = 0; x <= reach_; ++x)
    for (int y = 0; y <= reach_; ++y) {
      const double range = squared(std::max(x - 0.5, 0.0)) + squared(std::max(y - 0.5, 0.0));
      const double rise = 0.5 + region.slope() * std::hypot(x + 0.5, y + 0.5) + kRounding;
      const std::uint64_t crossed =
          range <= region.squared_range()
              ? BitColumns::bits_to(static_cast<int>(std::min(rise, 1.0 * region.greatest_height())))
              : 0;
      std::uint64_t cells = BitColumns::bits_to(region.height(x, y));
      if (x == 0 && y == 0) cells &= ~std::uint64_t{1};  // the target itself
      const double azimuth = std::atan2(y, x), low = std::atan2(y - 0.5, x + 0.5) - kRounding,
                   high = std::atan2(y + 0.5, x - 0.5) + kRounding;
      for (std::size_t sector = 0; sector < kSectors; ++sector) {
        const double from = kWidth * static_cast<double>(sector), to = from + kWidth;
        const bool in_sector = azimuth >= from && (azimuth < to || sector + 1 == kSectors);
        limits_[sector].push_back({low <= to && high >= from ? crossed : 0, in_sector ? cells : 0});
      }
    }
}

void VisibilityFlood::cells(const VoxelKey& target, Row& row, std::vector<VoxelKey>& cells) const {
  for (const int x : {1, -1})
    for (const int y : {1, -1})
      for (const int z : {1, -1})
        for (std::size_t sector = 0; sector < kSectors; ++sector)
          this->cells(target, {x, y, z}, sector, row, cells);
}

// Column by column, away from the target; heights come from the column before along x, and along y.
void VisibilityFlood::cells(const VoxelKey& target, const std::array<int, 3>& side, std::size_t sector,
                            Row& row, std::vector<VoxelKey>& cells) const {
  // Distances to the last cell; beyond it there is nothing. Offsets of zero belong to the sides that ascend.
  const std::array<int, 3> t = {target.x, target.y, target.z},
                           low = {corridor_.min.x, corridor_.min.y, corridor_.min.z},
                           high = {corridor_.max.x, corridor_.max.y, corridor_.max.z};
  std::array<int, 3> size{};
  for (std::size_t a = 0; a < 3; ++a) {
    size[a] = std::min(reach_, side[a] > 0 ? high[a] - t[a] : t[a] - low[a]);
    if (size[a] < (side[a] > 0 ? 0 : 1)) return;
  }
  const Columns& columns = side[2] > 0 ? up_ : down_;
  const std::uint64_t heights = BitColumns::bits_to(size[2]),
                      wanted = side[2] > 0 ? heights : heights & ~std::uint64_t{1};
  const std::ptrdiff_t step_x = side[0] * columns.walls.along_x(), step_y = side[1] * columns.walls.along_y();
  const int shift = columns.walls.shift(target);
  row.assign(static_cast<std::size_t>(size[1]) + 1, 0);
  row[0] = 1;
  int first = 0, last = 0;  // columns of the row that are reached
  std::uint64_t start = 1;  // a target may be occupied itself
  const std::uint64_t* const walls = columns.walls.at(target);
  const std::uint64_t* const corridor_cells = columns.cells.at(target);
  for (int x = 0; x <= size[0] && first <= last; ++x) {
    const Limit* limits =
        &limits_[sector][static_cast<std::size_t>(x) * static_cast<std::size_t>(reach_ + 1)];
    int first_here = size[1] + 1, last_here = -1;
    std::uint64_t reached = 0;
    for (int y = first; y <= size[1]; ++y) {
      std::uint64_t& here = row[static_cast<std::size_t>(y)];
      const std::uint64_t seeds = here | reached;
      reached = 0;
      here = 0;
      if (seeds == 0) {
        if (y > last) break;
        continue;
      }
      const std::ptrdiff_t column = x * step_x + y * step_y;
      reached = fill(seeds, (~BitColumns::read(walls + column, shift) | start) & limits[y].crossed & heights);
      start = 0;
      here = reached;
      if (reached != 0) {
        first_here = std::min(first_here, y);
        last_here = y;
      }
      if ((x == 0 && side[0] < 0) || (y == 0 && side[1] < 0)) continue;
      // A cell may be occupied itself; what lies before it may not.
      std::uint64_t found = (seeds | reached << 1) & limits[y].cells & wanted;
      if (found != 0) found &= BitColumns::read(corridor_cells + column, shift);
      for (; found != 0; found &= found - 1)
        cells.push_back(
            make_key(t[0] + side[0] * x, t[1] + side[1] * y, t[2] + side[2] * std::countr_zero(found)));
    }
    first = first_here;
    last = last_here;
  }
}

}  // namespace frontlux::planner::detail
