// What holds for every caster: batches, threads, bad input, updates while others read.

#include "support/casters.hpp"
#include "support/complaint.hpp"
#include "support/floating_point_control.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"
#include "support/ray_samples.hpp"
#include "support/voxel_keys.hpp"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <cfenv>
#include <optional>
#include <thread>

namespace frontlux::test {
namespace {

struct Answers {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> between_points, between_keys;
};

struct Questions {
  std::vector<Ray> rays;
  std::vector<Segment> segments;
  std::vector<KeySegment> keys;

  Questions(const VoxelGrid& grid, std::size_t count)
      : rays(adversarial_rays(grid, count, 3)),
        segments(adversarial_segments(grid, count, 4)),
        keys(adversarial_key_segments(grid, count, 5)) {}

  [[nodiscard]] Answers ask(const RayCaster& caster, std::size_t batch) const {
    Answers answers{std::vector<Hit>(rays.size()), std::vector<std::uint8_t>(rays.size()),
                    std::vector<std::uint8_t>(rays.size())};
    for (std::size_t i = 0; i < rays.size(); i += batch) {
      const std::size_t n = std::min(batch, rays.size() - i);
      caster.cast(std::span(rays).subspan(i, n), std::span(answers.hits).subspan(i, n),
                  UnknownPolicy::kBlock);
      caster.visible(std::span(segments).subspan(i, n), std::span(answers.between_points).subspan(i, n),
                     UnknownPolicy::kPass);
      caster.visible(std::span(keys).subspan(i, n), std::span(answers.between_keys).subspan(i, n),
                     UnknownPolicy::kBlock);
    }
    return answers;
  }
};

void expect_equal(const Answers& a, const Answers& b) {
  ASSERT_EQ(a.hits.size(), b.hits.size());
  for (std::size_t i = 0; i < a.hits.size(); ++i) ASSERT_TRUE(same(a.hits[i], b.hits[i])) << i;
  EXPECT_EQ(a.between_points, b.between_points);
  EXPECT_EQ(a.between_keys, b.between_keys);
}

TEST(RayCaster, AnswersDependOnNeitherThreadsNorBatchNorOrder) {
  const auto tree = make_random_tree(1, 0.3);
  const Casters casters(*tree);
  const Questions questions(casters.grid, 5000);
  std::vector<std::size_t> order(questions.rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(9);
  random.shuffle(order);
  Questions shuffled = questions;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.rays[i] = questions.rays[order[i]];
    shuffled.segments[i] = questions.segments[order[i]];
    shuffled.keys[i] = questions.keys[order[i]];
  }
  for (const auto& [name, caster] : casters.all) {
    SCOPED_TRACE(name);
    const Answers reference = questions.ask(*caster, 5000);
    for (const int threads : {1, 2})
      tbb::task_arena(threads).execute(
          [&, &asked = *caster] { expect_equal(reference, questions.ask(asked, 5000)); });
    for (const std::size_t batch : {std::size_t{1}, std::size_t{7}, std::size_t{257}, std::size_t{4096}})
      expect_equal(reference, questions.ask(*caster, batch));
    const Answers mixed = shuffled.ask(*caster, 5000);
    for (std::size_t i = 0; i < order.size(); ++i) {
      ASSERT_TRUE(same(mixed.hits[i], reference.hits[order[i]]));
      ASSERT_EQ(mixed.between_points[i], reference.between_points[order[i]]);
      ASSERT_EQ(mixed.between_keys[i], reference.between_keys[order[i]]);
    }
    for (std::size_t i = 0; i < 500; ++i)
      ASSERT_TRUE(same(caster->cast(questions.rays[i], UnknownPolicy::kBlock), reference.hits[i]));
  }
}

TEST(RayCaster, SpansOfDifferentSizesThrow) {
  const auto tree = make_random_tree(1, 0.3);
  const Casters casters(*tree);
  for (const auto& [name, caster] : casters.all) {
    SCOPED_TRACE(name);
    std::vector<Hit> hits(2);
    std::vector<std::uint8_t> visible(2);
    EXPECT_REFUSED(caster->cast(std::vector<Ray>(3), hits, UnknownPolicy::kBlock));
    EXPECT_REFUSED(caster->visible(std::vector<Segment>(1), visible, UnknownPolicy::kBlock));
    EXPECT_REFUSED(caster->visible(std::vector<KeySegment>(3), visible, UnknownPolicy::kBlock));
    EXPECT_NO_THROW(caster->cast(std::span<const Ray>{}, std::span<Hit>{}, UnknownPolicy::kBlock));
    EXPECT_REFUSED(caster->update(VoxelGrid(0.123)));
  }
}

TEST(RayCaster, RaysThatAreNoneAreAnsweredNotThrown) {
  const auto tree = make_random_tree(1, 0.3);
  const Casters casters(*tree);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Eigen::Vector3f here = casters.grid.lattice().center({32768, 32768, 32768}), east(1.0F, 0.0F, 0.0F);
  const Eigen::Vector3f bad[] = {
      {nan, 0, 0}, {0, infinity, 0}, {0, 0, -infinity}, {1e30F, 0, 0}, {0, -20000.0F, 0}};
  for (const auto& [name, caster] : casters.all) {
    SCOPED_TRACE(name);
    for (const Eigen::Vector3f& point : bad)
      for (const UnknownPolicy unknown : kPolicies) {
        EXPECT_EQ(caster->cast({point, east, 10.0}, unknown).stop, RayStop::kInvalid);
        Eigen::Vector3f untouched = here;
        EXPECT_EQ(caster->cast({point, east, 10.0}, unknown, untouched), RayStop::kInvalid);
        EXPECT_EQ(untouched, here);
        const Segment segments[] = {{point, here}, {here, point}, {point, point}};
        std::uint8_t visible[] = {9, 9, 9};
        caster->visible(segments, visible, unknown);
        for (const auto v : visible) EXPECT_EQ(v, 0);
      }
  }
  // No direction: no ray, unless the origin's voxel already ends it.
  VoxelGrid grid(0.3);
  grid.fill({{32768, 32768, 32768}, 3}, Occupancy::kFree);
  grid.set({32768, 32768, 32768}, Occupancy::kOccupied);
  const Eigen::Vector3f wall = grid.lattice().center({32768, 32768, 32768}),
                        free = wall + Eigen::Vector3f(1.0F, 0, 0);
  for (const auto& caster : casters_of(grid))
    for (const Eigen::Vector3f& none : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(nan, 0, 0),
                                        Eigen::Vector3f(infinity, 1, 0), Eigen::Vector3f(1e38F, 1e38F, 0)}) {
      EXPECT_EQ(caster->cast({free, none, -1.0}, UnknownPolicy::kBlock).stop, RayStop::kInvalid);
      EXPECT_EQ(caster->cast({wall, none, -1.0}, UnknownPolicy::kBlock).stop, RayStop::kOccupied);
    }
}

TEST(RayCaster, IsChosenByHowManyRaysItIsFor) {
  const VoxelGrid grid = make_voxel_grid(*make_noise_tree(1, 0.3, 24));
  EXPECT_EQ(make_ray_caster(grid, 10)->memory_bytes(), 0U);
  EXPECT_GT(make_ray_caster(grid, 10'000'000)->memory_bytes(), make_grid_ray_caster(grid)->memory_bytes());
  EXPECT_GT(make_ray_caster(grid)->memory_bytes(), make_grid_ray_caster(grid)->memory_bytes());
}

TEST(RayCaster, EmptyAndUniformMaps) {
  for (const Occupancy state : {Occupancy::kUnknown, Occupancy::kFree, Occupancy::kOccupied}) {
    VoxelGrid grid(0.1);
    grid.fill({{}, 16}, state);
    const Questions questions(grid, 300);
    const Answers expected = questions.ask(*make_grid_ray_caster(grid), 300);
    for (const auto& caster : casters_of(grid)) expect_equal(expected, questions.ask(*caster, 300));
  }
  octomap::OcTree empty(0.1);
  const OctreeRayCaster drop_in(empty);
  octomap::point3d expected, end;
  const octomap::point3d origin(1, 2, 3), direction(1, 0.5F, 0.25F);
  for (const bool ignore_unknown : {false, true}) {
    EXPECT_EQ(drop_in.castRay(origin, direction, end, ignore_unknown, 5.0),
              empty.castRay(origin, direction, expected, ignore_unknown, 5.0));
    EXPECT_EQ(end, expected);
  }
}

// Rounding leads such a path past the voxel of its end, whatever there is that blocks.
TEST(RayCaster, MissesTheEndOfASegmentAsTheWalkDoesWithoutBlockers) {
  VoxelGrid empty(0.1), free(0.1);
  free.set(make_key(32768, 32768, 32768), Occupancy::kFree);
  for (const VoxelGrid& grid : {empty, free}) {
    auto segments = adversarial_segments(grid, 20'000, 5);
    segments.push_back({{-0x1.99999ap-5F, -0x1.99999ap-4F, 0x1.99999ap-4F}, {0, 0, 0}});
    for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass}) {
      std::vector<std::uint8_t> walked(segments.size()), seen(segments.size());
      make_grid_ray_caster(grid)->visible(segments, walked, unknown);
      for (const auto& caster : casters_of(grid)) {
        caster->visible(segments, seen, unknown);
        EXPECT_EQ(seen, walked);
      }
    }
  }
}

