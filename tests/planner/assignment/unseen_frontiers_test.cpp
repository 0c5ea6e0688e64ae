// The frontiers known to be unseen, against testing all frontiers again after every change.

#include "assignment/unseen_frontiers.hpp"

#include "support/random.hpp"
#include "support/views.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/frontier_assignment.hpp>
#include <frontlux/view_region.hpp>

namespace frontlux::planner {
namespace {

using detail::UnseenFrontiers;
using test::Random;
using test::sort;

constexpr double kResolution = 0.3;
const KeyBox kBox{test::key_at(0, 0, 0), test::key_at(59, 59, 15)};

// A map of walls that opens and closes here and there, with a corridor that does so too.
class Changing {
 public:
  explicit Changing(std::uint64_t seed) : random_(seed) {
    for_each_key(kBox, [&](const VoxelKey& k) {
      if (const bool wall = k.x % 12 == 0 || k.y % 12 == 0 || k.z % 8 == 0; wall && !random_.one_in(60))
        grid.set(k, Occupancy::kOccupied);
    });
    for (int i = 0; i < 600; ++i) frontiers.push_back(random_.key_in(kBox));
    sort(frontiers);
    for (int i = 0; i < 60; ++i) corridor.push_back(random_.key_in(kBox));
    sort(corridor);
  }

  // Returns the voxels that may have changed.
  std::vector<VoxelKey> change() {
    std::vector<VoxelKey> changed;
    const VoxelKey around = random_.key_in(kBox);
    const auto near = [&](const VoxelKey& key) {
      return std::abs(key.x - around.x) < 6 && std::abs(key.y - around.y) < 6;
    };
    for (int i = 0; i < 40; ++i) {
      const VoxelKey key = random_.key_in(kBox);
      const Occupancy state = random_.state();
      if (!near(key)) continue;
      changed.push_back(key);
      grid.set(key, state);
    }
    if (random_.one_in(3)) {
      std::erase_if(corridor, [&](const VoxelKey& key) { return near(key) && random_.one_in(2); });
      if (random_.one_in(2)) corridor.push_back(random_.key_in(kBox));
    }
    if (random_.one_in(20)) corridor.clear();
    sort(corridor);
    std::erase_if(frontiers, [&](const VoxelKey&) { return random_.one_in(50); });
    for (int i = 0; i < 10; ++i) frontiers.push_back(random_.key_in(kBox));
    sort(frontiers);
    sort(changed);
    return changed;
  }

  VoxelGrid grid{kResolution};
  std::vector<VoxelKey> frontiers, corridor;

 private:
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
    const FieldOfView view = seed % 2 == 0 ? test::lidar(3.0) : test::camera(4.0);
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
      std::ranges::set_difference(scene.frontiers, found, std::back_inserter(not_seen));
      unseen.set(std::move(not_seen));
    }
  }
  EXPECT_LT(rays, rays_for_all * 3 / 4);
}

// Frontiers that were unseen without a corridor may be seen once there is one again, even the same as before.
TEST(UnseenFrontiers, AreForgottenWhenACorridorComesBack) {
  const ViewRegion region(test::lidar(3.0), kResolution);
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
  const ViewRegion region(test::lidar(3.0), kResolution);
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
