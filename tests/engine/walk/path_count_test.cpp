// Counts along paths against paths made another way: castRay's traversal written out over the tree, and exact
// fractions between voxel centres.

#include "support/casters.hpp"
#include "support/complaint.hpp"
#include "support/maps.hpp"
#include "support/octomap_answers.hpp"
#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "support/tree_state.hpp"

#include <frontlux/parallel.hpp>

#include <tbb/task_arena.h>

#include <ostream>

namespace frontlux {

void PrintTo(const PathCount& count, std::ostream* out) {
  *out << count.unknown << " unknown, " << count.free << " free, " << count.occupied << " occupied, stop "
       << static_cast<int>(count.stop);
}

}  // namespace frontlux

namespace frontlux::test {
namespace {

// Adds up voxels until something stops the path.
class Tally {
 public:
  Tally(const octomap::OcTree& tree, UnknownPolicy unknown) : tree_(tree), unknown_(unknown) {}

  [[nodiscard]] Occupancy state(const octomap::OcTreeKey& key) const { return state_of(tree_, key); }
  [[nodiscard]] bool blocks(const octomap::OcTreeKey& key) const {
    const Occupancy s = state(key);
    return s == Occupancy::kOccupied || (s == Occupancy::kUnknown && unknown_ == UnknownPolicy::kBlock);
  }
  void add(const octomap::OcTreeKey& key) {
    const Occupancy s = state(key);
    ++(s == Occupancy::kUnknown ? count_.unknown : s == Occupancy::kFree ? count_.free : count_.occupied);
  }
  PathCount blocked(const octomap::OcTreeKey& key) {
    return stopped(state(key) == Occupancy::kOccupied ? RayStop::kOccupied : RayStop::kUnknown);
  }
  PathCount stopped(RayStop stop) {
    count_.stop = stop;
    return count_;
  }

 private:
  const octomap::OcTree& tree_;
  UnknownPolicy unknown_;
  PathCount count_;
};

// castRay's path, one voxel after the other.
struct CastRayPath {
  octomap::OcTreeKey key;
  std::array<int, 3> step{};
  std::array<double, 3> t_max{}, t_delta{};

