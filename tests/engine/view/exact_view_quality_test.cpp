// The exact renderer against brute force: target by target, with the field of view's own test and the walk
// over the grid. Then against itself: on every instruction set, on other threads, kept and from scratch.

#include "engine/view/count_view.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"
#include "view/exact/exact_render.hpp"
#include "walk/walk.hpp"

#include <frontlux/view_quality.hpp>

#include <tbb/task_arena.h>

namespace frontlux::test {
namespace {

using Renderer = ViewQualityOptions::Renderer;
using Sampling = ViewQualityOptions::Sampling;
using Shape = FieldOfView::Shape;

constexpr double kResolution = 0.25;

struct Case {
  std::string name;
  VoxelGrid grid{kResolution};
  FieldOfView view;
  std::vector<VoxelKey> viewpoints, targets;
};

FieldOfView random_view(Random& random) {
  const auto angle = [&] { return random.uniform(10, 170) * kDegree; };
  return {static_cast<Shape>(random.below(3)), angle(), angle(), random.uniform(0.3, 8.5) * kResolution};
}

// A box of noise somewhere in the key range, its borders included, with viewpoints and targets of all kinds
// in and around it.
Case random_case(std::uint64_t seed) {
  Random random(seed);
  Case some;
  some.name = "seed " + std::to_string(seed);
  some.view = random_view(random);
  std::array<int, 3> low{}, size{};
  for (std::size_t a = 0; a < 3; ++a) {
    size[a] = 1 + random.below(a == 2 ? 9 : 44);
    const int places[] = {0, Lattice::kKeysPerAxis - size[a], 32768 - size[a] / 2, 40000 + random.below(64)};
    low[a] = places[random.below(4)];
  }
  const int blocked_one_in = 1 + random.below(12);
  const int stride[] = {1, 2, 3, 4, 8};
  const int sx = stride[random.below(5)], sy = stride[random.below(5)], sz = stride[random.below(3)];
  const int one_in = 1 + random.below(6), targets_one_in = 1 + random.below(20);
  const bool any_target = random.one_in(3);  // also free and occupied ones
  const VoxelKey corner = make_key(low[0], low[1], low[2]);
  for_each_key({corner, make_key(low[0] + size[0] - 1, low[1] + size[1] - 1, low[2] + size[2] - 1)},
               [&](const VoxelKey& k) {
                 const Occupancy state = !random.one_in(blocked_one_in) ? Occupancy::kFree
                                         : random.one_in(2)             ? Occupancy::kOccupied
                                                                        : Occupancy::kUnknown;
                 some.grid.set(k, state);
                 const bool on_stride =
                     (k.x - low[0]) % sx == 0 && (k.y - low[1]) % sy == 0 && (k.z - low[2]) % sz == 0;
                 if (on_stride && random.one_in(one_in)) some.viewpoints.push_back(k);
                 if ((any_target || state == Occupancy::kUnknown) && random.one_in(targets_one_in))
                   some.targets.push_back(k);
               });
  for (std::size_t i = 0; i < some.viewpoints.size(); i += 7) some.viewpoints.push_back(some.viewpoints[i]);
  for (std::size_t i = 0; i < some.targets.size(); i += 5) some.targets.push_back(some.targets[i]);
  random.shuffle(some.viewpoints);
  random.shuffle(some.targets);
  return some;
}

struct Truth {
  std::vector<ViewQuality> values;
  std::vector<std::uint32_t> bins;
};

Truth brute_force(const Case& some, int bins) {
  Truth truth;
  std::vector<VoxelKey> targets = some.targets;
  sort(targets);
  for (const VoxelKey& from : some.viewpoints) {
    const ViewCount count = count_view(from, targets, some.view, kResolution, bins, [&](const VoxelKey& to) {
      return detail::walk_visible(some.grid, KeySegment{from, to}, UnknownPolicy::kBlock);
    });
    truth.bins.insert(truth.bins.end(), count.bins.begin(), count.bins.end());
    ViewQuality value;
    value.population = value.drawn = count.in_view;
    value.hits = count.visible;
    value.gain = count.visible;
    truth.values.push_back(value);
  }
  return truth;
}

std::vector<detail::StaleViewpoint> all_stale(std::span<const VoxelKey> viewpoints) {
  std::vector<detail::StaleViewpoint> stale;
  for (const detail::Viewpoint& v : detail::sort_viewpoints(viewpoints)) stale.push_back({v.code, v.index});
  return stale;
}

// By walks alone, however few the viewpoints. Tiles with that many are walked as a whole.
Truth walk_all(const Case& some, int bins, const detail::TrieWalk& walk, std::size_t whole = 128) {
  const ViewRegion view(some.view, kResolution);
  const detail::TargetIndex targets(some.targets);
  detail::RayTries tries;
  Truth mine;
  mine.values.resize(some.viewpoints.size());
  mine.bins.resize(some.viewpoints.size() * static_cast<std::size_t>(bins));
  const auto left = detail::render_exactly({some.grid, view, targets, walk, tries, bins, {1, 1, whole, 1}},
                                           all_stale(some.viewpoints), mine.values, mine.bins);
  EXPECT_EQ(left.size(), 0U);
  return mine;
}

ViewQualityOptions exact(int bins) { return {.renderer = Renderer::kExact, .azimuth_bins = bins}; }

void expect_equal(const Truth& mine, const Truth& truth) {
  ASSERT_EQ(mine.values.size(), truth.values.size());
  for (std::size_t i = 0; i < truth.values.size(); ++i)
    ASSERT_EQ(mine.values[i], truth.values[i])
        << i << ": " << mine.values[i].hits << " of " << mine.values[i].population << ", not "
        << truth.values[i].hits << " of " << truth.values[i].population;
  ASSERT_EQ(mine.bins, truth.bins);
}

Truth truth_of(const ViewQualityImage& image) {
  Truth truth{{image.values().begin(), image.values().end()}, {}};
  for (std::size_t i = 0; i < image.size(); ++i)
    truth.bins.insert(truth.bins.end(), image.bin_hits(i).begin(), image.bin_hits(i).end());
  return truth;
}

void expect_equal(const ViewQualityImage& image, const Truth& truth) { expect_equal(truth_of(image), truth); }

void expect_equal(const ViewQualityImage& a, const ViewQualityImage& b) {
  ASSERT_TRUE(std::ranges::equal(a.viewpoints(), b.viewpoints()));
  expect_equal(truth_of(a), truth_of(b));
}

TEST(ExactViewQuality, IsBruteForcesOnRandomMaps) {
  std::uint64_t seen = 0, hidden = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Case some = random_case(seed);
    SCOPED_TRACE(some.name);
    const int bins = std::array{0, 1, 7, 36}[seed % 4];
    const Truth truth = brute_force(some, bins);
    const auto caster = make_grid_ray_caster(some.grid);
    const auto image = render_view_quality(*caster, some.grid.lattice(), some.viewpoints, some.targets,
                                           some.view, exact(bins));
    expect_equal(image, truth);
    for (const std::size_t whole : {1U, 40U, 1000U})
      expect_equal(walk_all(some, bins, detail::trie_walks().front(), whole), truth);
    if (HasFatalFailure()) return;
    for (const ViewQuality& value : truth.values) {
      seen += value.hits;
      hidden += value.population - value.hits;
    }
  }
  EXPECT_GT(seen, 100'000U);
  EXPECT_GT(hidden, 100'000U);
}

TEST(ExactViewQuality, IsTheSameOnEveryInstructionSet) {
  ASSERT_FALSE(detail::trie_walks().empty());
  EXPECT_EQ(detail::trie_walks().back().needs, detail::InstructionSet::kNone);
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    const Case some = random_case(seed);
    const int bins = seed % 2 == 0 ? 0 : 12;
    const Truth truth = brute_force(some, bins);
    for (const detail::TrieWalk& walk : detail::trie_walks()) {
      SCOPED_TRACE(some.name + ", instructions " + name_of(walk.needs));
      for (const std::size_t whole : {1U, 40U, 1000U}) expect_equal(walk_all(some, bins, walk, whole), truth);
      if (HasFatalFailure()) return;
    }
  }
}

// Whatever the thresholds: what walks leave are whole sectors, and rays count those.
TEST(ExactViewQuality, IsTheSameFromWalksAndRaysTogether) {
  std::size_t left_with_sectors = 0, walked = 0;
  for (std::uint64_t seed = 300; seed < 340; ++seed) {
    const Case some = random_case(seed);
    SCOPED_TRACE(some.name);
    const int bins = std::array{1, 7, 36, 100}[seed % 4];
    const ViewRegion view(some.view, kResolution);
    const detail::AzimuthBins azimuth_bins(view, bins);
    const detail::TargetIndex targets(some.targets);
    detail::RayTries tries;
    Truth mine;
    mine.values.resize(some.viewpoints.size());
    mine.bins.resize(some.viewpoints.size() * static_cast<std::size_t>(bins));
    auto stale = all_stale(some.viewpoints);
    Random random(seed);
    for (std::size_t i = 0; i < stale.size(); i += 2) {
      stale[i].sectors = {};
      for (int bin = 0; bin < bins; ++bin)
        if (random.one_in(3)) stale[i].sectors |= detail::SectorSet::of(bin, bins);
    }
    // What is not stale has been counted before.
    const Truth truth = brute_force(some, bins);
    mine.bins = truth.bins;
    for (const detail::StaleViewpoint& v : stale)
      v.sectors.clear(std::span(mine.bins).subspan(v.index * static_cast<std::size_t>(bins),
                                                   static_cast<std::size_t>(bins)));
    const auto& walk = detail::trie_walks().front();
    const auto left = detail::render_exactly({some.grid, view, targets, walk, tries, bins, {5, 3, 30, 1}},
                                             stale, mine.values, mine.bins);
    for (const auto& viewpoint : left) left_with_sectors += viewpoint.in_view ? 1 : 0;
    walked += stale.size() - left.size();
    const auto caster = make_grid_ray_caster(some.grid);
    ViewQualityOptions options = exact(bins);
    options.samples = ViewQualityOptions::kAll;
    detail::render_views({*caster, view, azimuth_bins, targets, options}, left, mine.values, mine.bins);
    expect_equal(mine, truth);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(left_with_sectors, 100U);
  EXPECT_GT(walked, 100U);
}

TEST(ExactViewQuality, IsWhatRaysToAllTargetsSay) {
  for (std::uint64_t seed = 200; seed < 220; ++seed) {
    Case some = random_case(seed);
    some.view.max_range = 15 * kResolution;
    SCOPED_TRACE(some.name);
    for (const auto& caster : {make_grid_ray_caster(some.grid), make_ray_caster(some.grid)}) {
      ViewQualityOptions options = exact(36);
      // What is drawn, and how, means nothing.
      options.samples = 0;
      options.sampling = Sampling::kBuckets;
      options.estimator = ViewQualityOptions::Estimator::kPaper;
      const auto render = [&] {
        return render_view_quality(*caster, some.grid.lattice(), some.viewpoints, some.targets, some.view,
                                   options);
      };
      const auto image = render();
      EXPECT_EQ(image.options().samples, 0);
      options.renderer = Renderer::kRays;
      options.estimator = ViewQualityOptions::Estimator::kUnbiased;
      options.sampling = Sampling::kFeasible;
      options.samples = ViewQualityOptions::kAll;
      expect_equal(image, render());
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ExactViewQuality, SeesFromCornerToCornerOfTheKeyRange) {
  VoxelGrid grid(kResolution);
  grid.fill({{0, 0, 0}, 16}, Occupancy::kFree);
  std::vector<VoxelKey> corners, neighbours;
  for (const VoxelKey& corner : {VoxelKey{0, 0, 0},
                                 {0, 0, 65535},
                                 {0, 65535, 0},
                                 {0, 65535, 65535},
                                 {65535, 0, 0},
                                 {65535, 0, 65535},
                                 {65535, 65535, 0},
                                 {65535, 65535, 65535}}) {
    corners.push_back(corner);
    neighbours.push_back(make_key(corner.x == 0 ? 4 : 65531, corner.y == 0 ? 3 : 65532, corner.z));
  }
  Case some{"corners", grid, {Shape::kSpinning, 0, 80 * kDegree, 6 * kResolution}, corners, neighbours};
  const auto caster = make_grid_ray_caster(grid);
  const auto image = render_view_quality(*caster, grid.lattice(), corners, neighbours, some.view, exact(8));
  const Truth truth = brute_force(some, 8);
  expect_equal(image, truth);
  expect_equal(walk_all(some, 8, detail::trie_walks().front()), truth);
  for (const ViewQuality& value : image.values()) EXPECT_EQ(value.hits, 1U);
}

TEST(ExactViewQuality, OfNothingIsNothing) {
  const Case some = random_case(7);
  const auto caster = make_grid_ray_caster(some.grid);
  const Lattice& lattice = some.grid.lattice();
  EXPECT_EQ(render_view_quality(*caster, lattice, {}, some.targets, some.view, exact(4)).size(), 0U);
  const auto blind = render_view_quality(*caster, lattice, some.viewpoints, {}, some.view, exact(4));
  ASSERT_EQ(blind.size(), some.viewpoints.size());
  for (std::size_t i = 0; i < blind.size(); ++i) {
    EXPECT_EQ(blind.values()[i], ViewQuality{});
    EXPECT_EQ(std::ranges::count(blind.bin_hits(i), 0U), 4);
  }
  // A range below one voxel sees nothing.
  FieldOfView narrow = some.view;
  narrow.max_range = 0.9 * kResolution;
  const auto near = render_view_quality(*caster, lattice, some.viewpoints, some.targets, narrow, exact(0));
  for (const ViewQuality& value : near.values()) EXPECT_EQ(value, ViewQuality{});
  const VoxelGrid unknown(kResolution);
  const auto dark = render_view_quality(*make_grid_ray_caster(unknown), lattice, some.viewpoints,
                                        some.targets, some.view, exact(4));
  const Case in_the_dark{"", unknown, some.view, some.viewpoints, some.targets};
  expect_equal(dark, brute_force(in_the_dark, 4));
  expect_equal(walk_all(in_the_dark, 4, detail::trie_walks().front()), brute_force(in_the_dark, 4));
  expect_equal(walk_all({"", unknown, some.view, {}, some.targets}, 4, detail::trie_walks().front()), {});
  expect_equal(walk_all({"", some.grid, some.view, some.viewpoints, {}}, 4, detail::trie_walks().front()),
               brute_force({"", some.grid, some.view, some.viewpoints, {}}, 4));
}

// A hall with pillars and some voxels that were never seen, large enough for walks.
Case hall(std::uint64_t seed, int stride) {
  Random random(seed);
  Case some{
      "hall", VoxelGrid(kResolution), {Shape::kPyramid, 90 * kDegree, 72 * kDegree, 7 * kResolution}, {}, {}};
  for_each_key({{32700, 32740, 32768}, {32795, 32819, 32777}}, [&](const VoxelKey& k) {
    const int x = k.x - 32700, y = k.y - 32740, z = k.z - 32768;
    const bool pillar = (x / 3 + 5 * (y / 4)) % 11 == 0;
    const bool unseen = !pillar && random.one_in(20);
    some.grid.set(k, pillar ? Occupancy::kOccupied : unseen ? Occupancy::kUnknown : Occupancy::kFree);
    if (unseen) some.targets.push_back(k);
    if (!pillar && !unseen && x % stride == 0 && y % stride == 0 && z % stride == 0)
      some.viewpoints.push_back(k);
  });
  return some;
}

// Edits of a map: voxels of all states, targets that come and go, viewpoints likewise.
TEST(ExactViewQuality, AfterUpdatesEqualsRenderingAgain) {
  for (const int bins : {0, 1, 36, 100}) {
    Case some = hall(3, bins == 0 ? 1 : 2);
    ASSERT_GT(some.viewpoints.size(), 4000U);
    Random random(5);
    const auto caster = make_ray_caster(some.grid);
    ViewQualityImage updated(some.grid.lattice(), some.view, exact(bins));
    updated.render(*caster, some.viewpoints, some.targets);
    const ViewQualityOptions by_rays{.samples = ViewQualityOptions::kAll, .azimuth_bins = bins};
    ViewQualityImage rays(some.grid.lattice(), some.view, by_rays);
    rays.render(*caster, some.viewpoints, some.targets);
    std::size_t rendered = 0, all = 0;
    for (int step = 0; step < 16; ++step) {
      const VoxelGrid before = some.grid;
      const VoxelKey near = random.pick(some.viewpoints);
      for (int i = random.below(40); i > 0; --i) {
        const auto off = [&] { return random.below(7) - 3; };
        const VoxelKey k = *offset_key(near, off(), off(), off());
        some.grid.set(k, random.state());
        if (random.one_in(2)) some.targets.push_back(k);
      }
      if (random.one_in(3)) some.targets.erase(some.targets.begin() + random.below(9));
      if (random.one_in(3)) some.viewpoints.erase(some.viewpoints.begin() + random.below(9));
      if (random.one_in(3)) some.viewpoints.push_back(make_key(near.x ^ 1, near.y, near.z));
      const std::vector<VoxelKey> changed = changed_keys(before, some.grid);
      caster->update(some.grid);
      rendered += updated.update(*caster, some.viewpoints, some.targets, {some.grid, changed});
      rays.update(*caster, some.viewpoints, some.targets, {some.grid, changed});
      all += some.viewpoints.size();
      const auto render = [&](const ViewQualityOptions& options) {
        return render_view_quality(*caster, some.grid.lattice(), some.viewpoints, some.targets, some.view,
                                   options);
      };
      expect_equal(updated, render(exact(bins)));
      const ViewQualityImage again = render(by_rays);
      expect_equal(updated, again);
      expect_equal(rays, again);
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(rendered, 0U);
    EXPECT_LT(rendered, all / 2);
  }
}

TEST(ExactViewQuality, DoesNotDependOnThreads) {
  for (const int stride : {1, 2}) {
    const Case some = hall(4, stride);
    const auto caster = make_grid_ray_caster(some.grid);
    const auto render = [&](int threads) {
      return tbb::task_arena(threads).execute([&] {
        return render_view_quality(*caster, some.grid.lattice(), some.viewpoints, some.targets, some.view,
                                   exact(36));
      });
    };
    expect_equal(render(1), render(2));
  }
}

TEST(ExactViewQuality, LeavesFewOrLoneViewpointsToRays) {
  Case some = hall(5, 2);
  const VoxelKey alone{32700, 32740, 40000};
  some.viewpoints.push_back(alone);
  const ViewRegion view(some.view, kResolution);
  const detail::TargetIndex targets(some.targets);
  detail::RayTries tries;
  const auto& walk = detail::trie_walks().front();
  std::vector<ViewQuality> values(some.viewpoints.size());
  const auto all = all_stale(some.viewpoints);
  const auto few = std::span(all).first(1000);
  EXPECT_EQ(detail::render_exactly({some.grid, view, targets, walk, tries, 0}, few, values, {}).size(),
            1000U);
  const auto left = detail::render_exactly({some.grid, view, targets, walk, tries, 0}, all, values, {});
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(detail::cell_of_code(left.front().code), alone);
  // Now that there is a trie, few are enough.
  EXPECT_LT(detail::render_exactly({some.grid, view, targets, walk, tries, 0}, few, values, {}).size(),
            1000U);
}

TEST(ExactViewQuality, FallsBackOnRaysWhereTheTrieWouldBeTooLarge) {
  VoxelGrid grid(kResolution);
  grid.fill({{32768, 32768, 32768}, 6}, Occupancy::kFree);
  const std::vector<VoxelKey> viewpoints{{32770, 32770, 32770}, {32772, 32770, 32770}};
  const std::vector<VoxelKey> targets{{32800, 32810, 32780}, {32780, 32767, 32770}};
  const Case some{"far", grid, {Shape::kSpinning, 0, 100 * kDegree, 80 * kResolution}, viewpoints, targets};
  const ViewRegion region(some.view, kResolution);
  EXPECT_FALSE(detail::RayTrie::make(region, 6, 1, 1));
  // Even if a walk over a trie paid for each viewpoint.
  const detail::TargetIndex index(targets);
  detail::RayTries tries;
  std::vector<ViewQuality> values(viewpoints.size());
  std::vector<std::uint32_t> bin_hits(6 * viewpoints.size());
  const auto left =
      detail::render_exactly({grid, region, index, detail::trie_walks().front(), tries, 6, {1, 1, 128, 1}},
                             all_stale(viewpoints), values, bin_hits);
  EXPECT_EQ(left.size(), viewpoints.size());
  const auto caster = make_grid_ray_caster(grid);
  const auto image = render_view_quality(*caster, grid.lattice(), viewpoints, targets, some.view, exact(6));
  expect_equal(image, brute_force(some, 6));
}

TEST(ExactViewQuality, RefusesARendererThatIsNone) {
  ViewQualityOptions options;
  options.renderer = static_cast<Renderer>(2);
  EXPECT_REFUSED(options.check());
  EXPECT_REFUSED(ViewQualityImage(Lattice(kResolution), random_case(0).view, options));
  EXPECT_REFUSED(ViewQualityImage(Lattice(kResolution), {Shape::kSpinning, 0, 1, NAN}, exact(0)));
  EXPECT_REFUSED(ViewQualityImage(Lattice(kResolution), random_case(0).view, exact(-1)));
}

}  // namespace
}  // namespace frontlux::test
