// What is left out must be hidden: against the walk along every ray. And much is left out behind a wall.

#include "view/hidden_changes.hpp"

#include "engine/view/count_view.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"
#include "view/azimuth_bins.hpp"
#include "walk/walk.hpp"

#include <frontlux/view_region.hpp>

namespace frontlux::test {
namespace {

using detail::Onlooker;
using detail::SectorSet;

constexpr double kResolution = 0.25;
constexpr KeyBox kRoom{{32700, 32740, 32768}, {32739, 32779, 32787}};

struct Change {
  VoxelGrid before{kResolution}, now{kResolution};
  std::vector<VoxelKey> targets_before, targets_now;
};

// Noise, with changes in a corner of the room and some targets that come or go.
Change random_change(Random& random) {
  Change change;
  const int blocked_one_in = 2 + random.below(30);
  for_each_key(kRoom, [&](const VoxelKey& k) {
    const bool wall = k.x == 32720 && random.below(60) != 0;
    const auto state = wall || random.one_in(blocked_one_in) ? Occupancy::kOccupied : Occupancy::kFree;
    change.before.set(k, state);
    change.now.set(k, state);
    if (random.one_in(50)) change.targets_now.push_back(k);
  });
  change.targets_before = change.targets_now;
  const VoxelKey middle = make_key(32730, 32750 + random.below(20), 32770 + random.below(15));
  for (int i = random.below(30); i > 0; --i) {
    const VoxelKey k = *offset_key(middle, random.below(7) - 3, random.below(7) - 3, random.below(3) - 1);
    change.now.set(k, random.state());
    if (random.one_in(3)) change.targets_now.push_back(k);
  }
  return change;
}

TEST(HiddenChanges, AreNeverInSight) {
  Random random(1);
  std::size_t stay = 0, left_out = 0;
  for (int round = 0; round < 60; ++round) {
    const Change change = random_change(random);
    using Shape = FieldOfView::Shape;
    const FieldOfView field{std::array{Shape::kPyramid, Shape::kSpinning, Shape::kCone}[random.bits() % 3],
                            random.uniform(5, 170) * kDegree, random.uniform(1, 175) * kDegree,
                            random.uniform(2, 16) * kResolution};
    const ViewRegion view(field, kResolution);
    const int bins = std::array{1, 7, 8, 36, 100}[static_cast<std::size_t>(round % 5)];
    std::vector<Onlooker> onlookers;
    for_each_key(kRoom, [&](const VoxelKey& k) {
      if (random.one_in(4)) onlookers.push_back({detail::cell_code(k), SectorSet::all()});
    });
    const detail::TargetIndex before(change.targets_before), now(change.targets_now);
    detail::leave_out_hidden(change.now, changed_keys(change.before, change.now), before, now, view, bins,
                             onlookers);
    const auto bins_of = [&](const VoxelGrid& grid, const detail::TargetIndex& targets,
                             const VoxelKey& from) {
      return count_view(from, {targets.keys().begin(), targets.keys().end()}, field, kResolution, bins,
                        [&](const VoxelKey& to) {
                          return detail::walk_visible(grid, KeySegment{from, to}, UnknownPolicy::kBlock);
                        })
          .bins;
    };
    for (std::size_t i = 0; i < onlookers.size(); i += 20) {
      const VoxelKey from = detail::cell_of_code(onlookers[i].code);
      const auto was = bins_of(change.before, before, from), is = bins_of(change.now, now, from);
      for (int bin = 0; bin < bins; ++bin) {
        const bool stays = onlookers[i].sectors.contains(SectorSet::of(bin, bins));
        (stays ? stay : left_out) += 1;
        ASSERT_TRUE(stays || was[static_cast<std::size_t>(bin)] == is[static_cast<std::size_t>(bin)])
            << "round " << round << ", bin " << bin << " of " << bins;
      }
    }
  }
  EXPECT_GT(stay, 100U);
  EXPECT_GT(left_out, 1000U);
}

TEST(HiddenChanges, AreBehindAWall) {
  VoxelGrid grid(kResolution);
  for_each_key(
      kRoom, [&](const VoxelKey& k) { grid.set(k, k.x == 32720 ? Occupancy::kOccupied : Occupancy::kFree); });
  const VoxelKey changed{32730, 32760, 32775};
  const ViewRegion view({FieldOfView::Shape::kSpinning, 0, 60 * kDegree, 30 * kResolution}, kResolution);
  std::vector<Onlooker> onlookers(10'000, {detail::cell_code({32710, 32760, 32775}), SectorSet::all()});
  onlookers.back().code = detail::cell_code({32725, 32760, 32775});
  const detail::TargetIndex none({});
  detail::leave_out_hidden(grid, std::span(&changed, 1), none, none, view, 36, onlookers);
  EXPECT_FALSE(onlookers.front().sectors.contains(SectorSet::of(0, 36)));
  EXPECT_TRUE(onlookers.back().sectors.contains(SectorSet::of(0, 36)));
  EXPECT_FALSE(onlookers.back().sectors.contains(SectorSet::of(17, 36)));
}

}  // namespace
}  // namespace frontlux::test