// A float's last digit is worth thousandths of a voxel there.
TEST(RayCaster, SegmentsAcrossAllSpaceEndAtTheirVoxel) {
  VoxelGrid grid(0.1);
  Random random(73);
  const VoxelKey target = make_key(60000, 60000, 60000);
  const KeyBox around = grown({target, target}, 3);
  for (int i = 0; i < 60; ++i) grid.set(random.key_in(around), Occupancy::kOccupied);
  std::vector<KeySegment> segments{{make_key(0, 60000, 60000), make_key(59996, 60000, 60000)}};
  for (int i = 0; i < 300; ++i) {
    const VoxelKey to = random.key_in(around);
    const int longest = 10'000 + random.below(45'000);
    const auto less = [&] { return random.one_in(4) ? 0 : longest - random.below(200); };
    segments.push_back({make_key(to.x - longest, to.y - less(), to.z - less()), to});
  }
  std::vector<std::uint8_t> walked(segments.size()), seen(segments.size());
  for (const UnknownPolicy unknown : kPolicies) {
    make_grid_ray_caster(grid)->visible(segments, walked, unknown);
    for (const auto& caster : casters_of(grid)) {
      caster->visible(segments, seen, unknown);
      EXPECT_EQ(seen, walked);
    }
    EXPECT_EQ(walked.front(), unknown == UnknownPolicy::kPass ? 1 : 0) << "its voxel is before all others";
  }
}

