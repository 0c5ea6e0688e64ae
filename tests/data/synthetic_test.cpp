#include "support/complaint.hpp"
#include "support/folder_test.hpp"

#include <frontlux/synthetic/box_set.hpp>
#include <frontlux/synthetic/maps.hpp>
#include <frontlux/synthetic/random.hpp>
#include <frontlux/synthetic/scanner.hpp>
#include <frontlux/synthetic/scene.hpp>

namespace frontlux::synthetic {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  EXPECT_TRUE(fs::exists(file)) << file;
  return test::content_of(file);
}

class SyntheticFiles : public test::FolderTest {
 protected:
  std::string make(const MapRecipe& recipe, std::uint64_t seed) {
    write_map(recipe, seed, folder_ / recipe.file_name());
    return bytes_of(folder_ / recipe.file_name());
  }
};

std::optional<BoxSet::Hit> first_of_all(const std::vector<BoxSet>& single, const Eigen::Vector3d& origin,
                                        const Eigen::Vector3d& direction) {
  std::optional<BoxSet::Hit> best;
  for (std::size_t i = 0; i < single.size(); ++i) {
    const auto hit = single[i].first_hit(origin, direction);
    if (hit && (!best || hit->distance < best->distance)) best = {hit->distance, i};
  }
  return best;
}

TEST(BoxSet, MeasuresTheDistanceToASolid) {
  const BoxSet set({Box(Eigen::Vector3d(2, -1, -1), Eigen::Vector3d(3, 1, 1)),
                    Box(Eigen::Vector3d(5, -1, -1), Eigen::Vector3d(6, 1, 1))});
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  EXPECT_EQ(set.first_hit({0, 0, 0}, x), (BoxSet::Hit{2.0, 0}));
  EXPECT_EQ(set.first_hit({0, 1, 1}, x), (BoxSet::Hit{2.0, 0}));  // along an edge
  EXPECT_EQ(set.first_hit({4, 0, 0}, x), (BoxSet::Hit{1.0, 1}));
  EXPECT_EQ(set.first_hit({4, 0, 0}, -x), (BoxSet::Hit{1.0, 0}));
  EXPECT_EQ(set.first_hit({2.5, 0, 0}, x), (BoxSet::Hit{0.0, 0}));
  EXPECT_EQ(set.first_hit({0, 1.5, 0}, x), std::nullopt);
  EXPECT_EQ(set.first_hit({7, 0, 0}, x), std::nullopt);
  const auto slanted = set.first_hit({0, -1, 0}, Eigen::Vector3d(4, 3, 0) / 5.0);
  ASSERT_TRUE(slanted);
  EXPECT_DOUBLE_EQ(slanted->distance, 2.5);
  EXPECT_EQ(BoxSet({}).first_hit({0, 0, 0}, x), std::nullopt);
}

