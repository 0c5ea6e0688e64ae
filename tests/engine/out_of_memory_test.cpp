// Allocations that fail, one here and one there: what throws may be called again, and then nothing is wrong.
// In a program of its own, whose memory this is. Those of Embree and TBB do not fail: Embree's build of a
// scene that cannot have its memory may end the process within TBB.

#include "support/casters.hpp"
#include "support/random.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/live_map.hpp>
#include <frontlux/view_quality.hpp>

#include <octomap/OcTree.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <dlfcn.h>
#include <new>
#include <string_view>

namespace {

std::atomic<int> until_failure = -1;  // allocations; negative: none fails

bool is_below_us(const void* caller) {
  Dl_info info;
  if (dladdr(caller, &info) == 0 || info.dli_fname == nullptr) return false;
  const std::string_view file = info.dli_fname;
  return file.find("libembree") != std::string_view::npos || file.find("libtbb") != std::string_view::npos;
}

void* allocated(std::size_t size, std::size_t alignment, const void* caller) {
  if (until_failure.load() >= 0 && !is_below_us(caller) && until_failure.fetch_sub(1) == 0)
    throw std::bad_alloc();
  const std::size_t whole = (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
  if (void* const memory = std::aligned_alloc(alignment, whole)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return allocated(size, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new(std::size_t size, const std::nothrow_t& /*nothrow*/) noexcept {
  try {
    return allocated(size, alignof(std::max_align_t), __builtin_return_address(0));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace frontlux::test {
namespace {

class OutOfMemory : public testing::Test {
 protected:
  Random random_{5};
  int failures_ = 0;

  // Calls `work` until it does not throw: some allocation of each of the first tries fails.
  template <class Work>
  void attempt(const Work& work) {
    constexpr int kTries = 6;
    for (int tries = 0;; ++tries) {
      until_failure = tries < kTries ? random_.below(random_.one_in(2) ? 30 : 400) : -1;
      try {
        work();
        until_failure = -1;
        return;
      } catch (const std::bad_alloc&) {
        until_failure = -1;
        ++failures_;
        ASSERT_LT(tries, kTries);
      }
    }
  }
};

TEST_F(OutOfMemory, LeavesWhatMayBeTriedAgain) {
  octomap::OcTree tree(0.1);
  const auto change_tree = [&](int voxels) {
    for (int i = 0; i < voxels; ++i) {
      const auto key = [&](int size) { return static_cast<octomap::key_type>(32768 + random_.below(size)); };
      tree.updateNode(octomap::OcTreeKey(key(60), key(60), key(20)), random_.one_in(4));
    }
  };
  change_tree(20'000);
  LiveMap map(tree);
  const KeyBox bounds{{32760, 32760, 32760}, {32850, 32850, 32800}};
  FrontierSet frontiers(map.grid(), bounds);
  const FieldOfView lidar{FieldOfView::Shape::kSpinning, 0.0, 0.7, 2.0};
  ViewQualityOptions options;
  options.renderer = ViewQualityOptions::Renderer::kExact;
  options.azimuth_bins = 36;
  ViewQualityImage image(map.grid().lattice(), lidar, options);
  std::vector<VoxelKey> viewpoints;
  for (std::uint16_t x = 0; x < 60; x += 3)
    for (std::uint16_t y = 0; y < 60; y += 3)
      viewpoints.push_back(
          {static_cast<std::uint16_t>(32768 + x), static_cast<std::uint16_t>(32768 + y), 32778});
  image.render(map.caster(), viewpoints, frontiers.keys());

  for (int round = 0; round < 6; ++round) {
    change_tree(300);
    std::vector<VoxelKey> keys;
    attempt([&] {
      const MapChange change = map.update();
      until_failure = -1;  // this test's own copy
      keys.assign(change.keys.begin(), change.keys.end());
    });
    const VoxelGrid fresh = make_voxel_grid(tree);
    ASSERT_EQ(map.grid(), fresh);
    attempt([&] { frontiers.update({fresh, keys}); });
    const FrontierSet new_frontiers(fresh, bounds);
    ASSERT_TRUE(std::ranges::equal(frontiers.keys(), new_frontiers.keys()));
    attempt([&] { image.update(map.caster(), viewpoints, frontiers.keys(), {fresh, keys}); });
    ViewQualityImage new_image(fresh.lattice(), lidar, options);
    new_image.render(map.caster(), viewpoints, frontiers.keys());
    ASSERT_TRUE(std::ranges::equal(image.values(), new_image.values()));

    const auto reference = make_grid_ray_caster(fresh);
    const auto place = [&] {
      return Eigen::Vector3d(random_.uniform(0, 6), random_.uniform(0, 6), random_.uniform(0, 2))
          .cast<float>()
          .eval();
    };
    std::vector<Ray> rays(2000);
    std::vector<Segment> segments(20'000);
    for (Ray& ray : rays) ray = {place(), place() - place(), random_.uniform(0, 10)};
    for (Segment& segment : segments) segment = {place(), place()};
    std::vector<Hit> hits(rays.size()), expected(rays.size());
    std::vector<std::uint8_t> visible(segments.size()), expected_visible(segments.size());
    for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass}) {
      attempt([&] { map.caster().cast(rays, hits, unknown); });
      reference->cast(rays, expected, unknown);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << i;
      attempt([&] { map.caster().visible(segments, visible, unknown); });
      reference->visible(segments, expected_visible, unknown);
      ASSERT_EQ(visible, expected_visible);
    }
  }
  EXPECT_GT(failures_, 50);
}

}  // namespace
}  // namespace frontlux::test
