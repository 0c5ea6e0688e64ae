// Voxels in which rays have ended, until others pass the very points.

#include "mapping/hit_points.hpp"

#include "support/random.hpp"
#include "support/voxel_keys.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace frontlux::planner::detail {
namespace {

using Keys = std::vector<VoxelKey>;

constexpr double kResolution = 0.3;  // [m]
constexpr float kNear = 0.3F / 8;    // [m]
constexpr float kNothing = std::numeric_limits<float>::infinity();

// A sensor in the middle of a voxel, and what rays from it leave.
struct Scene {
  Mapping mapping{{.resolution = kResolution}};
  HitPoints points{mapping.grid()};
  Eigen::Vector3f origin = Eigen::Vector3f::Constant(0.15F);
  Keys solid;  // that the last scan returned

  // Rays towards points with offsets from the origin, each up to a distance [m].
  void scan(const std::vector<Eigen::Vector3f>& towards, float range, int times = 1) {
    Scan scan{.origin = origin, .max_range = 10.0, .directions = {}, .ranges = {}};
    for (const Eigen::Vector3f& offset : towards) {
      scan.directions.push_back(offset.normalized());
      scan.ranges.push_back(range);
    }
    for (int i = 0; i < times; ++i) solid = points.insert(scan, mapping, mapping.insert(scan));
  }
  [[nodiscard]] VoxelKey key(const Eigen::Vector3f& offset) const {
    return mapping.grid().lattice().key(Eigen::Vector3f(origin + offset)).value();
  }
};

const Eigen::Vector3f kPlace(3.13F, 0.0F, 0.0F);  // ahead, 2 cm before the next voxel
// Rays that go through its voxel as well, at this distance from it [m].
Eigen::Vector3f beside(float distance) { return kPlace + Eigen::Vector3f(0.0F, distance, 0.0F); }

TEST(HitPoints, AreSolidWhenTwoRaysHaveEnded) {
  Scene scene;
  scene.scan({kPlace}, kNothing, 10);  // sure to be free, so that the map has it free still
  const VoxelKey key = scene.key(kPlace);
  scene.scan({kPlace}, kPlace.x());
  EXPECT_FALSE(scene.points.is_solid(key));
  EXPECT_EQ(scene.solid, Keys{});
  scene.scan({kPlace}, kPlace.x());
  EXPECT_TRUE(scene.points.is_solid(key));
  ASSERT_EQ(scene.mapping.grid().at(key), Occupancy::kFree);
  EXPECT_EQ(scene.solid, Keys{key});
  EXPECT_EQ(scene.points.take_changed(), Keys{key});
  scene.scan({kPlace}, kPlace.x());
  EXPECT_EQ(scene.solid, Keys{}) << "it is already";
  EXPECT_EQ(scene.points.take_changed(), Keys{});
}

TEST(HitPoints, AreGoneWhenRaysHavePassedThem) {
  for (const float distance : {0.0F, 0.9F * kNear, 1.1F * kNear}) {
    Scene scene;
    const VoxelKey key = scene.key(kPlace);
    scene.scan({kPlace}, kPlace.x(), 2);
    for (int i = 0; scene.mapping.grid().at(key) != Occupancy::kFree; ++i) {
      ASSERT_LT(i, 10);
      scene.scan({beside(0.1F)}, kNothing);
    }
    scene.scan({beside(0.1F)}, kNothing, 50);
    scene.scan({beside(distance)}, kPlace.x() + 0.9F * kNear, 50);  // no farther, though in the next voxel
    EXPECT_TRUE(scene.points.is_solid(key));
    static_cast<void>(scene.points.take_changed());  // that next voxel
    scene.scan({beside(distance)}, kNothing, HitPoints::kMostPassed - 1);
    EXPECT_TRUE(scene.points.is_solid(key));
    EXPECT_EQ(scene.points.take_changed(), Keys{});
    scene.scan({beside(distance)}, kNothing);
    EXPECT_EQ(scene.points.is_solid(key), distance > kNear) << distance;
    EXPECT_EQ(scene.points.take_changed(), distance > kNear ? Keys{} : Keys{key});
  }
}

// In a scan with both, the ray that ends there counts.
TEST(HitPoints, StayWhileRaysEndInTheirVoxel) {
  Scene scene;
  scene.scan({kPlace}, kNothing, 10);
  scene.scan({kPlace}, kPlace.x(), 2);
  Scan both{.origin = scene.origin, .max_range = 10.0, .directions = {}, .ranges = {}};
  for (int i = 0; i < 20; ++i) {
    both.directions.push_back(kPlace.normalized());
    both.ranges.push_back(i == 7 ? kPlace.x() : kNothing);
  }
  for (int i = 0; i < 3; ++i) {
    scene.scan({kPlace}, kNothing, HitPoints::kMostPassed - 1);
    scene.points.insert(both, scene.mapping, scene.mapping.insert(both));
  }
  EXPECT_TRUE(scene.points.is_solid(scene.key(kPlace)));
}

// Though no ray of it can pass.
TEST(HitPoints, AreGoneWhereASensorIs) {
  Scene scene;
  const Eigen::Vector3f beside_sensor(0.02F, 0.0F, 0.0F);
  scene.scan({beside_sensor}, beside_sensor.x(), 2);
  EXPECT_TRUE(scene.points.is_solid(scene.key(beside_sensor)));
  scene.scan({-beside_sensor}, kNothing, 10);
  EXPECT_FALSE(scene.points.is_solid(scene.key(beside_sensor)));
}

// Told of when they are free again, whatever the map was when it was told of last.
TEST(HitPoints, AreToldOfIfTheyBecameSolidWhileOccupied) {
  Scene scene;
  scene.scan({beside(0.1F)}, kNothing);
  const VoxelKey key = scene.key(kPlace);
  scene.scan({kPlace}, kPlace.x(), 2);
  ASSERT_EQ(scene.mapping.grid().at(key), Occupancy::kOccupied);
  EXPECT_EQ(scene.solid, Keys{});
  EXPECT_EQ(scene.points.take_changed(), Keys{});
  scene.scan({beside(0.1F)}, kNothing, 4);
  ASSERT_EQ(scene.mapping.grid().at(key), Occupancy::kFree);
  EXPECT_EQ(scene.points.take_changed(), Keys{key});
}

// In the middles of what is occupied at the beginning.
TEST(HitPoints, AreInAMapThatIsGiven) {
  Scene scene;
  const std::vector<Eigen::Vector3f> middle = {{3.0F, 0.0F, 0.0F}}, side = {{3.0F, 0.1F, 0.0F}};
  scene.scan(middle, 3.0F, 3);
  const VoxelKey key = scene.key(middle[0]);
  scene.points = HitPoints(scene.mapping.grid());
  scene.scan(side, kNothing, 20);
  ASSERT_EQ(scene.mapping.grid().at(key), Occupancy::kFree);
  EXPECT_TRUE(scene.points.is_solid(key));
  scene.scan(middle, kNothing, HitPoints::kMostPassed);
  EXPECT_FALSE(scene.points.is_solid(key));
}

TEST(HitPoints, AreNotWhereNothingWasMeasuredOrOutsideTheMap) {
  Mapping mapping(
      {.resolution = kResolution, .bounds = {make_key(32700, 32700, 32700), make_key(32770, 32800, 32800)}});
  HitPoints points(mapping.grid());
  const Scan scan{
      Eigen::Vector3f::Constant(0.15F), 10.0, {3, Eigen::Vector3f::UnitX()}, {3.0F, NAN, kNothing}};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(points.insert(scan, mapping, mapping.insert(scan)), Keys{});
  EXPECT_FALSE(points.is_solid(mapping.grid().lattice().key(Eigen::Vector3f(3.15F, 0.15F, 0.15F)).value()));
  EXPECT_EQ(points.take_changed(), Keys{});
}

// Rays that end at the very edge of a floor, behind which there is a pit.
TEST(HitPoints, AreNotBehindTheEdgeOfWhatIsThere) {
  for (const bool is_floor : {true, false}) {
    Scene scene;
    const std::vector<Eigen::Vector3f> floor = {{3.0F, 0.0F, 0.0F}}, edge = {{3.1496F, 0.0F, 0.0F}};
    if (is_floor) scene.scan(floor, floor[0].x(), 2);
    scene.scan({{3.5F, 0.0F, 0.0F}}, kNothing, is_floor ? 0 : 10);
    const VoxelKey behind = scene.key({3.1504F, 0.0F, 0.0F});
    ASSERT_NE(scene.key(edge[0]), behind);
    scene.scan(edge, edge[0].x(), 3);
    EXPECT_EQ(scene.points.is_solid(behind), !is_floor) << "a wall at a voxel's face";
  }
}

// Its rule, ray by ray.
class Plain {
 public:
  void insert(const Scan& scan, const Mapping& mapping) {
    std::set<VoxelKey> ended;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (!std::isfinite(scan.ranges[i])) continue;
      const Eigen::Vector3f end = scan.origin + scan.directions[i] * (scan.ranges[i] + 0.001F);
      const VoxelKey key = mapping.grid().lattice().key(end).value();
      if (!mapping.bounds().contains(key)) continue;
      const Eigen::Vector3f hit = scan.origin + scan.directions[i] * scan.ranges[i];
      const VoxelKey before = mapping.grid().lattice().key(hit).value();
      if (before != key && (mapping.grid().at(before) == Occupancy::kOccupied || is_solid(before))) continue;
      Point& point = points_[key];
      point = {end, point.ended + 1, 0};
      ended.insert(key);
    }
    for (auto& [key, point] : points_) {
      if (ended.contains(key) || mapping.grid().at(key) != Occupancy::kFree) continue;
      const Eigen::Vector3f offset = point.at - scan.origin;
      const float distance = offset.norm();
      if (distance <= kNear) point.passed = HitPoints::kMostPassed;
      if (distance <= kNear || distance >= static_cast<float>(scan.max_range)) continue;
      for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const float along = offset.dot(scan.directions[i]), off = offset.cross(scan.directions[i]).norm();
        const float length = std::isinf(scan.ranges[i]) ? static_cast<float>(scan.max_range) : scan.ranges[i];
        if (along > 0.0F && length > along + kNear && off < std::min(kNear, 0.9F / 16 * distance))
          ++point.passed;
      }
    }
    std::erase_if(points_, [](const auto& item) { return item.second.passed >= HitPoints::kMostPassed; });
  }
  [[nodiscard]] bool is_solid(const VoxelKey& key) const {
    const auto found = points_.find(key);
    return found != points_.end() && found->second.ended >= HitPoints::kLeastEnded;
  }

 private:
  struct Point {
    Eigen::Vector3f at;
    int ended = 0, passed = 0;
  };
  std::map<VoxelKey, Point> points_;
};