TEST(BoxSet, FirstHitEqualsTestingEveryBox) {
  Random random(7);
  std::vector<Box> boxes;
  std::vector<BoxSet> single;
  for (int i = 0; i < 300; ++i) {
    // Whole coordinates: boxes share faces, edges and corners, and rays run along them.
    const Eigen::Vector3d low(random.whole(-12, 12), random.whole(-12, 12), random.whole(-6, 6));
    const Eigen::Vector3d size(random.whole(0, 3), random.whole(0, 3), random.whole(0, 3));
    boxes.emplace_back(low, low + size);
    single.emplace_back(std::vector<Box>{boxes.back()});
  }
  const BoxSet set(boxes);
  int hits = 0;
  constexpr int kRays = 20'000;
  for (int i = 0; i < kRays; ++i) {
    Eigen::Vector3d origin(random.between(-14, 14), random.between(-14, 14), random.between(-8, 8));
    Eigen::Vector3d direction(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    if (i % 4 == 1) origin = origin.array().round().matrix().eval();
    if (i % 4 >= 2) {
      direction = Eigen::Vector3d::Unit(random.whole(0, 2)) * (random.one_in(2) ? 1.0 : -1.0);
      if (i % 4 == 3) origin = origin.array().round().matrix().eval();
    }
    direction.normalize();
    const auto hit = set.first_hit(origin, direction);
    ASSERT_EQ(hit, first_of_all(single, origin, direction))
        << origin.transpose() << ", " << direction.transpose();
    hits += hit ? 1 : 0;
  }
  EXPECT_GT(hits, kRays / 4);
  EXPECT_LT(hits, kRays);
}

TEST(BoxSet, RefusesBoxesWithoutExtent) {
  EXPECT_REFUSED(BoxSet({Box()}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_REFUSED(BoxSet({Box(Eigen::Vector3d(0, 0, nan), Eigen::Vector3d(1, 1, 1))}));
}

TEST(Scanner, RefusesWhatItCannotScan) {
  const Scene scene = make_room_scene(1);
  const std::vector<Eigen::Vector3d> places = draw_places(scene, 1, 1.0, 1);
  EXPECT_REFUSED(scan(scene, places, {.resolution = 0.0}));
  EXPECT_REFUSED(scan(scene, places, {.max_range = -1.0}));
  EXPECT_REFUSED(scan(scene, places, {.rays = 0}));
  EXPECT_REFUSED(scan(scene, {scene.solids.boxes().front().center()}, {}));
}

TEST(Scanner, FreesNothingBeyondTheOuterWalls) {
  const double resolution = 0.3;
  const Scene scene = make_building_scene(1);
  const Box& room = scene.room;
  const auto tree = scan(scene, draw_places(scene, 50, 3.0, 1),
                         {.resolution = resolution, .max_range = 9.0, .rays = 30'000});
  std::size_t free = 0;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    if (tree->isNodeOccupied(*leaf)) continue;
    ++free;
    const Eigen::Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
    const double reach = leaf.getSize() / 2.0;
    ASSERT_TRUE(((center.array() + reach) < room.max().array() + resolution).all()) << center.transpose();
    ASSERT_TRUE(((center.array() - reach) > room.min().array() - resolution).all()) << center.transpose();
  }
  EXPECT_GT(free, 100'000U);
}

TEST(Scanner, MapsHoldEveryKindOfLeaf) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Scene scene = make_room_scene(seed);
    const auto places = draw_places(scene, 4, 1.0, 1);
    const auto tree = scan(scene, places, {.resolution = 0.2, .max_range = 8.0, .rays = 20'000});
    for (const Eigen::Vector3d& place : places) {
      const auto* node = tree->search(place.x(), place.y(), place.z());
      ASSERT_NE(node, nullptr);
      EXPECT_FALSE(tree->isNodeOccupied(*node));
    }
    tree->toMaxLikelihood();
    tree->prune();
    std::array<std::size_t, 2> leaves{};
    std::size_t pruned = 0;
    double known = 0.0;
    for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
      ++leaves[tree->isNodeOccupied(*leaf) ? 1 : 0];
      pruned += leaf.getDepth() < tree->getTreeDepth() ? 1U : 0U;
      known += std::pow(leaf.getSize(), 3);
    }
    Eigen::Vector3d size;
    tree->getMetricSize(size.x(), size.y(), size.z());
    EXPECT_GT(leaves[0], 1'000U);
    EXPECT_GT(leaves[1], 1'000U);
    EXPECT_GT(pruned, 100U);
    EXPECT_LT(known, 0.97 * size.prod());
  }
}

TEST(MapRecipes, NamesAreKnown) {
  for (const MapRecipe& recipe : map_recipes()) EXPECT_EQ(&find_map_recipe(recipe.name), &recipe);
  EXPECT_REFUSED(find_map_recipe("attic_0.1m"));
}

TEST_F(SyntheticFiles, SeedDecidesTheBytes) {
  const MapRecipe& recipe = find_map_recipe("color_room_0.2m");
  const std::string once = make(recipe, 5);
  EXPECT_EQ(once, make(recipe, 5));
  EXPECT_NE(once, make(recipe, 6));
}

TEST_F(SyntheticFiles, KeptMapsAreWhatIsMadeNow) {
  std::size_t kept = 0;
  for (const MapRecipe& recipe : map_recipes()) {
    if (recipe.scene == SceneKind::kBuilding) continue;
    const fs::path file = fs::path(FRONTLUX_DATA_DIR) / "maps" / recipe.file_name();
    EXPECT_TRUE(bytes_of(file) == make(recipe, 1)) << file;
    EXPECT_LT(fs::file_size(file), 500'000U) << file;
    ++kept;
  }
  EXPECT_EQ(kept, 1U);
}

TEST_F(SyntheticFiles, EnsureMapMakesAMapOnce) {
  int told = 0;
  const auto tell = [&](std::string_view) { ++told; };
  const fs::path file = ensure_map("color_room_0.2m", folder_ / "new" / "folder", tell);
  EXPECT_GT(told, 0);
  EXPECT_TRUE(bytes_of(file) == make(find_map_recipe("color_room_0.2m"), 1));
  told = 0;
  const auto written = fs::last_write_time(file);
  EXPECT_EQ(ensure_map("color_room_0.2m", folder_ / "new" / "folder", tell), file);
  EXPECT_EQ(told, 0);
  EXPECT_EQ(fs::last_write_time(file), written);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
  EXPECT_REFUSED(ensure_map("attic_0.1m", folder_));
}

TEST_F(SyntheticFiles, LeavesNothingWhereItCannotWrite) {
  const MapRecipe& recipe = find_map_recipe("color_room_0.2m");
  EXPECT_THROW(write_map(recipe, 1, folder_ / "missing" / "map.bt"), std::runtime_error);
  fs::create_directories(folder_ / "taken.bt" / "inside");
  EXPECT_THROW(write_map(recipe, 1, folder_ / "taken.bt"), std::runtime_error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace frontlux::synthetic
