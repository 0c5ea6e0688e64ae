// The renderer against brute force: target by target, with the field of view's own test and the grid caster.
// What is drawn is judged by its statistics over many seeds, what is kept by rendering again.

#include "engine/view/count_view.hpp"
#include "support/complaint.hpp"
#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/view_quality.hpp>

#include <tbb/task_arena.h>

#include <thread>

namespace frontlux::test {
namespace {

using Sampling = ViewQualityOptions::Sampling;
using Estimator = ViewQualityOptions::Estimator;

constexpr Sampling kSamplings[] = {Sampling::kFeasible, Sampling::kBuckets};

// A hall with pillars, in which some voxels were never seen.
struct Hall {
  static constexpr int kLength = 48, kHeight = 14;
  int low;
  VoxelGrid grid{0.3};
  std::vector<VoxelKey> targets, viewpoints;

  explicit Hall(std::uint64_t seed, int low_key = 32750) : low(low_key) {
    Random random(seed);
    for_each_key(box(), [&](const VoxelKey& k) {
      grid.set(k, random.one_in(24) ? Occupancy::kUnknown : Occupancy::kFree);
    });
    for (int i = 0; i < 14; ++i) {
      const VoxelKey at = random.key_in(box());
      fill(grid, {make_key(at.x, at.y, low), make_key(at.x, at.y, low + kHeight - 1)}, Occupancy::kOccupied);
    }
    observe();
  }

  [[nodiscard]] KeyBox box() const {
    return {make_key(low, low, low), make_key(low + kLength - 1, low + kLength - 1, low + kHeight - 1)};
  }

  // Unknown voxels are targets, and some of the free ones viewpoints.
  void observe() {
    targets.clear();
    viewpoints.clear();
    for_each_key(box(), [&](const VoxelKey& k) {
      const Occupancy state = grid.at(k);
      if (state == Occupancy::kUnknown) targets.push_back(k);
      if (state == Occupancy::kFree && (k.x + 2 * k.y + 5 * k.z) % 41 == 0) viewpoints.push_back(k);
    });
  }

  [[nodiscard]] VoxelKey middle() const {
    return make_key(low + kLength / 2, low + kLength / 2, low + kHeight / 2);
  }
};

ViewCount look_at_all(const RayCaster& caster, const Hall& hall, const VoxelKey& from,
                      const FieldOfView& view, int bins = 0) {
  return count_view(from, hall.targets, view, hall.grid.resolution(), bins, [&](const VoxelKey& to) {
    return is_visible(caster, {from, to}, UnknownPolicy::kBlock);
  });
}

ViewQualityImage render(const RayCaster& caster, const Hall& hall, std::span<const VoxelKey> viewpoints,
                        const FieldOfView& view, const ViewQualityOptions& options) {
  return render_view_quality(caster, hall.grid.lattice(), viewpoints, hall.targets, view, options);
}

void expect_equal(const ViewQualityImage& a, const ViewQualityImage& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.viewpoints()[i], b.viewpoints()[i]);
    ASSERT_EQ(a.values()[i], b.values()[i]) << i;
    ASSERT_TRUE(std::ranges::equal(a.bin_hits(i), b.bin_hits(i))) << i;
  }
}

TEST(ViewQuality, IsExactWhereAllTargetsAreTaken) {
  const FieldOfView sonar = cone(50 * kDegree, 3.3);
  for (const FieldOfView& view : {lidar(), camera(4), sonar})
    for (const int low : {0, 32750, 65536 - Hall::kLength}) {
      const Hall hall(1, low);
      const auto caster = make_grid_ray_caster(hall.grid);
      for (const Sampling sampling : kSamplings) {
        ViewQualityOptions options{
            .samples = ViewQualityOptions::kAll, .sampling = sampling, .azimuth_bins = 36};
        const auto image = render(*caster, hall, hall.viewpoints, view, options);
        options.samples = 150;
        const auto some = render(*caster, hall, hall.viewpoints, view, options);
        std::size_t seen = 0, exact = 0;
        for (std::size_t i = 0; i < image.size(); i += 7) {
          const ViewQuality& value = image.values()[i];
          const ViewCount truth = look_at_all(*caster, hall, hall.viewpoints[i], view, 36);
          if (sampling == Sampling::kFeasible) {
            ASSERT_EQ(value.population, truth.in_view);
          } else {
            ASSERT_GE(value.population, truth.in_view);
          }
          ASSERT_EQ(value.drawn, value.population);
          ASSERT_EQ(value.hits, truth.visible);
          ASSERT_EQ(value.gain, static_cast<double>(truth.visible));
          ASSERT_EQ(value.standard_error, 0.0);
          ASSERT_TRUE(std::ranges::equal(image.bin_hits(i), truth.bins));
          seen += truth.visible;
          ASSERT_EQ(some.values()[i].drawn, std::min(value.population, 150U));
          if (value.population > 150) {
            ASSERT_GT(some.values()[i].standard_error, 0.0);
          } else {
            ASSERT_EQ(some.values()[i], value);
            ++exact;
          }
        }
        EXPECT_GT(seen, 1000U);
        if (sampling == Sampling::kFeasible && view.max_range < 5) {
          EXPECT_GT(exact, 20U);
        }
      }
    }
}