  CastRayPath(const octomap::OcTree& tree, const octomap::point3d& origin, const octomap::OcTreeKey& start,
              const octomap::point3d& any_direction)
      : key(start) {
    const octomap::point3d direction = any_direction.normalized();
    for (unsigned i = 0; i < 3; ++i) {
      const auto d = static_cast<double>(direction(i));
      step[i] = d > 0 ? 1 : d < 0 ? -1 : 0;
      t_max[i] = t_delta[i] = std::numeric_limits<double>::max();
      if (step[i] == 0) continue;
      double border = tree.keyToCoord(start[i]);
      border += static_cast<double>(static_cast<float>(step[i]) * tree.getResolution() * 0.5);
      t_max[i] = (border - static_cast<double>(origin(i))) / d;
      t_delta[i] = tree.getResolution() / std::fabs(d);
    }
  }
  [[nodiscard]] bool has_direction() const { return step != std::array{0, 0, 0}; }
  [[nodiscard]] unsigned next_axis() const {
    if (t_max[0] < t_max[1]) return t_max[0] < t_max[2] ? 0 : 2;
    return t_max[1] < t_max[2] ? 1 : 2;
  }
  // False at the end of the key range.
  bool advance() {
    const unsigned axis = next_axis();
    if (key[axis] == (step[axis] < 0 ? 0 : 65535)) return false;
    key[axis] = static_cast<octomap::key_type>(key[axis] + step[axis]);
    t_max[axis] += t_delta[axis];
    return true;
  }
};

octomap::point3d point(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }

std::optional<octomap::OcTreeKey> key_of(const octomap::OcTree& tree, const Eigen::Vector3f& p) {
  octomap::OcTreeKey key;
  if (!octomap_knows_key(p) || !tree.coordToKeyChecked(point(p), key)) return std::nullopt;
  return key;
}

PathCount expected_count(const octomap::OcTree& tree, const Ray& ray, UnknownPolicy unknown) {
  const auto start = key_of(tree, ray.origin);
  if (!start) return {};
  Tally tally(tree, unknown);
  if (tally.blocks(*start)) return tally.blocked(*start);
  CastRayPath path(tree, point(ray.origin), *start, point(ray.direction));
  if (!path.has_direction()) return {};
  while (true) {
    tally.add(path.key);
    if (!path.advance()) return tally.stopped(RayStop::kLeftMap);
    if (ray.max_range > 0.0) {
      const octomap::point3d center = tree.keyToCoord(path.key);
      double distance_sq = 0.0;
      for (unsigned i = 0; i < 3; ++i)
        distance_sq += static_cast<double>((center(i) - ray.origin[static_cast<int>(i)]) *
                                           (center(i) - ray.origin[static_cast<int>(i)]));
      if (distance_sq > ray.max_range * ray.max_range) return tally.stopped(RayStop::kOutOfRange);
    }
    if (tally.blocks(path.key)) return tally.blocked(path.key);
  }
}

PathCount expected_count(const octomap::OcTree& tree, const Segment& segment, UnknownPolicy unknown) {
  const auto from = key_of(tree, segment.from), to = key_of(tree, segment.to);
  if (!from || !to) return {};
  Tally tally(tree, unknown);
  if (*from == *to) return tally.stopped(RayStop::kReached);
  CastRayPath path(tree, point(segment.from), *from, point(segment.to) - point(segment.from));
  if (!path.has_direction()) return {};
  while (true) {
    tally.add(path.key);
    if (!path.advance()) return tally.stopped(RayStop::kOutOfRange);
    if (path.key == *to) return tally.stopped(RayStop::kReached);
    for (unsigned i = 0; i < 3; ++i)
      if ((path.key[i] - (*to)[i]) * path.step[i] > 0) return tally.stopped(RayStop::kOutOfRange);
    if (tally.blocks(path.key)) return tally.blocked(path.key);
  }
}

// The n-th crossing of an axis with d voxels to go comes at (2 n - 1) / 2 d; of equal ones z, y, x.
PathCount expected_count(const octomap::OcTree& tree, const KeySegment& segment, UnknownPolicy unknown) {
  octomap::OcTreeKey key(segment.from.x, segment.from.y, segment.from.z);
  const octomap::OcTreeKey to(segment.to.x, segment.to.y, segment.to.z);
  Tally tally(tree, unknown);
  std::array<std::int64_t, 3> distance{}, crossings{};
  for (unsigned i = 0; i < 3; ++i) distance[i] = std::abs(to[i] - key[i]);
  while (key != to) {
    if (crossings != std::array<std::int64_t, 3>{} && tally.blocks(key)) return tally.blocked(key);
    tally.add(key);
    unsigned next = 3;
    for (const unsigned i : {2U, 1U, 0U}) {
      if (crossings[i] == distance[i]) continue;
      if (next == 3 || (2 * crossings[i] + 1) * distance[next] < (2 * crossings[next] + 1) * distance[i])
        next = i;
    }
    ++crossings[next];
    key[next] = static_cast<octomap::key_type>(key[next] + (to[next] > key[next] ? 1 : -1));
  }
  return tally.stopped(RayStop::kReached);
}

constexpr PathCount kNotWritten{999, 999, 999, RayStop::kLeftMap};

// Compares all casters with the oracle, on one thread and on two.
// @return how many voxels of each state were counted, and how often each stop came up
template <class Path>
std::array<std::uint64_t, 9> expect_counts(const octomap::OcTree& tree, const Casters& casters,
                                           const std::vector<Path>& paths, UnknownPolicy unknown) {
  std::vector<PathCount> expected(paths.size());
  for_each_index(paths.size(), [&](std::size_t i) { expected[i] = expected_count(tree, paths[i], unknown); });
  for (const auto& [name, caster] : casters.all)
    for (const int threads : {1, 2}) {
      std::vector<PathCount> counts(paths.size(), kNotWritten);
      tbb::task_arena(threads).execute([&, &asked = *caster] { asked.count(paths, counts, unknown); });
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < paths.size(); ++i)
        if (!(counts[i] == expected[i]) && ++wrong <= 3)
          ADD_FAILURE() << name << ", path " << i << ": " << testing::PrintToString(counts[i])
                        << "; expected " << testing::PrintToString(expected[i]);
      EXPECT_EQ(wrong, 0U) << name << " of " << paths.size();
    }
  std::array<std::uint64_t, 9> seen{};
  for (const PathCount& count : expected) {
    seen[0] += count.unknown;
    seen[1] += count.free;
    seen[2] += count.occupied;
    ++seen[3 + static_cast<std::size_t>(count.stop)];
  }
  return seen;
}

TEST(PathCount, IsThatOfThePathWrittenOut) {
  std::array<std::uint64_t, 9> seen{};
  const std::size_t count = long_mode() ? 100'000 : 4'000;
  for (const NamedMap& map : small_maps()) {
    SCOPED_TRACE(map.name);
    const Casters casters(*map.tree);
    for (const UnknownPolicy unknown : kPolicies) {
      const auto add = [&](const auto& paths) {
        const auto more = expect_counts(*map.tree, casters, paths, unknown);
        for (std::size_t i = 0; i < seen.size(); ++i) seen[i] += more[i];
      };
      add(adversarial_rays(casters.grid, count, 21));
      add(adversarial_segments(casters.grid, count, 22));
      add(adversarial_key_segments(casters.grid, count, 23));
    }
  }
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_GT(seen[i], 10U) << "too rare in the sample: " << i;
}

// Across the whole key range, through uniform cubes of all sizes: nobody walks there, the oracle does.
TEST(PathCount, OfPathsWithoutEnd) {
  for (const NamedMap& map : small_maps()) {
    SCOPED_TRACE(map.name);
    const Casters casters(*map.tree);
    auto rays = adversarial_rays(casters.grid, 60, 24);
    for (Ray& ray : rays) ray.max_range = -1.0;
    auto segments = adversarial_segments(casters.grid, 60, 25);
    auto keys = adversarial_key_segments(casters.grid, 60, 26);
    Random random(27);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const VoxelKey far = random.key_in(kAllVoxels);
      (i % 2 == 0 ? keys[i].from : keys[i].to) = far;
      (i % 2 == 0 ? segments[i].from : segments[i].to) = casters.grid.lattice().center(far);
    }
    expect_counts(*map.tree, casters, rays, UnknownPolicy::kPass);
    expect_counts(*map.tree, casters, segments, UnknownPolicy::kPass);
    expect_counts(*map.tree, casters, keys, UnknownPolicy::kPass);
  }
}

