// Every caster against OctoMap itself, ray by ray and bit by bit. The default mode takes a sample on every
// map; FRONTLUX_LONG=1 takes three million rays on each, the generated buildings and FRONTLUX_EXTRA_MAPS
// included.

#include "support/casters.hpp"
#include "support/maps.hpp"
#include "support/octomap_answers.hpp"
#include "support/ray_samples.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <iostream>

namespace frontlux::test {
namespace {

constexpr std::size_t kBatch = 50'000;

std::string words_of(const Ray& ray) {
  std::ostringstream out;
  out << std::hexfloat << "origin " << ray.origin.transpose() << " direction " << ray.direction.transpose()
      << " range " << ray.max_range;
  return out.str();
}

bool same_bits(const Eigen::Vector3f& a, const octomap::point3d& b) {
  const float coordinates[] = {b.x(), b.y(), b.z()};
  return std::memcmp(a.data(), coordinates, sizeof(coordinates)) == 0;
}
octomap::point3d point_of(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }
// Counts indices for which `agrees` is false, and describes the first few of them.
class Disagreements {
 public:
  void check(std::size_t count, const std::function<bool(std::size_t)>& agrees,
             const std::function<std::string(std::size_t)>& describe) {
    checked_ += count;
    std::vector<std::uint8_t> fine(count);
    for_each_index(count, [&](std::size_t i) { fine[i] = agrees(i) ? 1 : 0; });
    for (std::size_t i = 0; i < count; ++i)
      if (fine[i] == 0 && ++found_ <= 3) ADD_FAILURE() << describe(i);
  }
  [[nodiscard]] std::size_t found() const { return found_; }
  [[nodiscard]] std::size_t checked() const { return checked_; }

