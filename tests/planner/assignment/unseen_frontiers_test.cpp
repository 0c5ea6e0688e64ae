// The frontiers known to be unseen, against testing all frontiers again after every change.

#include "assignment/unseen_frontiers.hpp"

#include "support/random.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/view_region.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

namespace frontlux::planner {
namespace {

using detail::UnseenFrontiers;
using test::Random;

constexpr double kDegree = std::numbers::pi / 180, kResolution = 0.3;

VoxelKey random_key(Random& random) {
  const int x = random.below(60), y = random.below(60);
  return make_key(32768 + x, 32768 + y, 32768 + random.below(16));
}

// A map of walls that opens and closes here and there, with a corridor that does so too.
class Changing {
 public:
  explicit Changing(std::uint64_t seed) : random_(seed) {
    for (int x = 0; x < 60; ++x)
      for (int y = 0; y < 60; ++y)
        for (int z = 0; z < 16; ++z)
          if (const bool wall = x % 12 == 0 || y % 12 == 0 || z % 8 == 0; wall && !random_.one_in(60))
            grid.set(make_key(32768 + x, 32768 + y, 32768 + z), Occupancy::kOccupied);
    for (int i = 0; i < 600; ++i) frontiers.push_back(random_key(random_));
    sort(frontiers);
    for (int i = 0; i < 60; ++i) corridor.push_back(random_key(random_));
    sort(corridor);
  }

  // Returns the voxels that may have changed.
  std::vector<VoxelKey> change() {
    std::vector<VoxelKey> changed;
    const VoxelKey around = random_key(random_);
    const auto near = [&](const VoxelKey& key) {
      return std::abs(key.x - around.x) < 6 && std::abs(key.y - around.y) < 6;
    };
    for (int i = 0; i < 40; ++i) {
      const VoxelKey key = random_key(random_);
      const auto state = static_cast<Occupancy>(random_.below(3));
      if (!near(key)) continue;
      changed.push_back(key);
      grid.set(key, state);
    }
    if (random_.one_in(3)) {
      std::erase_if(corridor, [&](const VoxelKey& key) { return near(key) && random_.one_in(2); });
      if (random_.one_in(2)) corridor.push_back(random_key(random_));
    }
    if (random_.one_in(20)) corridor.clear();
    sort(corridor);
    std::erase_if(frontiers, [&](const VoxelKey&) { return random_.one_in(50); });
    for (int i = 0; i < 10; ++i) frontiers.push_back(random_key(random_));
    sort(frontiers);
    sort(changed);
    return changed;
  }

  VoxelGrid grid{kResolution};
  std::vector<VoxelKey> frontiers, corridor;

 private:
  static void sort(std::vector<VoxelKey>& keys) {
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  }

  Random random_;
};

std::vector<VoxelKey> seen(const std::vector<VoxelKey>& frontiers, const AssignedFrontiers& assigned) {
  std::vector<VoxelKey> keys;
  for (const std::uint32_t i : assigned.frontiers) keys.push_back(frontiers[i]);
  return keys;
}

TEST(UnseenFrontiers, AreThoseThatNoCellSeesAfterAChange) {
  std::uint64_t rays = 0, rays_for_all = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Changing scene(seed);
    const FieldOfView view = seed % 2 == 0
                                 ? FieldOfView{FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 3.0}
                                 : FieldOfView{FieldOfView::Shape::kPyramid, 90 * kDegree, 72 * kDegree, 4.0};
    const ViewRegion region(view, kResolution);
    UnseenFrontiers unseen;
    for (int step = 0; step < 25; ++step) {
      const auto changed = scene.change();
      unseen.update({scene.grid, changed}, scene.corridor, region);
      const auto caster = make_grid_ray_caster(scene.grid);
      const AssignedFrontiers all =
          find_visible_frontiers(*caster, scene.grid, scene.frontiers, {scene.corridor, view});
      const AssignedFrontiers some = find_visible_frontiers(*caster, scene.grid, scene.frontiers,
                                                            {scene.corridor, view, {}, unseen.keys()});
      ASSERT_EQ(some.frontiers, all.frontiers) << "seed " << seed << ", step " << step;
      rays += some.rays;
      rays_for_all += all.rays;
      std::vector<VoxelKey> not_seen;
      const auto found = seen(scene.frontiers, all);
      std::set_difference(scene.frontiers.begin(), scene.frontiers.end(), found.begin(), found.end(),
                          std::back_inserter(not_seen));
      unseen.set(std::move(not_seen));
    }
  }
  EXPECT_LT(rays, rays_for_all * 3 / 4);
}

// Frontiers that were unseen without a corridor may be seen once there is one again, even the same as before.
TEST(UnseenFrontiers, AreForgottenWhenACorridorComesBack) {
  const ViewRegion region({FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 3.0}, kResolution);
  const std::vector<VoxelKey> cell = {{30000, 30000, 30000}};
  const VoxelKey near{30003, 30000, 30000}, far{40000, 30000, 30000};
  const VoxelGrid grid(kResolution);
  UnseenFrontiers unseen;
  unseen.update({grid}, cell, region);
  unseen.forget();
  unseen.set({near, far});
  unseen.update({grid}, cell, region);
  EXPECT_TRUE(std::ranges::equal(unseen.keys(), std::vector{far}));
}

// Over the whole key range there are too many cubes to note changes in.
TEST(UnseenFrontiers, AreForgottenByChangesAllOverTheKeyRange) {
  const ViewRegion region({FieldOfView::Shape::kSpinning, 0.0, 40 * kDegree, 3.0}, kResolution);
  const VoxelKey frontier{30000, 30000, 30000};
  const std::vector<VoxelKey> corner = {{0, 0, 0}}, corners = {{0, 0, 0}, {65535, 65535, 65535}};
  VoxelGrid occupied(kResolution);
  for (const VoxelKey& key : corners) occupied.set(key, Occupancy::kOccupied);
  const VoxelGrid opened(kResolution);
  for (const auto& [changed, left] : {std::pair{corner, 1U}, {corners, 0U}}) {
    UnseenFrontiers unseen;
    unseen.update({occupied}, {}, region);
    unseen.set({frontier});
    unseen.update({opened, changed}, {}, region);
    EXPECT_EQ(unseen.keys().size(), left);
  }
}

}  // namespace
}  // namespace frontlux::planner
