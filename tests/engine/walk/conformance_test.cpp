// Every caster against OctoMap itself, ray by ray and bit by bit. The default mode takes a sample on every
// map; FRONTLUX_LONG=1 takes three million rays on each, the generated buildings and FRONTLUX_EXTRA_MAPS
// included.

#include "engine/embree/slab_oracle.hpp"
#include "rays/exact_visibility.hpp"
#include "support/casters.hpp"
#include "support/maps.hpp"
#include "support/octomap_answers.hpp"
#include "support/ray_samples.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/parallel.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <array>
#include <charconv>
#include <functional>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace frontlux::test {
namespace {

constexpr std::size_t kBatch = 50'000;
constexpr std::size_t kGrid = 2;  // place of the caster that the others are compared with

// Shortest decimals that give the same numbers.
std::string words_of(const Eigen::Vector3f& v) {
  std::string text;
  for (const float number : {v.x(), v.y(), v.z()}) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), number).ptr;
    if (!text.empty()) text += ',';
    text.append(digits.begin(), end);
  }
  return text;
}
std::string words_of(UnknownPolicy unknown) {
  return unknown == UnknownPolicy::kBlock ? " --unknown block" : " --unknown pass";
}
// As `frontlux cast` takes it.
std::string words_of(const Ray& ray, UnknownPolicy unknown) {
  std::ostringstream out;
  out << "--from " << words_of(ray.origin) << " --direction " << words_of(ray.direction)
      << std::setprecision(17);
  if (ray.max_range > 0.0) out << " --range " << ray.max_range;
  out << words_of(unknown);
  return out.str();
}
std::string words_of(const VoxelKey& key) {
  return std::to_string(key.x) + "," + std::to_string(key.y) + "," + std::to_string(key.z);
}
std::string words_of(const Hit& hit) {
  return "stop " + std::to_string(static_cast<int>(hit.stop)) + " at " + words_of(hit.end) + ", key " +
         words_of(hit.key);
}

bool same_bits(const Eigen::Vector3f& a, const octomap::point3d& b) {
  const float coordinates[] = {b.x(), b.y(), b.z()};
  return std::memcmp(a.data(), coordinates, sizeof(coordinates)) == 0;
}
octomap::point3d point_of(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }
Eigen::Vector3f vector_of(const octomap::point3d& p) { return {p.x(), p.y(), p.z()}; }

// Counts disagreements, and tells of the first few of them.
class Disagreements {
 public:
  // @param fault     what differs at an index; empty if nothing does
  // @param describe  the question
  void check(std::size_t count, const std::function<std::string(std::size_t)>& fault,
             const std::function<std::string(std::size_t)>& describe) {
    checked_ += count;
    std::vector<std::string> faults(count);
    for_each_index(count, [&](std::size_t i) { faults[i] = fault(i); });
    for (std::size_t i = 0; i < count; ++i)
      if (!faults[i].empty() && ++found_ <= 3) ADD_FAILURE() << describe(i) << faults[i];
  }
  [[nodiscard]] std::size_t found() const { return found_; }
  [[nodiscard]] std::size_t checked() const { return checked_; }

 private:
  std::size_t found_ = 0, checked_ = 0;
};

struct Subject {
  explicit Subject(const NamedMap& named) : map(named), casters(*map.tree), drop_in(*map.tree) {}
  NamedMap map;
  Casters casters;
  OctreeRayCaster drop_in;
};

// castRay tells neither entry nor distance: they are those of the ray and the voxel in which it ended. Since
// castRay counts in float, the voxel may be a little larger or smaller.
std::string fault_of_entry(const Lattice& lattice, const Ray& ray, const Hit& hit) {
  if (hit.stop == RayStop::kInvalid || !ray.direction.allFinite()) return "";
  using Exact = Eigen::Vector3<long double>;
  const auto exact = [](const Eigen::Vector3f& v) -> Exact { return v.cast<long double>(); };
  const Eigen::Vector3f &o = ray.origin, &d = ray.direction, middle = lattice.center(hit.key);
  const auto edge = static_cast<float>(lattice.resolution());
  const float center[] = {middle.x(), middle.y(), middle.z()}, half[] = {edge / 2, edge / 2, edge / 2},
              origin[] = {o.x(), o.y(), o.z()}, direction[] = {d.x(), d.y(), d.z()};
  const long double length = exact(d).norm(), distance = hit.distance,
                    leeway = 1e-6L * std::max({1.0L, distance, exact(o).cwiseAbs().maxCoeff()});  // [m]
  const auto entry = [&](long double larger) {
    return entry_time(center, half, larger, origin, direction, 0.0F, std::numeric_limits<float>::infinity());
  };
  const auto soonest = entry(leeway), latest = entry(-leeway);
  if (!soonest) return "\n  no entry";
  const bool is_between =
      distance >= *soonest * length - leeway && (!latest || distance <= *latest * length + leeway);
  const Exact beside = exact(hit.entry) - exact(o) - distance * exact(d).normalized();
  if (is_between && beside.cwiseAbs().maxCoeff() <= leeway) return "";
  return "\n  entry " + words_of(hit.entry) + " after " + std::to_string(hit.distance) +
         " m, but it is after " + std::to_string(*soonest * length) + " m";
}

