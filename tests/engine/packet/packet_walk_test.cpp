// The table of open voxels against the grid, and the walk of packets through it, on every instruction set
// that this processor has, against the walk of one ray.

#include "packet/packet_walk.hpp"

#include "packet/open_voxels.hpp"
#include "packet/table_query.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "walk/walk.hpp"

#include <frontlux/octomap.hpp>

#include <gtest/gtest.h>

namespace frontlux::test {
namespace {

using detail::OpenVoxels;
using detail::TableQuery;

constexpr UnknownPolicy kPolicies[] = {UnknownPolicy::kBlock, UnknownPolicy::kPass};

bool same(const Hit& a, const Hit& b) {
  return a.stop == b.stop && a.state == b.state && a.key == b.key &&
         std::memcmp(&a.end, &b.end, sizeof a.end) == 0 &&
         std::memcmp(&a.entry, &b.entry, sizeof a.entry) == 0 && a.distance == b.distance;
}

// 40 x 40 x 40 voxels of noise in a corner of the key range.
VoxelGrid corner_grid(int corner, std::uint64_t seed) {
  VoxelGrid grid(0.25);
  Random random(seed);
  const auto key = [&](int i) { return static_cast<std::uint16_t>(corner == 0 ? i : 65535 - i); };
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 40; ++y)
      for (int z = 0; z < 40; ++z)
        grid.set({key(x), key(y), key(z)}, random.one_in(30)   ? Occupancy::kOccupied
                                           : random.one_in(30) ? Occupancy::kUnknown
                                                               : Occupancy::kFree);
  return grid;
}

// A hall of 192 x 160 x 96 voxels with posts, slabs and specks, where most space is open.
VoxelGrid hall_grid(std::uint64_t seed) {
  VoxelGrid grid(0.1);
  Random random(seed);
  const auto key = [](int i) { return static_cast<std::uint16_t>(32700 + i); };
  const auto put = [&](const std::array<int, 3>& at, const std::array<int, 3>& size, Occupancy state) {
    for (int x = at[0]; x < std::min(at[0] + size[0], 192); ++x)
      for (int y = at[1]; y < std::min(at[1] + size[1], 160); ++y)
        for (int z = at[2]; z < std::min(at[2] + size[2], 96); ++z) grid.set({key(x), key(y), key(z)}, state);
  };
  put({0, 0, 0}, {192, 160, 96}, Occupancy::kFree);
  const auto somewhere = [&] { return std::array{random.below(192), random.below(160), random.below(96)}; };
  for (int i = 0; i < 6; ++i) put(somewhere(), {2, 3, 90}, Occupancy::kOccupied);
  for (int i = 0; i < 4; ++i) put(somewhere(), {40, 30, 1}, Occupancy::kOccupied);
  for (int i = 0; i < 30; ++i)
    put(somewhere(), {1, 1, 1}, i % 2 == 0 ? Occupancy::kOccupied : Occupancy::kUnknown);
  return grid;
}

std::vector<VoxelGrid> grids() {
  std::vector<VoxelGrid> grids;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    grids.push_back(make_voxel_grid(*make_random_tree(seed, 0.3)));  // as large as the key range: no table
    grids.push_back(make_voxel_grid(*make_noise_tree(seed, 0.3, 24)));
  }
  grids.push_back(corner_grid(0, 5));
  grids.push_back(corner_grid(65535, 6));
  grids.push_back(hall_grid(7));
  return grids;
}

// All of a map, and a part of it that is cut off on all four sides.
std::vector<KeyBox> windows(const VoxelGrid& grid) {
  const KeyBox known = *grid.known_bounds();
  const auto inner = [](int low, int high) {
    const int margin = (high - low) / 5;
    return std::array{(low + margin) & ~7, (high - margin) | 7};
  };
  const auto x = inner(known.min.x, known.max.x), y = inner(known.min.y, known.max.y);
  return {kAllVoxels, {make_key(x[0], y[0], 0), make_key(x[1], y[1], 65535)}};
}

OpenVoxels table_of(const VoxelGrid& grid, UnknownPolicy unknown, const KeyBox& window) {
  return {grid, unknown, grid.known_bounds(), window};
}

TEST(OpenVoxels, EqualTheGridAndAreClosedAroundIt) {
  for (const VoxelGrid& grid : grids())
    for (const UnknownPolicy unknown : kPolicies) {
      const OpenVoxels table = table_of(grid, unknown, kAllVoxels);
      if (table.empty()) continue;
      const KeyBox known = *grid.known_bounds();
      std::size_t open = 0;
      const auto low = table.layout().corner;
      for (int z = low[2]; z < (known.max.z | 7) + 9; ++z)
        for (int y = low[1]; y < (known.max.y | 7) + 9; ++y)
          for (int x = low[0]; x < (known.max.x | 7) + 9; ++x) {
            // The border may lie outside the key range: a key would wrap around, an index must not.
            const VoxelKey key = detail::as_key({x, y, z});
            const bool is_key = detail::as_array(key) == std::array<int, 3>{x, y, z};
            if (!is_key) continue;
            const std::uint32_t index = table.layout().index(key);
            ASSERT_EQ(table.layout().key(index), (std::array<int, 3>{x, y, z}));
            const bool expected = table.contains(key) && !detail::blocks(grid.at(key), unknown);
            ASSERT_EQ(table.open(index), expected);
            open += expected ? 1 : 0;
          }
      EXPECT_GT(open, std::size_t{1000});
    }
}