TEST(ViewQuality, TargetAndViewpointDoNotBlockButWhatLiesBetweenDoes) {
  VoxelGrid grid(0.3);
  const VoxelKey from{100, 100, 100}, target{110, 100, 100}, wall{105, 100, 100};
  for (std::uint16_t x = 101; x < 110; ++x) grid.set({x, 100, 100}, Occupancy::kFree);
  const auto gain = [&] {
    return render_view_quality(*make_grid_ray_caster(grid), grid.lattice(), {{from}}, {{target}}, lidar())
        .values()[0]
        .gain;
  };
  EXPECT_EQ(gain(), 1.0);
  grid.set(target, Occupancy::kOccupied);
  grid.set(from, Occupancy::kOccupied);
  EXPECT_EQ(gain(), 1.0);
  grid.set(wall, Occupancy::kOccupied);
  EXPECT_EQ(gain(), 0.0);
  grid.set(wall, Occupancy::kUnknown);
  EXPECT_EQ(gain(), 0.0);
}

TEST(ViewQuality, PaperEstimatorCountsHits) {
  const Hall hall(2);
  const auto caster = make_grid_ray_caster(hall.grid);
  const auto unbiased = render(*caster, hall, hall.viewpoints, lidar(), {.samples = 50});
  const auto paper =
      render(*caster, hall, hall.viewpoints, lidar(), {.samples = 50, .estimator = Estimator::kPaper});
  bool differs = false;
  for (std::size_t i = 0; i < paper.size(); ++i) {
    const ViewQuality &p = paper.values()[i], &u = unbiased.values()[i];
    ASSERT_EQ(p.hits, u.hits);
    ASSERT_EQ(p.gain, p.hits);
    ASSERT_DOUBLE_EQ(u.gain, static_cast<double>(u.hits) * u.population / std::max(u.drawn, 1U));
    ASSERT_NEAR(p.standard_error * u.population, u.standard_error * u.drawn, 1e-9);
    differs = differs || p.gain != u.gain;
  }
  EXPECT_TRUE(differs);
}

// The errors of many seeds, each with the standard error of its estimate.
struct Errors {
  std::vector<double> errors, predicted;
  [[nodiscard]] double mean() const {
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  }
  [[nodiscard]] double root_mean_square(const std::vector<double>& values) const {
    const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
    return std::sqrt(sum / static_cast<double>(values.size()));
  }
};

Errors errors_of(const RayCaster& caster, const Hall& hall, const VoxelKey& viewpoint, Sampling sampling,
                 int samples, int seeds) {
  Errors result;
  const auto truth = static_cast<double>(look_at_all(caster, hall, viewpoint, lidar()).visible);
  for (int seed = 0; seed < seeds; ++seed) {
    const ViewQualityOptions options{
        .samples = samples, .sampling = sampling, .seed = static_cast<std::uint64_t>(seed)};
    const auto image = render(caster, hall, {&viewpoint, 1}, lidar(), options);
    result.errors.push_back(image.values()[0].gain - truth);
    result.predicted.push_back(image.values()[0].standard_error);
  }
  return result;
}