// castRay's bool and `end` by the drop-in and by every caster. The casters also agree on what castRay does
// not return.
void expect_casts_conform(const Subject& subject, std::span<const Ray> rays, UnknownPolicy unknown,
                          Disagreements& bad) {
  const auto& all = subject.casters.all;
  std::vector<std::vector<Hit>> hits;
  for (const auto& [name, caster] : all) caster->cast(rays, hits.emplace_back(rays.size()), unknown);
  const bool ignore_unknown = unknown == UnknownPolicy::kPass;
  bad.check(
      rays.size(),
      [&](std::size_t i) {
        const octomap::point3d origin = point_of(rays[i].origin), direction = point_of(rays[i].direction);
        const octomap::point3d untouched(1e20F, -2e20F, 3e20F);
        octomap::point3d end = untouched, drop_in_end = untouched;
        const bool hit =
            castray_of(*subject.map.tree, origin, direction, end, ignore_unknown, rays[i].max_range);
        const bool drop_in_hit =
            subject.drop_in.castRay(origin, direction, drop_in_end, ignore_unknown, rays[i].max_range);
        const Hit& walked = hits[kGrid][i];
        const Eigen::Vector3f expected = walked.stop == RayStop::kInvalid ? vector_of(untouched) : walked.end;
        std::string fault;
        if (hit != walked.occupied() || !same_bits(expected, end))
          fault += "\n  castRay " + std::to_string(hit) + " at " + words_of(vector_of(end));
        if (drop_in_hit != hit || !same_bits(vector_of(end), drop_in_end))
          fault +=
              "\n  the drop-in " + std::to_string(drop_in_hit) + " at " + words_of(vector_of(drop_in_end));
        for (std::size_t c = 0; c < all.size(); ++c) {
          if (!same(walked, hits[c][i])) fault += "\n  " + all[c].first + " " + words_of(hits[c][i]);
          Eigen::Vector3f own_end = vector_of(untouched);
          if (all[c].second->cast(rays[i], unknown, own_end) != walked.stop ||
              !same_bits(expected, point_of(own_end)))
            fault += "\n  " + all[c].first + ", asked for the end alone, at " + words_of(own_end);
        }
        fault += fault_of_entry(subject.casters.grid.lattice(), rays[i], walked);
        return fault.empty() ? fault : "\n  grid " + words_of(walked) + fault;
      },
      [&](std::size_t i) { return subject.map.name + ": " + words_of(rays[i], unknown); });
}

// Whether the casters see what the walk over the grid sees, and that is what it should be.
template <class Line>
void expect_looks_conform(const Subject& subject, std::span<const Line> segments, UnknownPolicy unknown,
                          const std::function<bool(const Line&, bool walked)>& is_right, Disagreements& bad) {
  const auto all = std::span(subject.casters.all).first(kGrid + 1);  // not OctoMap's, which rounds
  std::vector<std::vector<std::uint8_t>> seen;
  for (const auto& [name, caster] : all)
    caster->visible(segments, seen.emplace_back(segments.size()), unknown);
  bad.check(
      segments.size(),
      [&](std::size_t i) {
        const bool walked = seen[kGrid][i] != 0;
        std::string fault;
        if (!is_right(segments[i], walked)) fault += "\n  castRay, or the rule, does not agree";
        for (std::size_t c = 0; c < kGrid; ++c)
          if (seen[c][i] != seen[kGrid][i]) fault += "\n  " + all[c].first + " does not agree";
        return fault.empty() ? fault : "\n  grid " + std::to_string(walked) + fault;
      },
      [&](std::size_t i) {
        return subject.map.name + ": from " + words_of(segments[i].from) + " to " + words_of(segments[i].to) +
               words_of(unknown);
      });
}

