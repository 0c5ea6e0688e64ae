// castRay, replaced call by call.

#include <frontlux/octomap.hpp>

#include <octomap/OcTree.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <random>

namespace {

std::array<std::uint32_t, 3> bits(const octomap::point3d& p) {
  return {std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y()),
          std::bit_cast<std::uint32_t>(p.z())};
}

// A room of 4 x 4 x 2 m with walls, seen from its middle: occupied, free and unknown voxels.
octomap::OcTree make_room() {
  octomap::OcTree tree(0.1);
  const octomap::point3d sensor(0.05F, 0.05F, 0.05F);
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      const float a = 0.1F * static_cast<float>(i), b = 0.1F * static_cast<float>(j);
      tree.insertRay(sensor, {2.0F, a, 0.5F * b});
      tree.insertRay(sensor, {-2.0F, a, 0.5F * b});
      tree.insertRay(sensor, {a, 2.0F, 0.5F * b});
      tree.insertRay(sensor, {a, b, -1.0F});
    }
  return tree;
}

}  // namespace

int main() {
  const octomap::OcTree tree = make_room();
  const frontlux::OctreeRayCaster fast(tree);

  std::mt19937 random(1);
  const auto draw = [&random](float size) {
    const auto coordinate = [&] { return size * (static_cast<float>(random() % 2001) / 1000.0F - 1.0F); };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    return octomap::point3d(x, y, z);
  };

  int different = 0, hits = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const octomap::point3d origin = draw(2.5F), direction = draw(1.0F);
    const bool ignore_unknown = i % 2 == 1;
    const double max_range = ignore_unknown ? 3.0 : i % 4 == 0 ? 1.5 : -1.0;
    octomap::point3d expected, end;
    const bool expected_hit = tree.castRay(origin, direction, expected, ignore_unknown, max_range);
    const bool hit = fast.castRay(origin, direction, end, ignore_unknown, max_range);
    different += hit != expected_hit || bits(end) != bits(expected);
    hits += expected_hit;
  }
  std::printf("%d rays, %d hits, %d answers differ from castRay's\n", kRays, hits, different);
  return different == 0 && hits > 0 ? 0 : 1;
}