// Steps, stops and sight are also known from the other queries.
TEST(PathCount, AgreesWithCastAndVisible) {
  const auto tree = make_random_tree(5, 0.2);
  const Casters casters(*tree);
  const auto rays = adversarial_rays(casters.grid, 20'000, 31);
  const auto segments = adversarial_segments(casters.grid, 20'000, 32);
  const auto keys = adversarial_key_segments(casters.grid, 20'000, 33);
  std::vector<PathCount> counts(rays.size());
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> visible(rays.size());
  for (std::size_t c = 0; c + 1 < casters.all.size(); ++c) {  // the last is OctoMap's, whose `visible` rounds
    const RayCaster& caster = *casters.all[c].second;
    for (const UnknownPolicy unknown : kPolicies) {
      caster.cast(rays, hits, unknown);
      caster.count(rays, counts, unknown);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(counts[i].stop, hits[i].stop) << i;
        if (hits[i].stop == RayStop::kInvalid) continue;
        const VoxelKey from = casters.grid.lattice().key(rays[i].origin).value(), to = hits[i].key;
        const int steps = std::abs(from.x - to.x) + std::abs(from.y - to.y) + std::abs(from.z - to.z);
        const std::uint32_t voxels =
            static_cast<std::uint32_t>(steps) + (hits[i].stop == RayStop::kLeftMap ? 1 : 0);
        ASSERT_EQ(counts[i].unknown + counts[i].free + counts[i].occupied, voxels) << i;
        ASSERT_TRUE(unknown == UnknownPolicy::kPass || counts[i].free == voxels) << i;
      }
      const auto expect_sight = [&](const auto& paths) {
        caster.visible(paths, visible, unknown);
        caster.count(paths, counts, unknown);
        for (std::size_t i = 0; i < paths.size(); ++i)
          ASSERT_EQ(counts[i].stop == RayStop::kReached, visible[i] == 1) << i;
      };
      expect_sight(segments);
      expect_sight(keys);
    }
  }
}

TEST(PathCount, OfAPathThatCanBeCountedByHand) {
  // Along x from key 0: two free, three unknown, one free, one occupied, unknown from there on.
  octomap::OcTree tree(0.5);
  const auto at = [](int x) {
    return octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + x), 32768, 32768);
  };
  for (const int x : {0, 1, 5}) tree.updateNode(at(x), false);
  tree.updateNode(at(6), true);
  const Casters casters(tree);
  const auto key = [](int x) { return VoxelKey{static_cast<std::uint16_t>(32768 + x), 32768, 32768}; };
  const Eigen::Vector3f origin(0.25F, 0.25F, 0.25F), east(3.0F, 0.0F, 0.0F), west(-1.0F, 0.0F, 0.0F),
      wall(3.25F, 0.25F, 0.25F), behind(4.25F, 0.25F, 0.25F);
  const auto pass = UnknownPolicy::kPass, block = UnknownPolicy::kBlock;
  for (const auto& [name, caster] : casters.all) {
    SCOPED_TRACE(name);
    const auto count = [&asked = *caster](const auto& path, UnknownPolicy unknown) {
      PathCount result = kNotWritten;
      asked.count({&path, 1}, {&result, 1}, unknown);
      return result;
    };
    EXPECT_EQ(count(Ray{origin, east, -1.0}, pass), (PathCount{3, 3, 0, RayStop::kOccupied}));
    EXPECT_EQ(count(Ray{origin, east, -1.0}, block), (PathCount{0, 2, 0, RayStop::kUnknown}));
    // The centre of the third voxel is 1 m away.
    EXPECT_EQ(count(Ray{origin, east, 0.9}, pass), (PathCount{0, 2, 0, RayStop::kOutOfRange}));
    EXPECT_EQ(count(Ray{origin, east, 1.0}, pass), (PathCount{1, 2, 0, RayStop::kOutOfRange}));
    EXPECT_EQ(count(Ray{wall, east, 1.0}, pass), (PathCount{0, 0, 0, RayStop::kOccupied}));
    EXPECT_EQ(count(Ray{behind, east, 1.0}, block), (PathCount{0, 0, 0, RayStop::kUnknown}));
    // To key 0 all is unknown, and key 0 is the last voxel crossed.
    EXPECT_EQ(count(Ray{origin, west, -1.0}, pass), (PathCount{32768, 1, 0, RayStop::kLeftMap}));
    EXPECT_EQ(count(Ray{origin, {0, 0, 0}, -1.0}, pass), PathCount{});

    EXPECT_EQ(count(Segment{origin, wall}, pass), (PathCount{3, 3, 0, RayStop::kReached}));
    EXPECT_EQ(count(Segment{origin, behind}, pass), (PathCount{3, 3, 0, RayStop::kOccupied}));
    EXPECT_EQ(count(Segment{wall, origin}, pass), (PathCount{3, 2, 1, RayStop::kReached}));
    EXPECT_EQ(count(Segment{wall, origin}, block), (PathCount{0, 1, 1, RayStop::kUnknown}));
    EXPECT_EQ(count(Segment{wall, wall}, block), (PathCount{0, 0, 0, RayStop::kReached}));
    EXPECT_EQ(count(KeySegment{key(0), key(6)}, pass), (PathCount{3, 3, 0, RayStop::kReached}));
    EXPECT_EQ(count(KeySegment{key(0), key(8)}, pass), (PathCount{3, 3, 0, RayStop::kOccupied}));
    EXPECT_EQ(count(KeySegment{key(6), key(0)}, block), (PathCount{0, 1, 1, RayStop::kUnknown}));
    EXPECT_EQ(count(KeySegment{key(8), key(8)}, pass), (PathCount{0, 0, 0, RayStop::kReached}));
  }
}