TEST(ViewQuality, UnbiasedEstimatorIsUnbiasedAndItsErrorIsHonest) {
  const Hall hall(3);
  const auto caster = make_ray_caster(hall.grid);
  const VoxelKey m = hall.middle();
  for (const Sampling sampling : kSamplings)
    for (const int shift : {-9, 0, 7}) {
      const VoxelKey viewpoint = make_key(m.x + shift, m.y - shift / 2, m.z);
      ASSERT_GT(look_at_all(*caster, hall, viewpoint, lidar()).in_view, 300U);
      const Errors e = errors_of(*caster, hall, viewpoint, sampling, 64, 1000);
      const double spread = e.root_mean_square(e.errors);
      EXPECT_GT(spread, 1.0);
      EXPECT_LT(std::fabs(e.mean()), 3 * spread / std::sqrt(1000.0)) << e.mean() << " of " << spread;
      EXPECT_NEAR(e.root_mean_square(e.predicted) / spread, 1.0, 0.15);
      const auto covered = [&](double deviations) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < e.errors.size(); ++i)
          count += std::fabs(e.errors[i]) <= deviations * e.predicted[i] ? 1 : 0;
        return static_cast<double>(count) / static_cast<double>(e.errors.size());
      };
      EXPECT_NEAR(covered(1.0), 0.683, 0.08);
      EXPECT_NEAR(covered(2.0), 0.954, 0.035);
    }
}

TEST(ViewQuality, ErrorFallsWithTheRootOfTheSamples) {
  const Hall hall(4);
  const auto caster = make_ray_caster(hall.grid);
  const VoxelKey viewpoint = hall.middle();
  for (const Sampling sampling : kSamplings) {
    std::vector<double> spread;
    const double population =
        render(*caster, hall, {&viewpoint, 1}, lidar(), {.sampling = sampling}).values()[0].population;
    for (const int samples : {16, 64, 256}) {
      ASSERT_GT(population, samples);
      const Errors e = errors_of(*caster, hall, viewpoint, sampling, samples, 1000);
      // Beside the root there is the correction for drawing from few without replacement.
      spread.push_back(e.root_mean_square(e.errors) / std::sqrt((population - samples) / (population - 1)));
    }
    EXPECT_NEAR(spread[0] / spread[1], 2.0, 0.25);
    EXPECT_NEAR(spread[1] / spread[2], 2.0, 0.25);
  }
}

