// The walk of packets through a table of open voxels, on every instruction set that this processor has,
// against the walk of one ray.

#include "packet/packet_walk.hpp"

#include "engine/packet/packet_maps.hpp"
#include "packet/table_query.hpp"
#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "walk/walk.hpp"

#include <gtest/gtest.h>

namespace frontlux::test {
namespace {

using detail::OpenVoxels;
using detail::TableQuery;

bool same(const Hit& a, const Hit& b) {
  return a.stop == b.stop && a.state == b.state && a.key == b.key &&
         std::memcmp(&a.end, &b.end, sizeof a.end) == 0 &&
         std::memcmp(&a.entry, &b.entry, sizeof a.entry) == 0 && a.distance == b.distance;
}

TEST(PacketWalk, SeesWhatTheWalkSees) {
  for (const detail::PacketWalk& walk : detail::packet_walks()) {
    SCOPED_TRACE(name_of(walk.needs));
    for (const VoxelGrid& grid : grids())
      for (const KeyBox& window : windows(grid))
        for (const UnknownPolicy unknown : kPolicies) {
          const OpenVoxels table = table_of(grid, unknown, window);
          const TableQuery query(grid, table, unknown, walk);
          const auto segments = adversarial_key_segments(grid, 20'000, 7);
          std::size_t answered = 0, seen = 0;
          // Batches of all sizes, so that packets start and end full and nearly empty.
          for (std::size_t begin = 0, size = 1; begin < segments.size();
               begin += size, size = size % 256 + 1) {
            const auto some = std::span(segments).subspan(begin, std::min(size, segments.size() - begin));
            std::vector<std::uint8_t> visible(some.size(), 77);
            std::vector<std::uint16_t> left(some.size());
            left.resize(query.visible(some, visible, left));
            for (std::size_t i = 0; i < some.size(); ++i) {
              if (std::binary_search(left.begin(), left.end(), i)) continue;
              ASSERT_EQ(visible[i], detail::walk_visible(grid, some[i], unknown) ? 1 : 0);
              ++answered;
              seen += visible[i];
            }
          }
          EXPECT_EQ(answered == 0, table.empty());
          const std::size_t share = window == kAllVoxels ? 1 : 8;  // of those that lie in a part of the map
          EXPECT_TRUE(table.empty() || answered > segments.size() / 4 / share) << answered;
          EXPECT_TRUE(table.empty() || seen > segments.size() / 100 / share) << seen;
        }
  }
}

TEST(PacketWalk, StopsWhereTheWalkStops) {
  for (const detail::PacketWalk& walk : detail::packet_walks()) {
    SCOPED_TRACE(name_of(walk.needs));
    for (const VoxelGrid& grid : grids())
      for (const KeyBox& window : windows(grid))
        for (const UnknownPolicy unknown : kPolicies) {
          const OpenVoxels table = table_of(grid, unknown, window);
          const TableQuery query(grid, table, unknown, walk);
          const auto rays = adversarial_rays(grid, 20'000, 8);
          std::array<std::size_t, 5> answered{};
          for (std::size_t begin = 0, size = 1; begin < rays.size(); begin += size, size = size % 256 + 1) {
            const auto some = std::span(rays).subspan(begin, std::min(size, rays.size() - begin));
            std::vector<Hit> hits(some.size());
            std::vector<std::uint16_t> left(some.size());
            left.resize(query.cast(some, hits, left));
            std::sort(left.begin(), left.end());
            for (std::size_t i = 0; i < some.size(); ++i) {
              if (std::binary_search(left.begin(), left.end(), i)) continue;
              ASSERT_TRUE(same(hits[i], detail::walk_ray(grid, some[i], unknown)));
              ++answered[static_cast<std::size_t>(hits[i].stop)];
            }
          }
          const auto count = [&](RayStop stop) { return answered[static_cast<std::size_t>(stop)]; };
          const std::size_t share = window == kAllVoxels ? 1 : 8;
          EXPECT_TRUE(table.empty() || count(RayStop::kOccupied) > rays.size() / 100 / share);
          EXPECT_TRUE(table.empty() || count(RayStop::kOutOfRange) > rays.size() / 1000 / share);
        }
  }
}

TEST(PacketWalk, TellsWhereRaysRunOut) {
  const VoxelGrid grid = hall_grid(7);
  const OpenVoxels table = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
  auto rays = adversarial_rays(grid, 40'000, 9);
  Random random(10);
  for (Ray& ray : rays)
    ray.max_range = random.one_in(20) ? -1.0 : random.uniform(0.01, random.one_in(5) ? 0.2 : 4.0);
  for (const detail::PacketWalk& walk : detail::packet_walks()) {
    SCOPED_TRACE(name_of(walk.needs));
    std::size_t told = 0, ran_out = 0;
    for (std::size_t begin = 0; begin < rays.size(); begin += detail::kMaxLines) {
      const auto some = std::span(rays).subspan(begin, std::min(detail::kMaxLines, rays.size() - begin));
      detail::RayBatch batch;
      walk.rays(grid.lattice(), table, some, batch);
      for (std::size_t i = 0; i < some.size(); ++i) {
        if (batch.stopped_at[i] == detail::kNeverStarted) continue;
        const Hit expected = detail::walk_ray(grid, some[i], UnknownPolicy::kBlock);
        ran_out += expected.stop == RayStop::kOutOfRange ? 1 : 0;
        if (batch.stopped_at[i] != detail::kFreeEnd) continue;
        ++told;
        const auto per_axis = [i](const auto& v) { return Eigen::Vector3f(v[0][i], v[1][i], v[2][i]); };
        const VoxelKey key = detail::as_key({batch.cell[0][i], batch.cell[1][i], batch.cell[2][i]});
        ASSERT_TRUE(same(Hit{RayStop::kOutOfRange, grid.at(key), key, per_axis(batch.end),
                             per_axis(batch.entry), batch.distance[i]},
                         expected));
      }
    }
    // The rest pass edges and corners, or end within the first voxels.
    EXPECT_GT(ran_out, 5000U);
    EXPECT_GT(told, ran_out / 2) << ran_out;
  }
}

// Along one axis of a hall longer than rays are walked, whose wall they reach long after it: times of
// crossings later than a walk's end are cut off, so that a ray would seem to enter the wall when it ends.
TEST(PacketWalk, IsStoppedByNothingThatComesAfterItsTime) {
  constexpr int kLength = static_cast<int>(detail::kLongestWalk) + 60;
  Random random(12);
  for (std::size_t along = 0; along < 3; ++along) {
    const std::size_t across = (along + 1) % 3, sideways = (along + 2) % 3;
    VoxelGrid grid(0.1);
    std::array<int, 3> from{32768, 32768, 32768}, to{32770, 32770, 32770};
    to[along] += kLength;
    to[sideways] += kLength / 2;
    for_each_key({detail::as_key(from), detail::as_key(to)},
                 [&](const VoxelKey& key) { grid.set(key, Occupancy::kFree); });
    from[across] = to[across];
    for_each_key({detail::as_key(from), detail::as_key(to)},
                 [&](const VoxelKey& key) { grid.set(key, Occupancy::kOccupied); });
    const OpenVoxels table = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
    for (int i = 0; i < 2000; ++i) {
      Ray ray{Eigen::Vector3f::Constant(0.15F), Eigen::Vector3f::Zero(), -1.0};
      const auto slope = static_cast<float>(random.uniform(1.0, 2.4) / detail::kLongestWalk / 2.5);
      ray.origin[static_cast<int>(along)] = static_cast<float>(random.uniform(0.0, 0.1));
      ray.origin[static_cast<int>(across)] = 0.1F - slope * static_cast<float>(random.uniform(0.0, 0.12));
      ray.direction[static_cast<int>(along)] = 1.0F;
      ray.direction[static_cast<int>(across)] = slope;
      if (i % 2 == 0)
        ray.direction[static_cast<int>(sideways)] = static_cast<float>(random.uniform(0.1, 0.4));
      for (const detail::PacketWalk& walk : detail::packet_walks()) {
        Hit hit;
        std::uint16_t left = 0;
        const TableQuery query(grid, table, UnknownPolicy::kBlock, walk);
        const bool told = query.cast({&ray, 1}, {&hit, 1}, {&left, 1}) == 0;
        ASSERT_TRUE(!told || same(hit, detail::walk_ray(grid, ray, UnknownPolicy::kBlock)))
            << name_of(walk.needs);
      }
    }
  }
}

// A ray whose distance lies in the middle between two floats, to the last bit of its direction's length: the
// sum of squares has one order.
TEST(PacketWalk, MeasuresDistancesAsTheWalkDoes) {
  VoxelGrid grid(2.0);
  for (int z = 32774; z < 32784; ++z) grid.set(make_key(32770, 32764, z), Occupancy::kFree);
  grid.set(make_key(32770, 32764, 32784), Occupancy::kOccupied);
  const Ray ray{{0x1.100b9ep+2F, -0x1.ce7894p+2F, 0x1.985ecep+3F},
                {-0x1.f83f6ap-28F, -0x1.32af1ep-26F, 0x1p+0F},
                0x1.a9c42c855b4f3p+5};
  const OpenVoxels table = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
  const Hit expected = detail::walk_ray(grid, ray, UnknownPolicy::kBlock);
  EXPECT_EQ(expected.distance, 0x1.33d09ap+4F);
  for (const detail::PacketWalk& walk : detail::packet_walks()) {
    const TableQuery query(grid, table, UnknownPolicy::kBlock, walk);
    const std::vector<Ray> rays(40, ray);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint16_t> left(rays.size());
    EXPECT_EQ(query.cast(rays, hits, left), 0U);
    for (const Hit& hit : hits)
      EXPECT_TRUE(same(hit, expected)) << name_of(walk.needs) << ' ' << hit.distance;
  }
}

// The longest offsets that fit into 32 bits of time, and those just beyond, which are left.
TEST(PacketWalk, HoldsUpToItsLongestOffset) {
  // 1008 voxels a side: with its border the largest table there is.
  VoxelGrid grid(0.1);
  constexpr int kEdge = 1008, kLow = 32768;
  const auto key = [](int i) { return static_cast<std::uint16_t>(kLow + i); };
  grid.fill({{key(0), key(0), key(0)}, 10}, Occupancy::kFree);
  for (int i = 0; i < 1024; i += 16)
    for (int j = 0; j < 1024; j += 16) {
      grid.fill({{key(kEdge), key(i), key(j)}, 4}, Occupancy::kUnknown);
      grid.fill({{key(i), key(kEdge), key(j)}, 4}, Occupancy::kUnknown);
      grid.fill({{key(i), key(j), key(kEdge)}, 4}, Occupancy::kUnknown);
    }
  Random random(3);
  for (int i = 0; i < 300'000; ++i)
    grid.set({key(random.below(kEdge)), key(random.below(kEdge)), key(random.below(kEdge))},
             Occupancy::kOccupied);
  const OpenVoxels spotted = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
  ASSERT_FALSE(spotted.empty());
  for (const detail::PacketWalk& walk : detail::packet_walks()) {
    const TableQuery query(grid, spotted, UnknownPolicy::kBlock, walk);
    std::size_t seen = 0, left_over = 0;
    for (int i = 0; i < 2'000; ++i) {
      const auto near = [&] { return random.below(12); };
      KeySegment s{{key(near()), key(near()), key(near())},
                   {key(kEdge - 1 - near()), key(kEdge - 1 - near()), key(kEdge - 1 - near())}};
      if (random.one_in(2)) std::swap(s.from, s.to);
      std::uint8_t visible = 77;
      std::uint16_t left = 0;
      if (query.visible({&s, 1}, {&visible, 1}, {&left, 1}) != 0) {
        ++left_over;
        continue;
      }
      ASSERT_EQ(visible, detail::walk_visible(grid, s, UnknownPolicy::kBlock) ? 1 : 0);
      seen += visible;
    }
    EXPECT_GT(seen, 20U);
    EXPECT_GT(left_over, 20U);
  }
}

// Rays nearly along an axis, through halls longer than a walk: the crossings across come at times far beyond
// its end.
TEST(TableQuery, RaysAloneAreThoseOfTheWalkAlongHalls) {
  constexpr double kEdge = 0.1;
  Random random(17);
  std::size_t stopped = 0, left_over = 0;
  for (int axis = 0; axis < 3; ++axis) {
    VoxelGrid grid(kEdge);
    std::array<int, 3> size{3, 3, 3};
    size[static_cast<std::size_t>(axis)] = 520;
    for_each_key({{32768, 32768, 32768}, make_key(32767 + size[0], 32767 + size[1], 32767 + size[2])},
                 [&](const VoxelKey& key) { grid.set(key, Occupancy::kFree); });
    const OpenVoxels table = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
    const TableQuery query(grid, table, UnknownPolicy::kBlock);
    for (int i = 0; i < 20'000; ++i) {
      // Just beyond a face across, or anywhere.
      const auto across = [&] {
        const double beyond =
            random.one_in(2) ? std::pow(10.0, random.uniform(-6, -1)) : random.uniform(0, 1);
        const double in_voxel = random.one_in(2) ? beyond : 1.0 - beyond;
        return static_cast<float>((random.below(3) + in_voxel) * kEdge);
      };
      const auto slope = [&] {
        const double steep = std::pow(10.0, random.uniform(-7, -2));
        return static_cast<float>(random.one_in(4) ? 0.0 : random.one_in(2) ? steep : -steep);
      };
      Ray ray{{across(), across(), across()}, {slope(), slope(), slope()}, -1.0};
      const bool back = random.one_in(2);
      ray.direction[axis] = back ? -1.0F : 1.0F;
      ray.origin[axis] =
          static_cast<float>((back ? random.uniform(415, 520) : random.uniform(0, 105)) * kEdge);
      Hit hit;
      std::uint16_t left = 0;
      if (query.cast({&ray, 1}, {&hit, 1}, {&left, 1}) != 0) {
        ++left_over;
        continue;
      }
      ++stopped;
      ASSERT_TRUE(same(hit, detail::walk_ray(grid, ray, UnknownPolicy::kBlock)))
          << ray.origin.transpose() << ", " << ray.direction.transpose();
    }
  }
  EXPECT_GT(stopped, 10'000U);
  EXPECT_GT(left_over, 10'000U);
}

TEST(TableQuery, LeavesEverythingToOthersIfThereIsNoTable) {
  const VoxelGrid grid(0.25);
  const OpenVoxels table = table_of(grid, UnknownPolicy::kBlock, kAllVoxels);
  ASSERT_TRUE(table.empty());
  const TableQuery query(grid, table, UnknownPolicy::kBlock);
  const auto rays = adversarial_rays(corner_grid(0, 1), 10, 1);
  const std::vector<KeySegment> segments(10);
  std::vector<Hit> hits(10);
  std::vector<std::uint8_t> visible(10);
  std::vector<std::uint16_t> left(10);
  EXPECT_EQ(query.cast(rays, hits, left), 10U);
  EXPECT_EQ(left[9], 9);
  left.assign(10, 0);
  EXPECT_EQ(query.visible(segments, visible, left), 10U);
  EXPECT_EQ(left[9], 9);
}

}  // namespace
}  // namespace frontlux::test