TEST(PathCount, OfWhatCannotBeCastIsZeroAndInvalid) {
  const auto tree = make_noise_tree(3, 0.3, 16);
  const Casters casters(*tree);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Eigen::Vector3f here = casters.grid.lattice().center({32768, 32768, 32768}), east(1.0F, 0, 0);
  for (const auto& [name, caster] : casters.all)
    for (const UnknownPolicy unknown : kPolicies)
      for (const Eigen::Vector3f& bad : {Eigen::Vector3f(nan, 0, 0), Eigen::Vector3f(0, infinity, 0),
                                         Eigen::Vector3f(0, 0, -1e30F), Eigen::Vector3f(9830.4F, 0, 0)}) {
        const std::vector<Ray> rays = {{bad, east, 10.0}, {bad, east, -1.0}, {bad, bad, 1.0}};
        const std::vector<Segment> segments = {{bad, here}, {here, bad}, {bad, bad}};
        std::vector<PathCount> counts(3, kNotWritten);
        caster->count(rays, counts, unknown);
        EXPECT_EQ(counts, std::vector<PathCount>(3)) << name;
        counts.assign(3, kNotWritten);
        caster->count(segments, counts, unknown);
        EXPECT_EQ(counts, std::vector<PathCount>(3)) << name;
      }
}