TEST(HitPoints, AreWhatTheirRuleSaysAfterRandomScans) {
  int appeared = 0, gone = 0, free = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const KeyBox box{test::key_at(-9, -9, -9), test::key_at(9, 9, 9)};
    Mapping mapping({.resolution = kResolution, .bounds = box});
    HitPoints points(mapping.grid());
    Plain plain;
    // From a few places in some directions, so that rays pass where others have ended.
    std::vector<Eigen::Vector3f> directions, origins;
    for (int i = 0; i < 150; ++i) directions.push_back(random.point(-1.0, 1.0).cast<float>().normalized());
    for (int i = 0; i < 3; ++i) origins.push_back(random.point(-1.0, 1.0).cast<float>());
    for (int step = 0; step < 60; ++step) {
      Scan scan{random.pick(origins), random.pick(std::vector<double>{2.0, 10.0}), directions, {}};
      const auto far = static_cast<float>(random.uniform(0.3, 2.0));
      for (std::size_t i = 0; i < directions.size(); ++i)
        scan.ranges.push_back(random.one_in(9) ? NAN : random.one_in(3) ? far : kNothing);
      const VoxelGrid map_before = mapping.grid();
      const auto closed = [&](const VoxelGrid& map, const auto& rule, const VoxelKey& key) {
        return map.at(key) == Occupancy::kFree && rule.is_solid(key);
      };
      std::set<VoxelKey> were;
      std::set<VoxelKey> were_solid;
      for (const VoxelKey& key : test::keys_of(box)) {
        if (closed(map_before, plain, key)) were.insert(key);
        if (plain.is_solid(key)) were_solid.insert(key);
      }
      const MapChange change = mapping.insert(scan);
      Keys returned = points.insert(scan, mapping, change);
      plain.insert(scan, mapping);
      Keys expected, told = points.take_changed();
      test::sort(returned);
      test::sort(told);
      for (const VoxelKey& key : test::keys_of(box)) {
        ASSERT_EQ(points.is_solid(key), plain.is_solid(key));
        const bool is = closed(mapping.grid(), plain, key);
        if (is && !were_solid.contains(key)) expected.push_back(key);
        const bool told_of = mapping.grid().at(key) != map_before.at(key) || is == were.contains(key) ||
                             std::ranges::binary_search(told, key);
        EXPECT_TRUE(told_of);
        gone += static_cast<int>(were_solid.contains(key) && !plain.is_solid(key));
        free += static_cast<int>(is);
      }
      test::sort(expected);
      EXPECT_EQ(returned, expected);
      appeared += static_cast<int>(expected.size());
    }
  }
  EXPECT_GT(appeared, 100);
  EXPECT_GT(gone, 100);
  EXPECT_GT(free, 1000);
}

}  // namespace
}  // namespace frontlux::planner::detail
