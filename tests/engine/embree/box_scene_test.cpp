// Embree's scene of boxes, compared with exact slabs over all boxes.

#include "embree/box_scene.hpp"

#include "engine/embree/slab_oracle.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"

#include <frontlux/octomap.hpp>

#include <gtest/gtest.h>

namespace frontlux::test {
namespace {

using detail::BoxScene;
using detail::Probe;
using detail::Sight;

std::optional<long double> entry_into(const Probe& probe, const KeyBox& box, const VoxelKey& base,
                                      long double grown_by) {
  const int min[] = {box.min.x - base.x, box.min.y - base.y, box.min.z - base.z};
  const int max[] = {box.max.x - base.x, box.max.y - base.y, box.max.z - base.z};
  float center[3], half[3];
  for (std::size_t i = 0; i < 3; ++i) {
    center[i] = 0.5F * static_cast<float>(min[i] + max[i] + 1);
    half[i] = 0.5F * static_cast<float>(max[i] + 1 - min[i]);
  }
  return entry_time(center, half, grown_by, probe.origin, probe.direction, probe.t_near, probe.t_far);
}

std::vector<Probe> random_probes(const BoxScene& scene, std::size_t count, Random& random) {
  std::vector<Probe> probes(count);
  for (Probe& probe : probes) {
    probe = {{}, 0.0F, {}, std::numeric_limits<float>::infinity()};
    const bool along_faces = random.one_in(3);
    for (int i = 0; i < 3; ++i) {
      const double at = random.uniform(scene.bounds().min()[i] - 1.0, scene.bounds().max()[i] + 1.0);
      probe.origin[i] = static_cast<float>(along_faces ? std::round(at) : at);
      probe.direction[i] = static_cast<float>(along_faces ? random.below(3) - 1 : random.uniform(-1.0, 1.0));
    }
    if (probe.direction[0] == 0.0F && probe.direction[1] == 0.0F) probe.direction[2] = 1.0F;
    if (random.one_in(3)) probe.t_far = static_cast<float>(random.uniform(0.0, 60.0));
  }
  return probes;
}

TEST(BoxScene, MeetsTheBoxesThatExactSlabsMeet) {
  const auto device = detail::make_box_scene_device();
  BoxScene scene(device);
  std::array<int, 3> seen{};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto blockers =
        detail::make_blockers(make_voxel_grid(*make_noise_tree(seed, 0.3, 16)), UnknownPolicy::kPass);
    scene.update(blockers);  // the second and the third time it already holds other boxes
    std::vector<KeyBox> boxes;
    for (const auto& group : blockers.groups)
      for (std::size_t i = 0; i < group->boxes.size(); ++i) boxes.push_back(group->box(i));
    ASSERT_GT(boxes.size(), 100U);
    Random random(seed);
    for (int round = 0; round < 20; ++round) {
      const auto probes =
          random_probes(scene, 1 + static_cast<std::size_t>(random.below(BoxScene::kMaxBatch)), random);
      std::vector<Sight> sights(probes.size());
      std::vector<std::optional<KeyBox>> first(probes.size());
      scene.occluded(probes, sights);
      scene.first(probes, first);
      const auto tolerance = static_cast<long double>(scene.tolerance());
      for (std::size_t p = 0; p < probes.size(); ++p) {
        const auto enters = [&](const KeyBox& box, long double grown_by) {
          return entry_into(probes[p], box, scene.origin(), grown_by);
        };
        std::optional<long double> earliest;
        bool surely = false;
        for (const KeyBox& box : boxes) {
          surely = surely || enters(box, -2.0L * tolerance);
          if (const auto t = enters(box, 0.0L); t && (!earliest || *t < *earliest)) earliest = t;
        }
        ASSERT_TRUE(!surely || sights[p] == Sight::kBlocked);
        ASSERT_TRUE(sights[p] != Sight::kBlocked || earliest);
        ASSERT_TRUE(sights[p] != Sight::kClear || !earliest);
        ASSERT_TRUE(first[p] || !earliest || *earliest >= probes[p].t_far);
        if (first[p] && earliest) {
          const auto claimed = enters(*first[p], 2.0L * tolerance);
          ASSERT_TRUE(claimed);
          ASSERT_LE(*claimed, *earliest);
        }
        ++seen[static_cast<std::size_t>(sights[p])];
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 50);
}

}  // namespace
}  // namespace frontlux::test