TEST(PathCount, SpansOfDifferentSizesThrow) {
  const auto tree = make_noise_tree(3, 0.3, 16);
  const Casters casters(*tree);
  std::vector<PathCount> counts(2, kNotWritten);
  for (const auto& [name, caster] : casters.all) {
    EXPECT_REFUSED(caster->count(std::vector<Ray>(3), counts, UnknownPolicy::kPass));
    EXPECT_REFUSED(caster->count(std::vector<Segment>(1), counts, UnknownPolicy::kPass));
    EXPECT_REFUSED(caster->count(std::vector<KeySegment>(0), counts, UnknownPolicy::kPass));
    EXPECT_NO_THROW(caster->count(std::span<const Ray>{}, std::span<PathCount>{}, UnknownPolicy::kPass));
  }
  EXPECT_EQ(counts, std::vector<PathCount>(2, kNotWritten));
}

// An updated caster counts as a new one does.
TEST(PathCount, AfterAnUpdate) {
  VoxelGrid grid = make_voxel_grid(*make_random_tree(6, 0.3));
  const auto casters = casters_of(grid);
  const auto rays = adversarial_rays(grid, 3'000, 41);
  Random random(42);
  for (int i = 0; i < 400; ++i) grid.set(random.key_in(cube({32688, 32688, 32688}, 160)), random.state());
  std::vector<PathCount> before(rays.size()), expected(rays.size()), counts(rays.size());
  casters[0]->count(rays, before, UnknownPolicy::kPass);
  make_grid_ray_caster(grid)->count(rays, expected, UnknownPolicy::kPass);
  ASSERT_NE(before, expected);
  for (const auto& caster : casters) {
    caster->update(grid);
    caster->count(rays, counts, UnknownPolicy::kPass);
    EXPECT_EQ(counts, expected);
  }
}

}  // namespace
}  // namespace frontlux::test