TEST(RayCaster, DistanceAndEntryAreThoseOfTheBlockersFace) {
  VoxelGrid grid(0.5);
  grid.fill({{32768, 32768, 32768}, 4}, Occupancy::kFree);
  grid.set({32778, 32770, 32770}, Occupancy::kOccupied);  // its lower face along x lies at 5 m
  const Eigen::Vector3f origin(1.25F, 1.25F, 1.25F);
  for (const auto& caster : casters_of(grid)) {
    const Hit straight = caster->cast({origin, {2.0F, 0, 0}, -1.0}, UnknownPolicy::kBlock);
    EXPECT_EQ(straight.stop, RayStop::kOccupied);
    EXPECT_EQ(straight.key, (VoxelKey{32778, 32770, 32770}));
    EXPECT_FLOAT_EQ(straight.distance, 3.75F);
    EXPECT_EQ(straight.entry, Eigen::Vector3f(5.0F, 1.25F, 1.25F));
    EXPECT_EQ(straight.end, Eigen::Vector3f(5.25F, 1.25F, 1.25F));
    const Hit slanted = caster->cast({origin, {3.75F, 0.1875F, 0}, -1.0}, UnknownPolicy::kBlock);
    EXPECT_EQ(slanted.key, (VoxelKey{32778, 32770, 32770}));
    EXPECT_NEAR(slanted.distance, std::hypot(3.75, 0.1875), 1e-6);
    EXPECT_NEAR((slanted.entry - Eigen::Vector3f(5.0F, 1.4375F, 1.25F)).norm(), 0.0, 1e-6);
    // The centre of the wall is 4 m away: a range of 3.9 m ends the ray in it, though its face is at 3.75 m.
    EXPECT_EQ(caster->cast({origin, {1, 0, 0}, 3.9}, UnknownPolicy::kBlock).stop, RayStop::kOutOfRange);
    EXPECT_EQ(caster->cast({origin, {1, 0, 0}, 4.0}, UnknownPolicy::kBlock).stop, RayStop::kOccupied);
  }
}