// Compares voxels and radii, at places drawn from the table, with the grid.
// @return how many cells are open two cells around and more
std::size_t expect_equal(const OpenVoxels& table, const VoxelGrid& grid, UnknownPolicy unknown,
                         Random& random, int places = 500) {
  const auto is_open = [&](const std::array<int, 3>& voxel) {
    const VoxelKey key = detail::as_key(voxel);
    return detail::as_array(key) == voxel && table.contains(key) && !detail::blocks(grid.at(key), unknown);
  };
  std::size_t wide = 0;
  for (int i = 0; i < places; ++i) {
    std::array<int, 3> cell{};
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = table.bounds_min(a) + 4 * random.below((table.bounds_max(a) + 1 - table.bounds_min(a)) / 4);
    const auto open_cells = [&](int around) {
      for (int x = cell[0] - 4 * around; x < cell[0] + 4 * around + 4; ++x)
        for (int y = cell[1] - 4 * around; y < cell[1] + 4 * around + 4; ++y)
          for (int z = cell[2] - 4 * around; z < cell[2] + 4 * around + 4; ++z)
            if (!is_open({x, y, z})) return false;
      return true;
    };
    const std::uint32_t index = table.layout().index(detail::as_key(cell));
    EXPECT_EQ(table.open(index), is_open(cell));
    const int radius = static_cast<int>(table.radius(index));
    EXPECT_TRUE(radius == 0 || open_cells(radius - 1));
    EXPECT_TRUE(radius == 15 || !open_cells(radius));
    wide += radius >= 2 ? 1 : 0;
  }
  return wide;
}

TEST(OpenVoxels, TellHowFarItIsOpenAroundACell) {
  Random random(11);
  for (const VoxelGrid& grid : grids())
    for (const UnknownPolicy unknown : kPolicies) {
      const OpenVoxels table = table_of(grid, unknown, kAllVoxels);
      if (!table.empty()) expect_equal(table, grid, unknown, random);
    }
  const VoxelGrid hall = hall_grid(7);
  EXPECT_GT(
      expect_equal(table_of(hall, UnknownPolicy::kBlock, kAllVoxels), hall, UnknownPolicy::kBlock, random),
      100U);
}

// Scans that change some voxels, uncover what was unknown, or forget a part; now and then beyond the table.
void expect_followed(UnknownPolicy unknown, std::uint64_t seed, bool whole) {
  Random random(seed);
  VoxelGrid grid = hall_grid(seed);
  const KeyBox window = windows(grid)[whole ? 0 : 1];
  OpenVoxels table = table_of(grid, unknown, window);
  KeyBox around = *grid.known_bounds();
  int followed = 0, outgrown = 0;
  for (int change = 0; change < 12; ++change) {
    const VoxelGrid before = grid;
    if (change % 3 == 2) around = grown(around, 16);
    const VoxelKey from = random.key_in(around);
    const KeyBox box = *intersection(
        {from, make_key(from.x + random.below(30), from.y + random.below(30), from.z + random.below(12))},
        around);
    const Occupancy state = detail::kStates[static_cast<std::size_t>(random.below(3))];
    for_each_key(box, [&](const VoxelKey& key) { grid.set(key, state); });
    if (random.one_in(3)) grid.fill({make_key(from.x & ~63, from.y & ~63, from.z & ~63), 6}, state);
    if (table.update(before, grid)) {
      ++followed;
    } else {
      ++outgrown;
      table = table_of(grid, unknown, window);
    }
    expect_equal(table, grid, unknown, random, 40);
  }
  EXPECT_GT(followed, 4);
  EXPECT_GT(outgrown, 0);
}

TEST(OpenVoxels, FollowAMapThatChangesAndGrows) {
  for (const bool whole : {true, false})
    for (const UnknownPolicy unknown : kPolicies)
      for (std::uint64_t seed = 1; seed <= (long_mode() ? 4 : 2); ++seed) {
        SCOPED_TRACE(seed);
        expect_followed(unknown, seed, whole);
      }
}

TEST(OpenVoxels, HaveRoomForWhatIsForgotten) {
  VoxelGrid grid = corner_grid(0, 5);
  const VoxelKey lone{80, 20, 20};  // alone in its cube of 64 voxels
  grid.set(lone, Occupancy::kFree);
  for (const UnknownPolicy unknown : kPolicies) {
    OpenVoxels table = table_of(grid, unknown, kAllVoxels);
    VoxelGrid after = grid;
    after.set(lone, Occupancy::kUnknown);
    EXPECT_TRUE(table.update(grid, after));
    EXPECT_EQ(table.open(table.layout().index(lone)), !detail::blocks(Occupancy::kUnknown, unknown));
  }
}

TEST(OpenVoxels, StayEmptyWhereThereIsNothingOrFarTooMuch) {
  VoxelGrid grid(0.1);
  EXPECT_TRUE(table_of(grid, UnknownPolicy::kBlock, kAllVoxels).empty());
  grid.set({1, 1, 1}, Occupancy::kFree);
  EXPECT_FALSE(table_of(grid, UnknownPolicy::kBlock, kAllVoxels).empty());
  grid.set({60000, 60000, 60000}, Occupancy::kFree);
  EXPECT_TRUE(table_of(grid, UnknownPolicy::kPass, kAllVoxels).empty());
  EXPECT_FALSE(table_of(grid, UnknownPolicy::kPass, kAllVoxels).contains({1, 1, 1}));
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
