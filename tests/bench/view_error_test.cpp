// The errors of drawn view quality against sums that are written out anew, in a small room with a wall.

#include "support/complaint.hpp"
#include "support/voxel_keys.hpp"
#include "view_error/error.hpp"

#include <frontlux/ray_caster.hpp>

namespace frontlux::bench {
namespace {

using Renderer = ViewQualityOptions::Renderer;

constexpr double kResolution = 0.5, kTurn = 2.0 * std::numbers::pi;
constexpr int kSize = 16;

using test::key_at;

struct Room {
  VoxelGrid grid{kResolution};
  std::vector<VoxelKey> viewpoints, targets;
  FieldOfView view{FieldOfView::Shape::kPyramid, kTurn / 4, kTurn / 5, 4.0};

  Room() {
    for_each_key({key_at(0, 0, 0), key_at(kSize - 1, kSize - 1, 5)}, [&](const VoxelKey& key) {
      const int x = key.x - Lattice::kOrigin, y = key.y - Lattice::kOrigin, z = key.z - Lattice::kOrigin;
      const bool wall = x == 7 && y > 3;
      grid.set(key, wall ? Occupancy::kOccupied : Occupancy::kFree);
      if ((x * 7 + y * 3 + z * 5) % 11 == 0 && !wall) targets.push_back(key);
      if (z == 2 && !wall) viewpoints.push_back(key);
    });
  }

  [[nodiscard]] ViewQualityImage render(const ViewQualityOptions& options) const {
    return render_view_quality(*make_grid_ray_caster(grid), grid.lattice(), viewpoints, targets, view,
                               options);
  }

  [[nodiscard]] ViewQualityImage exact(int bins) const {
    return render({.renderer = Renderer::kExact, .azimuth_bins = bins});
  }
  [[nodiscard]] ViewQualityImage drawn(int samples, int bins, std::uint64_t seed) const {
    return render({.samples = samples, .seed = seed, .azimuth_bins = bins});
  }
};

double metres(const VoxelKey& a, const VoxelKey& b) {
  const double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return kResolution * std::sqrt(x * x + y * y + z * z);
}

TEST(TrueScore, IsTheWindowsOwnCount) {
  const Room room;
  for (const int bins : {24, 25, 36}) {
    const ViewQualityImage truth = room.exact(bins);
    for (const double opening : {kTurn / 4, kTurn / 3, kTurn}) {
      const Scores scores(truth, opening);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_EQ(true_score(truth, i, scores.yaw[i], opening), scores.value[i]) << bins << ' ' << i;
        EXPECT_EQ(scores.value[i], static_cast<double>(best_window(truth.bin_hits(i), opening).hits));
      }
    }
  }
}

TEST(ErrorSum, OfTheTruthIsZero) {
  const Room room;
  for (const int bins : {0, 36}) {
    const ViewQualityImage truth = room.exact(bins);
    ErrorSum errors(truth, room.grid.lattice(), room.view.horizontal, 0.2, 10);
    errors.add(room.drawn(ViewQualityOptions::kAll, bins, 1));
    const ViewError error = errors.mean();
    for (const double e : {error.rms, error.predicted, error.absolute, error.bias, error.missed,
                           error.best_loss, error.place_loss, error.recounted_loss})
      EXPECT_EQ(e, 0.0) << bins;
  }
}

TEST(ErrorSum, IsWhatTheSumsWrittenOutGive) {
  const Room room;
  const double lambda = 0.2;
  const ViewQualityImage truth = room.exact(0);
  // As many places as viewpoints: then the places are the viewpoints.
  ErrorSum errors(truth, room.grid.lattice(), 1.0, lambda, truth.size());
  double squares = 0, absolute = 0, bias = 0, missed = 0, seeing = 0, best_loss = 0, place_loss = 0, gain = 0,
         recounted_loss = 0;
  const auto count = static_cast<double>(truth.size());
  const std::uint64_t kImages = 3;
  for (std::uint64_t seed = 1; seed <= kImages; ++seed) {
    const ViewQualityImage image = room.drawn(2, 0, seed);
    errors.add(image);
    std::vector<double> mine, real;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      mine.push_back(image.values()[i].gain);
      real.push_back(truth.values()[i].gain);
      squares += (mine[i] - real[i]) * (mine[i] - real[i]);
      absolute += std::abs(mine[i] - real[i]);
      bias += mine[i] - real[i];
      gain += real[i];
      seeing += real[i] > 0 ? 1 : 0;
      missed += real[i] > 0 && mine[i] == 0 ? 1 : 0;
    }
    const auto best = std::ranges::max_element(mine) - mine.begin();
    best_loss += 1 - real[static_cast<std::size_t>(best)] / *std::ranges::max_element(real);
    for (const VoxelKey& place : room.viewpoints) {
      std::vector<double> by_mine, by_truth;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const double discount = std::exp(-lambda * metres(place, room.viewpoints[i]));
        by_mine.push_back(mine[i] * discount);
        by_truth.push_back(real[i] * discount);
      }
      const auto chosen = std::ranges::max_element(by_mine) - by_mine.begin();
      std::vector<std::pair<double, double>> ranked;
      for (std::size_t i = 0; i < truth.size(); ++i) ranked.emplace_back(by_mine[i], by_truth[i]);
      std::ranges::sort(ranked, std::greater<>());
      double recounted = 0;
      for (std::size_t i = 0; i < kRecounted; ++i) recounted = std::max(recounted, ranked[i].second);
      recounted_loss += 1 - recounted / *std::ranges::max_element(by_truth);
      place_loss += 1 - by_truth[static_cast<std::size_t>(chosen)] / *std::ranges::max_element(by_truth);
    }
  }
  const double images = static_cast<double>(kImages), mean = gain / count / images;
  const ViewError error = errors.mean();
  EXPECT_NEAR(errors.mean_gain(), mean, 1e-12 * mean);
  EXPECT_NEAR(error.rms, std::sqrt(squares / count / images) / mean, 1e-12);
  EXPECT_NEAR(error.absolute, absolute / count / images / mean, 1e-12);
  EXPECT_NEAR(error.bias, bias / count / images / mean, 1e-12);
  EXPECT_NEAR(error.missed, missed / seeing, 1e-12);
  EXPECT_NEAR(error.best_loss, best_loss / images, 1e-12);
  EXPECT_NEAR(error.place_loss, place_loss / count / images, 1e-6);  // ties of distances, rounded in float
  EXPECT_NEAR(error.recounted_loss, recounted_loss / count / images, 1e-6);
  EXPECT_LT(error.recounted_loss, error.place_loss);
  EXPECT_GT(error.rms, 0.05);
  EXPECT_GT(error.place_loss, 0.0);
}

TEST(ErrorSum, RefusesWhatCannotBeCompared) {
  Room room;
  const ViewQualityImage truth = room.exact(0);
  ErrorSum errors(truth, room.grid.lattice(), 1.0, 0.2, 4);
  room.viewpoints.pop_back();
  EXPECT_REFUSED(errors.add(room.exact(0)));
  room.targets.clear();
  const ViewQualityImage nothing = room.exact(0);
  EXPECT_REFUSED(ErrorSum(nothing, room.grid.lattice(), 1.0, 0.2, 4));
}

}  // namespace
}  // namespace frontlux::bench
