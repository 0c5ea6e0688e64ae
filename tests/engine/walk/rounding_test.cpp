// What only rounding decides: where floats have other spaces on both sides of a face, and where they lie so
// close together that a line beside a face has still to cross it.
#include "support/casters.hpp"
#include "support/octomap_answers.hpp"

#include <frontlux/octomap.hpp>

#include <cmath>

namespace frontlux::test {
namespace {

octomap::point3d point_of(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }
octomap::OcTreeKey tree_key_of(const VoxelKey& key) { return {key.x, key.y, key.z}; }

float square(float length) { return length * length; }

// A map of free voxels around a blocker, and a ray whose range ends between the distances of two centres, of
// which the first on its path is the farther one.
struct Case {
  Ray ray;
  VoxelKey start, blocker;
  double resolution;
};

std::vector<Case> cases_of(double resolution) {
  std::vector<Case> cases;
  const Lattice lattice(resolution);
  const std::uint16_t middle = 32768;
  const auto center_of = [&](std::uint16_t key) { return static_cast<float>(lattice.center(key)); };
  const float center = center_of(middle);
  const auto add = [&](const Case& one, double before, double after) {
    cases.push_back(one);
    const double range = std::sqrt((before + after) / 2);
    if (before > range * range && after <= range * range) {
      cases.back().ray.max_range = range;
    } else {
      cases.pop_back();
    }
  };
  for (int power = -8; power < 14; ++power)
    for (const float at : {std::ldexp(1.0F, power), -std::ldexp(1.0F, power)})
      for (const int step : {-1, 1}) {
        const auto key = lattice.key(at);
        if (!key || *key < 100 || *key > 65400) continue;
        const auto next = static_cast<std::uint16_t>(*key + step);
        const float off = center_of(*key) - at, off_next = center_of(next) - at;
        const double to_face = (*key - Lattice::kOrigin + (step > 0 ? 1 : 0)) * resolution - at;
        if (!(std::fabs(off) > std::fabs(off_next)) || std::fabs(to_face) > 1e-6 * resolution) continue;
        // Around a corner: into the voxel beside, and from there into the blocker.
        const auto of = [](float squared) { return static_cast<double>(squared); };
        const auto sign = static_cast<float>(step);
        add({{{at, at, center}, {sign, sign, 0.0F}, 0.0},
             {*key, *key, middle},
             {next, next, middle},
             resolution},
            of(square(off)) + of(square(off_next)), of(square(off_next)) + of(square(off_next)));
        // Along the face, which it crosses after twenty voxels.
        if (to_face == 0.0) continue;
        const auto slow = static_cast<float>(to_face / (20.3 * resolution));
        const auto end = static_cast<std::uint16_t>(middle + 20);
        const double along = of(square(center_of(end) - center));
        add({{{at, center, center}, {slow, 1.0F, 0.0F}, 0.0},
             {*key, middle, middle},
             {next, end, middle},
             resolution},
            of(square(off)) + along, of(square(off_next)) + along);
      }
  return cases;
}

TEST(Rounding, PutsACentreOutOfRangeOnThePathToOneThatIsNot) {
  std::size_t cases = 0;
  for (const double resolution : {0.05, 0.1, 0.2, 0.3, 1.0 / 3.0, 0.25 / 3.0, 1.0})
    for (const Case& one : cases_of(resolution)) {
      SCOPED_TRACE(testing::Message() << "resolution " << resolution << ", range " << one.ray.max_range);
      ++cases;
      octomap::OcTree tree(resolution);
      for_each_key(grown(hull({one.start, one.start}, {one.blocker, one.blocker}), 2),
                   [&](const VoxelKey& key) { tree.updateNode(tree_key_of(key), false); });
      for (int i = 0; i < 5; ++i) tree.updateNode(tree_key_of(one.blocker), true);
      octomap::point3d end, own;
      const auto& [origin, direction, range] = one.ray;
      EXPECT_FALSE(castray_of(tree, point_of(origin), point_of(direction), end, false, range));
      EXPECT_FALSE(OctreeRayCaster(tree).castRay(point_of(origin), point_of(direction), own, false, range));
      EXPECT_EQ(own, end);
      for (const auto& [name, caster] : Casters(tree).all) {
        const std::vector<Ray> rays(17, one.ray);
        std::vector<Hit> hits(rays.size());
        caster->cast(rays, hits, UnknownPolicy::kBlock);
        hits.push_back(caster->cast(one.ray, UnknownPolicy::kBlock));
        for (const Hit& hit : hits) {
          ASSERT_EQ(hit.stop, RayStop::kOutOfRange) << name;
          ASSERT_EQ(point_of(hit.end), end) << name;
        }
      }
    }
  EXPECT_GT(cases, 20U);
}

// The path enters what is to be seen through a face of a coordinate of 0, however close to it the line
// begins.
TEST(Rounding, LetsALineBesideAFaceCrossIt) {
  std::size_t crossed = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [&](float along, float beside, float up) {
      Eigen::Vector3f point;
      point[axis] = up;
      point[(axis + 1) % 3] = along;
      point[(axis + 2) % 3] = beside;
      return point;
    };
    octomap::OcTree tree(0.1);
    for (int along = -2; along < 10; ++along)
      for (int beside = -2; beside < 3; ++beside)
        for (int up = -2; up < 3; ++up)
          tree.updateNode(point_of(turned(0.05F + 0.1F * static_cast<float>(along),
                                          0.05F + 0.1F * static_cast<float>(beside),
                                          0.05F + 0.1F * static_cast<float>(up))),
                          along == 5);
    std::vector<Segment> segments;
    for (int power = -149; power < -3; ++power)
      for (const float sign : {-1.0F, 1.0F})
        for (const float end : {0.0F, -sign * std::ldexp(1.0F, power), sign * 1e-30F})
          segments.push_back(
              {turned(0.05F, 0.05F, sign * std::ldexp(1.0F, power)), turned(0.5F, 0.05F, end)});
    // Often enough that the fast caster asks Embree, too.
    const std::size_t some = segments.size();
    while (segments.size() < 40'000) segments.push_back(segments[segments.size() - some]);
    for (const auto& caster : casters_of(make_voxel_grid(tree))) {
      std::vector<std::uint8_t> visible(segments.size());
      caster->visible(std::span<const Segment>(segments), visible, UnknownPolicy::kBlock);
      for (std::size_t i = 0; i < segments.size(); ++i) {
        const octomap::point3d from = point_of(segments[i].from), to = point_of(segments[i].to);
        octomap::point3d end;
        const bool hit = i < some && castray_of(tree, from, to - from, end, false);
        const auto expected =
            i < some ? static_cast<std::uint8_t>(hit && tree.coordToKey(end) == tree.coordToKey(to))
                     : visible[i - some];
        ASSERT_EQ(visible[i], expected)
            << segments[i].from.transpose() << " to " << segments[i].to.transpose();
        crossed += i < some && expected == 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(crossed, 300U);
}

}  // namespace
}  // namespace frontlux::test