// Where a ray creeps into a wall, a bound on its error as a distance is hardly a bound on when it gets there:
// what it meets meanwhile must not lose to the wall.
TEST(RayCaster, RaysAllButParallelToAWall) {
  VoxelGrid grid(0.1);
  Random random(31);
  fill(grid, {key_at(0, 0, 3), key_at(6, 59, 7)}, Occupancy::kFree);
  fill(grid, {key_at(7, 8, 5), key_at(7, 59, 5)}, Occupancy::kOccupied);
  for (const int y : {11, 23, 24, 41}) grid.set(key_at(6, y, 5), Occupancy::kOccupied);
  std::vector<Ray> rays(100'000);
  for (Ray& ray : rays) {
    const auto tiny = [&] {
      return static_cast<float>(std::ldexp(random.uniform(-1.0, 1.0), -random.below(34)));
    };
    ray.origin = {0.7F - std::fabs(tiny()) * 0.1F, static_cast<float>(random.uniform(0.0, 1.0)), 0.55F};
    ray.direction = {std::fabs(tiny()), 1.0F, random.one_in(2) ? 0.0F : tiny()};
    ray.max_range = random.uniform(0.5, 6.0);
  }
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  for (const UnknownPolicy unknown : kPolicies) {
    make_grid_ray_caster(grid)->cast(rays, expected, unknown);
    for (const auto& caster : casters_of(grid)) {
      caster->cast(rays, hits, unknown);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(expected[i], hits[i])) << i;
    }
  }
}

TEST(RayCaster, UpdateEqualsANewCaster) {
  Random random(11);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    // The first kind spans the key range, so that no table fits; the second has a table.
    VoxelGrid grid =
        make_voxel_grid(seed % 2 == 0 ? *make_random_tree(seed, 0.3) : *make_noise_tree(seed, 0.3, 90));
    const auto updated = casters_of(grid);
    for (int round = 0; round < 12; ++round) {
      const int edits = random.below(40);
      for (int i = 0; i < edits; ++i)
        grid.fill(random.block_in(cube({32688, 32688, 32688}, 160), random.one_in(5) ? random.below(9) : 0),
                  random.state());
      const Questions questions(grid, 1000);
      const Answers expected = questions.ask(*make_grid_ray_caster(grid), 1000);
      for (const auto& caster : updated) {
        caster->update(grid);
        expect_equal(expected, questions.ask(*caster, 1000));
      }
    }
  }
}

// As when another task of the caller's group has thrown: what is half-made must not count as complete.
TEST(RayCaster, IsWholeThoughTheCallersGroupIsCancelled) {
  const auto in_cancelled_group = [](const auto& work) {
    tbb::task_group_context group;
    // Not parallel_for: the linker would take this file's copy of TBB's templates for all loops, and the
    // thread sanitizer would see in it what parallel.cpp keeps from it.
    tbb::task_group(group).run_and_wait([&] {
      group.cancel_group_execution();
      work();
    });
  };
  Random random(13);
  VoxelGrid grid = make_voxel_grid(*make_noise_tree(3, 0.3, 90));
  std::vector<std::unique_ptr<RayCaster>> casters;
  in_cancelled_group([&] {
    casters.push_back(make_ray_caster(grid));
    casters.push_back(make_embree_ray_caster(grid));
  });
  ASSERT_EQ(casters.size(), 2U);
  for (int round = 0; round < 3; ++round) {
    const Questions questions(grid, 3000);
    const Answers expected = questions.ask(*make_grid_ray_caster(grid), 1000);
    for (const auto& caster : casters) {
      std::optional<Answers> answers;
      in_cancelled_group([&] { answers = questions.ask(*caster, 1000); });
      expect_equal(expected, *answers);
    }
    for (int i = 0; i < 200; ++i)
      grid.fill(random.block_in(cube({32688, 32688, 32688}, 160), random.below(4)), random.state());
    in_cancelled_group([&] {
      for (const auto& caster : casters) caster->update(grid);
    });
  }
}