void expect_visibility_conforms(const Subject& subject, std::size_t count, std::uint64_t seed,
                                UnknownPolicy unknown, Disagreements& bad) {
  const VoxelGrid& grid = subject.casters.grid;
  // castRay rounds between voxels: there the integer rule is the judge, of each segment by itself.
  const auto keys = adversarial_key_segments(grid, count, seed);
  expect_looks_conform<KeySegment>(
      subject, keys, unknown,
      [&](const KeySegment& segment, bool walked) {
        std::uint8_t visible = 0;
        bench::exact_visibility(grid, {&segment, 1}, {&visible, 1}, unknown);
        return walked == (visible != 0);
      },
      bad);

  const auto segments = adversarial_segments(grid, count, seed);
  expect_looks_conform<Segment>(
      subject, segments, unknown,
      [&](const Segment& segment, bool walked) {
        const auto from = grid.lattice().key(segment.from), to = grid.lattice().key(segment.to);
        if (!from || !to) return !walked;
        if (*from == *to) return walked;
        // Where castRay itself gives the answer.
        if (unknown == UnknownPolicy::kPass || grid.at(*from) != Occupancy::kFree ||
            grid.at(*to) == Occupancy::kFree)
          return true;
        octomap::point3d end;
        castray_of(*subject.map.tree, point_of(segment.from), point_of(segment.to - segment.from), end,
                   false);
        return walked == (grid.lattice().key(vector_of(end)) == to);
      },
      bad);
}

// Says how many disagreements there are, and keeps the map if there are some.
void report(const NamedMap& map, const Disagreements& bad) {
  std::cout << map.name << ": " << bad.found() << " disagreements in " << bad.checked() << " rays\n";
  if (bad.found() == 0) return;
  const std::string file =
      testing::TempDir() + "conformance_" + std::to_string(getpid()) + "_" + map.name + ".ot";
  ADD_FAILURE() << bad.found() << " of " << bad.checked() << "; the map is in " << file
                << (map.tree->write(file) ? "" : ", which could not be written");
}

void expect_conforms(const NamedMap& map, std::size_t rays_per_policy) {
  const Subject subject(map);
  Disagreements bad;
  for (const UnknownPolicy unknown : kPolicies)
    for (std::size_t done = 0; done < rays_per_policy; done += kBatch) {
      const std::size_t count = std::min(kBatch, rays_per_policy - done);
      expect_casts_conform(subject, adversarial_rays(subject.casters.grid, count, done + 1), unknown, bad);
      expect_visibility_conforms(subject, count / 2, done + 2, unknown, bad);
    }
  report(map, bad);
}

// Rays along which voxels are left by an edge or a corner, so that steps tie: from inside of a voxel, from
// its corner, and backwards. Rays that a test has found to be answered wrongly belong here, too.
TEST(Conformance, KnownRays) {
  const std::vector<Ray> rays = {
      {{0.05F, 0.05F, 0.05F}, {1.0F, 1.0F, 1.0F}, 3.0},   {{0.05F, 0.05F, 0.05F}, {-1.0F, -1.0F, 0.0F}, 3.0},
      {{0.05F, 0.15F, 0.05F}, {1.0F, 0.0F, -1.0F}, -1.0}, {{0.1F, 0.1F, 0.1F}, {1.0F, 1.0F, 1.0F}, 3.0},
      {{0.1F, 0.1F, 0.1F}, {-1.0F, 1.0F, -1.0F}, -1.0},   {{0.0F, 0.0F, 0.0F}, {0.0F, -1.0F, 0.0F}, 1.0},
      {{0.25F, 0.05F, 0.15F}, {2.0F, 1.0F, 1.0F}, 0.5},
  };
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const NamedMap map{"noise_" + std::to_string(seed), make_noise_tree(seed, 0.1, 6)};
    const Subject subject(map);
    Disagreements bad;
    for (const UnknownPolicy unknown : kPolicies) expect_casts_conform(subject, rays, unknown, bad);
    report(map, bad);
  }
}

TEST(Conformance, SmallMaps) {
  for (const NamedMap& map : small_maps()) expect_conforms(map, 15'000);
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