 private:
  std::size_t found_ = 0, checked_ = 0;
};

struct Subject {
  explicit Subject(const NamedMap& named)
      : map(named),
        grid(make_voxel_grid(*map.tree)),
        grid_caster(make_grid_ray_caster(grid)),
        fast(make_ray_caster(grid)),
        embree(make_embree_ray_caster(grid)),
        octomap(make_octomap_ray_caster(*map.tree)),
        drop_in(*map.tree) {}
  NamedMap map;
  VoxelGrid grid;
  std::unique_ptr<RayCaster> grid_caster, fast, embree, octomap;
  OctreeRayCaster drop_in;
};

// castRay's bool and `end` by the drop-in and by every caster. The casters also agree on what castRay does
// not return.
void expect_casts_conform(const Subject& subject, std::size_t count, std::uint64_t seed,
                          UnknownPolicy unknown, Disagreements& bad) {
  const auto rays = adversarial_rays(subject.grid, count, seed);
  std::vector<Hit> walked(count), fast(count), embree(count), octomap(count);
  subject.grid_caster->cast(rays, walked, unknown);
  subject.fast->cast(rays, fast, unknown);
  subject.embree->cast(rays, embree, unknown);
  subject.octomap->cast(rays, octomap, unknown);
  const bool ignore_unknown = unknown == UnknownPolicy::kPass;
  bad.check(
      count,
      [&](std::size_t i) {
        const octomap::point3d origin = point_of(rays[i].origin), direction = point_of(rays[i].direction);
        const octomap::point3d untouched(1e20F, -2e20F, 3e20F);
        octomap::point3d end = untouched, drop_in_end = untouched;
        const bool hit =
            castray_of(*subject.map.tree, origin, direction, end, ignore_unknown, rays[i].max_range);
        const bool drop_in_hit =
            subject.drop_in.castRay(origin, direction, drop_in_end, ignore_unknown, rays[i].max_range);
        const Eigen::Vector3f expected =
            walked[i].stop == RayStop::kInvalid ? Eigen::Vector3f(1e20F, -2e20F, 3e20F) : walked[i].end;
        return hit == drop_in_hit && hit == walked[i].occupied() && same_bits(expected, end) &&
               same_bits(expected, drop_in_end) && same(walked[i], fast[i]) && same(walked[i], embree[i]) &&
               same(walked[i], octomap[i]);
      },
      [&](std::size_t i) { return subject.map.name + ": " + words_of(rays[i]); });
}

void expect_visibility_conforms(const Subject& subject, std::size_t count, std::uint64_t seed,
                                UnknownPolicy unknown, Disagreements& bad) {
  const auto keys = adversarial_key_segments(subject.grid, count, seed);
  std::vector<std::uint8_t> walked(count), fast(count), embree(count);
  subject.grid_caster->visible(keys, walked, unknown);
  subject.fast->visible(keys, fast, unknown);
  subject.embree->visible(keys, embree, unknown);
  bad.check(
      count, [&](std::size_t i) { return walked[i] == fast[i] && walked[i] == embree[i]; },
      [&](std::size_t i) {
        std::ostringstream out;
        out << subject.map.name << ": keys (" << keys[i].from.x << ' ' << keys[i].from.y << ' '
            << keys[i].from.z << ") to (" << keys[i].to.x << ' ' << keys[i].to.y << ' ' << keys[i].to.z
            << ')';
        return out.str();
      });

  const auto segments = adversarial_segments(subject.grid, count, seed);
  subject.grid_caster->visible(segments, walked, unknown);
  subject.fast->visible(segments, fast, unknown);
  subject.embree->visible(segments, embree, unknown);
  bad.check(
      count,
      [&](std::size_t i) {
        if (walked[i] != fast[i] || walked[i] != embree[i]) return false;
        const auto from = subject.grid.lattice().key(segments[i].from),
                   to = subject.grid.lattice().key(segments[i].to);
        if (!from || !to) return walked[i] == 0;
        if (*from == *to) return walked[i] == 1;
        // Where castRay itself gives the answer.
        if (unknown == UnknownPolicy::kPass || subject.grid.at(*from) != Occupancy::kFree ||
            subject.grid.at(*to) == Occupancy::kFree)
          return true;
        octomap::point3d end;
        castray_of(*subject.map.tree, point_of(segments[i].from), point_of(segments[i].to - segments[i].from),
                   end, false);
        const Eigen::Vector3f stopped(end.x(), end.y(), end.z());
        return (walked[i] == 1) == (subject.grid.lattice().key(stopped) == to);
      },
      [&](std::size_t i) {
        return subject.map.name + ": segment " + words_of({segments[i].from, segments[i].to, 0.0});
      });
}

void expect_conforms(const NamedMap& map, std::size_t rays_per_policy) {
  SCOPED_TRACE(map.name);
  const Subject subject(map);
  Disagreements bad;
  for (const UnknownPolicy unknown : kPolicies)
    for (std::size_t done = 0; done < rays_per_policy; done += kBatch) {
      const std::size_t count = std::min(kBatch, rays_per_policy - done);
      expect_casts_conform(subject, count, done + 1, unknown, bad);
      expect_visibility_conforms(subject, count / 2, done + 2, unknown, bad);
    }
  EXPECT_EQ(bad.found(), 0U) << "of " << bad.checked();
  std::cout << map.name << ": " << bad.found() << " disagreements in " << bad.checked() << " rays\n";
}

TEST(Conformance, SmallMaps) {
  for (const NamedMap& map : small_maps()) expect_conforms(map, 30'000);
}

TEST(Conformance, ExtraMaps) {
  const auto maps = extra_maps();
  if (maps.empty()) GTEST_SKIP() << "FRONTLUX_EXTRA_MAPS names no folder with maps";
  for (const NamedMap& map : maps) expect_conforms(map, 50'000);
}

// Three million casts on every map, and as many looks.
TEST(ConformanceLong, AllMaps) {
  if (!long_mode()) GTEST_SKIP() << "set FRONTLUX_LONG=1";
  auto maps = small_maps();
  for (const NamedMap& map : extra_maps()) maps.push_back(map);
  const auto folder = std::filesystem::temp_directory_path() / "frontlux_maps";
  for (const std::string name : {"building_0.3m", "building_0.1m"}) {
    const auto file = synthetic::ensure_map(name, folder);
    maps.push_back({name, std::get<std::shared_ptr<octomap::OcTree>>(read_octree(file))});
  }
  for (const NamedMap& map : maps) expect_conforms(map, 1'500'000);
}

}  // namespace
}  // namespace frontlux::test
