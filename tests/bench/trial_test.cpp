// That the harness finds wrong answers, and by what it judges.
#include "rays/trial.hpp"

#include "rays/castray_loop.hpp"
#include "rays/exact_visibility.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/giant_leaf.hpp"
#include "support/maps.hpp"
#include "support/ray_samples.hpp"

#include <sstream>

namespace frontlux::bench {
namespace {

/// Answers as the grid does, but for one ray of a batch.
class LyingRayCaster final : public RayCaster {
 public:
  LyingRayCaster(const VoxelGrid& grid, std::function<void(Hit&)> lie)
      : RayCaster(grid.lattice()), honest_(make_grid_ray_caster(grid)), lie_(std::move(lie)) {}

 private:
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    honest_->cast(rays, hits, unknown);
    lie_(hits[hits.size() / 2]);
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    honest_->visible(segments, visible, unknown);
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    honest_->visible(segments, visible, unknown);
    Hit hit;
    lie_(hit);
    if (hit.stop != RayStop::kInvalid) visible[visible.size() / 2] ^= 1U;
  }
  void do_count(std::span<const Ray>, std::span<PathCount>, UnknownPolicy) const override {}
  void do_count(std::span<const Segment>, std::span<PathCount>, UnknownPolicy) const override {}
  void do_count(std::span<const KeySegment>, std::span<PathCount>, UnknownPolicy) const override {}
  void do_update(const VoxelGrid&) override {}

  std::unique_ptr<RayCaster> honest_;
  std::function<void(Hit&)> lie_;
};

class TrialTest : public testing::Test {
 protected:
  std::unique_ptr<Subject> subject_ = make_subject(frontlux::test::make_noise_tree(3, 0.3, 24), "noise");

  /// What a trial says of a workload, with a liar for the caster of this name.
  struct Verdict {
    bool agreed;
    std::string text;
  };
  Verdict check(const char* workload, const char* caster, std::function<void(Hit&)> lie) {
    WorkloadSource source(subject_->grid, subject_->caster(kGrid));
    Workload rays = source.make(workload, 2000);
    EXPECT_GT(rays.size(), 500U) << rays.skipped;
    for (Contender& c : subject_->contenders)
      if (c.caster == caster) c.rays = std::make_unique<LyingRayCaster>(subject_->grid, std::move(lie));
    Trial trial(*subject_, std::move(rays), {});
    std::ostringstream out;
    const std::vector<int> threads{1, 2};
    const bool agreed = trial.check(threads, out);
    return {agreed, out.str()};
  }
};

TEST_F(TrialTest, AgreesIfNobodyLies) {
  for (const char* workload : {"visible_uav", "cast_random", "cast_lidar"}) {
    const Verdict verdict = check(workload, "", {});
    EXPECT_TRUE(verdict.agreed) << verdict.text;
  }
}

// The lie may be in any part of an answer, and in that of any caster of ours.
TEST_F(TrialTest, FindsOneWrongBitInAnyPart) {
  const std::vector<std::pair<const char*, std::function<void(Hit&)>>> lies = {
      {"stop", [](Hit& hit) { hit.stop = RayStop::kReached; }},
      {"state", [](Hit& hit) { hit.state = static_cast<Occupancy>((static_cast<int>(hit.state) + 1) % 3); }},
      {"key", [](Hit& hit) { hit.key.y ^= 1U; }},
      {"end", [](Hit& hit) { hit.end.z() = std::nextafter(hit.end.z(), 1e9F); }},
      {"entry", [](Hit& hit) { hit.entry.x() = std::nextafter(hit.entry.x(), 1e9F); }},
      {"distance", [](Hit& hit) { hit.distance = std::nextafter(hit.distance, 1e9F); }},
  };
  for (const char* caster : {kFast, kEmbree, kGrid})
    for (const auto& [part, lie] : lies) {
      subject_ = make_subject(frontlux::test::make_noise_tree(3, 0.3, 24), "noise");
      const Verdict verdict = check("cast_random", caster, lie);
      EXPECT_FALSE(verdict.agreed) << caster << ": " << part;
      frontlux::test::expect_parts(verdict.text, {"DISAGREEMENT, ", caster});
    }
}

// Of the segments too, where the grid was once its own judge.
TEST_F(TrialTest, NoCasterJudgesItself) {
  for (const char* caster : {kFast, kEmbree, kGrid}) {
    subject_ = make_subject(frontlux::test::make_noise_tree(3, 0.3, 24), "noise");
    const Verdict verdict = check("visible_ugv", caster, [](Hit& hit) { hit.stop = RayStop::kOccupied; });
    EXPECT_FALSE(verdict.agreed) << caster;
    frontlux::test::expect_parts(verdict.text, {"DISAGREEMENT, ", caster});
  }
}

TEST(ExactVisibility, IsThatOfTheGrid) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const VoxelGrid grid = make_voxel_grid(frontlux::test::make_random_tree(seed, 0.3));
    const auto segments = frontlux::test::adversarial_key_segments(grid, 20'000, seed);
    std::vector<std::uint8_t> expected(segments.size()), visible(segments.size());
    for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass}) {
      make_grid_ray_caster(grid)->visible(segments, expected, unknown);
      exact_visibility(grid, segments, visible, unknown);
      EXPECT_EQ(visible, expected);
      EXPECT_GT(std::ranges::count(visible, 1), 1000);
      EXPECT_GT(std::ranges::count(visible, 0), 1000);
    }
  }
}

// Where castRay is timed, and where answers are compared with it. The copy in OctoMap's library prints of
// each ray that leaves the key range.
TEST(OwnCastray, IsNotTheOneInTheLibrary) {
  const Octree tree =
      frontlux::test::make_noise_tree(1, 0.1, 4);  // elsewhere, so that its class is not known here
  const std::vector<Ray> rays = {{{9, 9, 9}, {1, 0, 0}, -1.0}};
  constexpr float kLast = 3276.75F;  // [m] middle of the last voxel
  CastRayAnswers answers(1);
  std::vector<Hit> hits(1);
  testing::internal::CaptureStderr();
  cast_ray_loop(tree, rays, UnknownPolicy::kPass, answers);
  make_octomap_ray_caster(tree)->cast(rays, hits, UnknownPolicy::kPass);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(answers.occupied[0]);
  EXPECT_FALSE(hits[0].occupied());
  EXPECT_NEAR(answers.end[0].x(), kLast, 0.01);
  EXPECT_NEAR(hits[0].end.x(), kLast, 0.01);
}

using SubjectTest = frontlux::test::FolderTest;

TEST_F(SubjectTest, RefusesMapsThatNoPlaceFills) {
  const std::string file = write("giant.bt", frontlux::test::giant_leaf(2));
  const std::string complaint =
      frontlux::test::complaint_of<std::runtime_error>([&] { return load_subject(file, "giant"); });
  EXPECT_NE(complaint.find(file + ": declares "), std::string::npos) << complaint;
}

TEST(SubjectName, IsTheFilesStemAndNobodyElses) {
  std::set<std::string> taken{"map"};
  EXPECT_EQ(unique_name("a/map.bt", taken), "map_2");
  EXPECT_EQ(unique_name("b/map.ot", taken), "map_3");
  EXPECT_EQ(unique_name("b/hall.bt", taken), "hall");
}

}  // namespace
}  // namespace frontlux::bench