// Readers see the map before or after an update, whole, and never wait for it: where an update makes more
// than a copy of the grid, batches begin and end while it goes on.
TEST(RayCaster, QueriesGoOnDuringUpdates) {
  VoxelGrid open(0.1), closed(0.1);
  open.fill({{32768, 32768, 32768}, 8}, Occupancy::kFree);
  closed = open;
  // One wall would do; with two, updates take longer than a single core leaves to one thread.
  for (const int x : {32800, 33000})
    fill(closed, {make_key(x, 32768, 32768), make_key(x, 33023, 33023)}, Occupancy::kOccupied);
  std::vector<KeySegment> across;
  for (int y = 1; y < 63; ++y) across.push_back({key_at(2, y, 12), key_at(62, y, 22)});
  for (const auto& caster : casters_of(open)) {
    std::atomic<bool> done{false};
    std::atomic<int> moment{0};  // odd during an update
    std::atomic<int> batches{0}, opens{0}, closes{0}, mixed{0}, during{0};
    std::vector<std::thread> readers;
    for (int i = 0; i < 2; ++i)
      readers.emplace_back([&] {
        std::vector<std::uint8_t> visible(across.size());
        while (!done) {
          const int before = moment;
          caster->visible(across, visible, UnknownPolicy::kBlock);
          const bool went_on = before == moment;
          const auto seen = std::ranges::count(visible, 1);
          ++(seen == 0 ? closes : seen == std::ssize(visible) ? opens : mixed);
          // It has seen the map from before the update, so it has not waited for the next one.
          const bool was_open = before % 4 == 1;
          during += before % 2 == 1 && went_on && (seen > 0) == was_open ? 1 : 0;
          ++batches;
        }
      });
    const bool takes_long = caster->memory_bytes() > 0;
    constexpr int kMost = 500, kEnough = 5;
    int overlapped = 0;  // by batches
    for (int i = 0; i < kMost && (i < 2 * kEnough || (takes_long && overlapped < kEnough)); ++i) {
      const int before = during;
      ++moment;
      caster->update(i % 2 == 0 ? closed : open);
      ++moment;
      overlapped += during > before ? 1 : 0;
      // The last of so many began after the update.
      for (const int until = batches + 3; batches < until;) std::this_thread::yield();
    }
    done = true;
    for (auto& reader : readers) reader.join();
    EXPECT_EQ(mixed, 0);
    EXPECT_GE(opens, kEnough);
    EXPECT_GE(closes, kEnough);
    EXPECT_TRUE(!takes_long || overlapped >= kEnough) << overlapped;
  }
}

TEST(RayCaster, LeavesTheCallersFloatingPointModeAlone) {
  const auto tree = make_random_tree(1, 0.3);
  const Casters casters(*tree);
  const Questions questions(casters.grid, 1000);
  const std::uint64_t before = floating_point_control();
  for (const auto& [name, caster] : casters.all) {
    (void)questions.ask(*caster, 1000);
    EXPECT_EQ(floating_point_control(), before);
  }
}

// Rounding, flushed denormals and traps are the caller's own: castRay itself would answer otherwise, or
// raise.
TEST(RayCaster, AnswersAreThoseOfTheStandardFloatingPointModeInAnyOther) {
  const auto tree = make_random_tree(1, 0.3);
  const Casters casters(*tree);
  const Questions questions(casters.grid, 1000);
  std::fenv_t standard;
  ASSERT_EQ(std::fegetenv(&standard), 0);
  std::vector<std::fenv_t> others(3, standard);
#ifdef __x86_64__
  others[0].__mxcsr |= 0x4000;         // rounds upwards
  others[1].__mxcsr |= 0x8000 | 0x40;  // flushes denormals
  others[2].__mxcsr &= ~0x0E80U;       // traps invalid operations, divisions by zero, overflows
#else
  others[0].__fpcr |= 1U << 22;
  others[1].__fpcr |= 1U << 24;
  others[2].__fpcr |= 7U << 8;
#endif
  for (const auto& [name, caster] : casters.all)
    for (const std::size_t batch : {std::size_t{1}, std::size_t{1000}}) {
      const Answers expected = questions.ask(*caster, batch);
      for (const std::fenv_t& other : others) {
        ASSERT_EQ(std::fesetenv(&other), 0);
        const std::uint64_t before = floating_point_control();
        const Answers answers = questions.ask(*caster, batch);
        const std::uint64_t after = floating_point_control();
        ASSERT_EQ(std::fesetenv(&standard), 0);
        EXPECT_NE(before, floating_point_control()) << "it is another mode";
        EXPECT_EQ(after, before) << "the mode is the caller's";
        expect_equal(expected, answers);
      }
    }
}

TEST(RayCaster, RefusesAPolicyThatThereIsNot) {
  VoxelGrid grid(0.3);
  for (const auto& caster : casters_of(grid)) {
    EXPECT_REFUSED(caster->cast(Ray{}, static_cast<UnknownPolicy>(2)));
    Eigen::Vector3f end;
    EXPECT_REFUSED(caster->cast(Ray{}, static_cast<UnknownPolicy>(2), end));
    EXPECT_REFUSED(caster->visible(std::span<const KeySegment>(), {}, static_cast<UnknownPolicy>(7)));
  }
}

}  // namespace
}  // namespace frontlux::test