TEST(ViewQuality, SameOnAnyThreadsCastersAndOrder) {
  const Hall hall(5);
  const auto fast = make_ray_caster(hall.grid);
  const auto grid = make_grid_ray_caster(hall.grid);
  for (const Sampling sampling : kSamplings) {
    const ViewQualityOptions options{.sampling = sampling, .azimuth_bins = 8};
    const auto image = render(*fast, hall, hall.viewpoints, camera(4), options);
    for (const int threads : {1, 2})
      tbb::task_arena(threads).execute(
          [&] { expect_equal(image, render(*fast, hall, hall.viewpoints, camera(4), options)); });
    expect_equal(image, render(*grid, hall, hall.viewpoints, camera(4), options));

    std::vector<std::size_t> order(hall.viewpoints.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Hall shuffled = hall;
    Random random(1);
    random.shuffle(order);
    for (std::size_t i = 0; i < order.size(); ++i) shuffled.viewpoints[i] = hall.viewpoints[order[i]];
    shuffled.viewpoints.push_back(shuffled.viewpoints.front());
    std::reverse(shuffled.targets.begin(), shuffled.targets.end());
    shuffled.targets.push_back(shuffled.targets.front());
    const auto other = render(*fast, shuffled, shuffled.viewpoints, camera(4), options);
    for (std::size_t i = 0; i < order.size(); ++i) {
      ASSERT_EQ(other.values()[i], image.values()[order[i]]);
      ASSERT_TRUE(std::ranges::equal(other.bin_hits(i), image.bin_hits(order[i])));
    }
    ASSERT_EQ(other.values().back(), other.values().front());

    ViewQualityOptions reseeded = options;
    reseeded.seed = 2;
    const auto redrawn = render(*fast, hall, hall.viewpoints, camera(4), reseeded);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
      differing += redrawn.values()[i] == image.values()[i] ? 0 : 1;
    EXPECT_GT(differing, image.size() / 4);
  }
}

TEST(ViewQuality, NothingToSeeOrNowhereToStandIsNoError) {
  const Hall hall(6);
  const auto caster = make_grid_ray_caster(hall.grid);
  const auto image =
      render_view_quality(*caster, hall.grid.lattice(), hall.viewpoints, {}, lidar(), {.azimuth_bins = 4});
  ASSERT_EQ(image.size(), hall.viewpoints.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_EQ(image.values()[i], ViewQuality{});
    ASSERT_TRUE(std::ranges::equal(image.bin_hits(i), std::vector<std::uint32_t>(4)));
  }
  EXPECT_EQ(render(*caster, hall, {}, lidar(), {}).size(), 0U);
  // A viewpoint does not see the target that it stands in.
  EXPECT_EQ(render_view_quality(*caster, hall.grid.lattice(), {{hall.middle()}}, {{hall.middle()}}, lidar())
                .values()[0],
            ViewQuality{});
}

TEST(ViewQuality, NamesTheValueThatIsWrong) {
  const auto refuses = [](const FieldOfView& view, const ViewQualityOptions& options, const std::string& part,
                          double resolution = 0.3) {
    expect_complaint([&] { const ViewQualityImage image(Lattice(resolution), view, options); }, {part});
  };
  refuses(lidar(), {.samples = 0}, "samples is 0");
  refuses(lidar(), {.samples = -5}, "samples is -5");
  refuses(lidar(), {.azimuth_bins = -1}, "azimuth_bins is -1");
  refuses(lidar(), {.azimuth_bins = 3601}, "azimuth_bins is 3601");
  refuses(lidar(), {.sampling = static_cast<Sampling>(9)}, "sampling is 9");
  refuses(lidar(), {.estimator = static_cast<Estimator>(9)}, "estimator is 9");
  refuses(lidar(), {.sampling = Sampling::kBuckets, .estimator = Estimator::kPaper}, "kFeasible");
  refuses(lidar(-1), {}, "max_range is -1");
  refuses(lidar(4000), {}, "max_range is 4000");
  refuses(lidar(1e300), {}, "out of the numbers' range");
  refuses(lidar(), {}, "resolution", 1e-200);
  EXPECT_NO_THROW(ViewQualityImage(Lattice(0.3), lidar(), {}));
}

TEST(ViewQuality, RefusesACasterOfOtherVoxels) {
  ViewQualityImage image(Lattice(0.3), lidar(), {});
  const std::array keys{key_at(1, 1, 1)};
  expect_complaint([&] { image.render(*make_grid_ray_caster(VoxelGrid(0.1)), keys, keys); }, {"0.3", "0.1"});
  EXPECT_EQ(image.size(), 0U);
  const auto caster = make_grid_ray_caster(VoxelGrid(0.3));
  image.render(*caster, keys, keys);
  expect_complaint([&] { image.update(*caster, keys, keys, {VoxelGrid(0.1), keys}); }, {"0.3", "0.1"});
}

TEST(ViewQualityImage, OfEqualViewpointsTheFirstIsTheBest) {
  VoxelGrid grid(0.3);
  fill(grid, {key_at(0, 0, 0), key_at(8, 0, 0)}, Occupancy::kFree);
  const auto best = [&](const std::vector<VoxelKey>& viewpoints) {
    return render_view_quality(*make_grid_ray_caster(grid), grid.lattice(), viewpoints, {{key_at(4, 0, 0)}},
                               lidar())
        .best();
  };
  const VoxelKey left = key_at(1, 0, 0), right = key_at(7, 0, 0), hidden = key_at(4, 5, 0);
  EXPECT_EQ(best({left, right}), 0U);
  EXPECT_EQ(best({right, left}), 0U);
  EXPECT_EQ(best({hidden, right, left}), 1U);
  EXPECT_EQ(best({hidden, key_at(4, -5, 0)}), 0U);
}

// Edits of all kinds, reported as the voxels that changed or also some that did not; each time the image has
// to be what rendering makes.
TEST(ViewQualityImage, AfterUpdatesEqualsRenderingAgain) {
  for (const Sampling sampling : kSamplings)
    for (const bool exactly : {false, true}) {
      Hall hall(7);
      Random random(exactly ? 8 : 9);
      const auto caster = make_ray_caster(hall.grid);
      const ViewQualityOptions options{.samples = 24, .sampling = sampling, .azimuth_bins = 12};
      ViewQualityImage image(hall.grid.lattice(), camera(4), options);
      image.render(*caster, hall.viewpoints, hall.targets);
      std::size_t rendered = 0, all = 0;
      for (int step = 0; step < 25; ++step) {
        const VoxelGrid before = hall.grid;
        std::vector<VoxelKey> changed;
        const int x = random.below(Hall::kLength), y = random.below(Hall::kLength);
        const int edits = random.one_in(5) ? 0 : 1 + random.below(6);
        for (int e = 0; e < edits; ++e) {
          const auto near = [&](int i) {
            return hall.low + std::clamp(i + random.below(5) - 2, 0, Hall::kLength - 1);
          };
          const VoxelKey k = make_key(near(x), near(y), hall.low + random.below(Hall::kHeight));
          hall.grid.set(k, random.state());
          changed.push_back(k);
        }
        std::sort(changed.begin(), changed.end());
        if (exactly) changed = changed_keys(before, hall.grid);
        hall.observe();
        // Targets and viewpoints come and go for other reasons than the map as well.
        if (random.one_in(3)) hall.targets.erase(hall.targets.begin() + random.below(300));
        if (random.one_in(3)) std::reverse(hall.viewpoints.begin(), hall.viewpoints.end());
        if (random.one_in(4)) hall.viewpoints.resize(hall.viewpoints.size() * 3 / 4);
        caster->update(hall.grid);
        rendered += image.update(*caster, hall.viewpoints, hall.targets, {hall.grid, changed});
        all += hall.viewpoints.size();
        expect_equal(image, render(*caster, hall, hall.viewpoints, camera(4), options));
        if (HasFatalFailure()) return;
      }
      EXPECT_GT(rendered, all / 50);
      EXPECT_LT(rendered, all * 3 / 4) << "of " << all;
      EXPECT_EQ(image.update(*caster, hall.viewpoints, hall.targets, {hall.grid}), 0U);
    }
}

// Copies of an image, each updated by a thread of its own, while the caster is updated to maps that do not
// differ.
TEST(ViewQualityImage, CopiesAreUpdatedInDifferentThreads) {
  for (const auto renderer : {ViewQualityOptions::Renderer::kRays, ViewQualityOptions::Renderer::kExact}) {
    Hall hall(12);
    const auto caster = make_ray_caster(hall.grid);
    const ViewQualityOptions options{.renderer = renderer, .azimuth_bins = 8};
    const auto image = render(*caster, hall, hall.viewpoints, camera(4), options);
    const VoxelKey changed = hall.middle();
    hall.grid.set(changed, Occupancy::kOccupied);
    hall.observe();
    caster->update(hall.grid);
    const auto updated = [&](ViewQualityImage copy) {
      (void)copy.update(*caster, hall.viewpoints, hall.targets, {hall.grid, {&changed, 1}});
      return copy;
    };
    const auto expected = updated(image);
    std::vector<ViewQualityImage> images(3, image);
    std::vector<std::thread> threads;
    for (ViewQualityImage& copy : images) threads.emplace_back([&] { copy = updated(std::move(copy)); });
    for (int i = 0; i < 5; ++i) caster->update(VoxelGrid(hall.grid));
    for (std::thread& thread : threads) thread.join();
    for (const ViewQualityImage& copy : images) expect_equal(copy, expected);
  }
}

TEST(ViewQualityImage, TakesItsOwnViewpointsBack) {
  const Hall hall(10);
  const auto caster = make_grid_ray_caster(hall.grid);
  auto image = render(*caster, hall, hall.viewpoints, camera(4), {.azimuth_bins = 4});
  const auto whole = image;
  const std::size_t half = image.size() / 2;
  EXPECT_EQ(image.update(*caster, image.viewpoints().subspan(half), hall.targets, {hall.grid}), 0U);
  ASSERT_EQ(image.size(), whole.size() - half);
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_EQ(image.values()[i], whole.values()[i + half]);
    ASSERT_TRUE(std::ranges::equal(image.bin_hits(i), whole.bin_hits(i + half)));
  }
  image.render(*caster, image.viewpoints().first(3), hall.targets);
  EXPECT_EQ(image.size(), 3U);
  EXPECT_EQ(image.values()[1], whole.values()[half + 1]);
}

}  // namespace
}  // namespace frontlux::test
