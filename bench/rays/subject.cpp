#include "rays/subject.hpp"

#include "maps/filled_maps.hpp"
#include "maps/octree.hpp"
#include "rays/castray_loop.hpp"
#include "rays/free_voxels.hpp"
#include "table.hpp"

#include <frontlux/caster_kind.hpp>
#include <frontlux/stopwatch.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace frontlux::bench {
namespace {

constexpr std::size_t kLooks = 12, kPlaces = 20'000;  // that are drawn all over the map
constexpr double kLookRange = 6.0;                    // [m]
constexpr double kMostVoxels = 60.0;                  // of the range, in maps finer than 0.1 m
constexpr std::uint64_t kLookPlace = 301;             // stream of random numbers

// With more, the surfaces of free space alone would fill the memory; such a file is not the map of a place.
constexpr std::uint64_t kMaxKnownVoxels = std::uint64_t{1} << 34U;

// [voxels]
double look_range(const VoxelGrid& grid) { return std::min(kLookRange / grid.resolution(), kMostVoxels); }

// What a look all around shows.
std::vector<VoxelKey> seen_from(const VoxelKey& place, const VoxelGrid& grid, const RayCaster& caster) {
  const double range = look_range(grid);
  std::vector<KeySegment> segments;
  for_each_key(grown({place, place}, static_cast<int>(range)), [&](const VoxelKey& key) {
    const Eigen::Vector3d offset(key.x - place.x, key.y - place.y, key.z - place.z);
    if (offset.norm() <= range && grid.at(key) != Occupancy::kUnknown) segments.push_back({place, key});
  });
  std::vector<std::uint8_t> visible(segments.size());
  caster.visible(std::span<const KeySegment>(segments), visible, UnknownPolicy::kBlock);
  std::vector<VoxelKey> seen;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (visible[i] != 0) seen.push_back(segments[i].to);
  return seen;
}

// From where looks are taken: from places that are no farther from one of them than a look reaches, along
// each axis, as by a robot on its way. So each map shows as much that is new, whatever its size.
std::vector<VoxelKey> look_places(const VoxelGrid& grid) {
  std::vector<VoxelKey> near, places;
  const auto drawn = sample_free_voxels(grid, kPlaces, std::nullopt, kLookPlace);
  if (drawn.empty()) return places;
  const VoxelKey middle = drawn[drawn.size() / 2];
  const KeyBox box = grown({middle, middle}, static_cast<int>(look_range(grid)));
  std::ranges::copy_if(drawn, std::back_inserter(near),
                       [&](const VoxelKey& key) { return box.contains(key); });
  const std::size_t count = std::min(kLooks, near.size());
  for (std::size_t i = 0; i < count; ++i) places.push_back(near[i * near.size() / count]);
  return places;
}

// A map that is complete but for what some looks show, and then after each of them.
struct Looks {
  std::vector<VoxelGrid> maps;
  std::vector<double> voxels;  // that each one has shown
};

Looks make_looks(const VoxelGrid& grid) {
  const auto caster = make_grid_ray_caster(grid);
  Looks looks{{grid}, {}};
  for (const VoxelKey& place : look_places(grid)) {
    VoxelGrid before = looks.maps.back();
    double voxels = 0.0;
    for (const VoxelKey& key : seen_from(place, grid, *caster)) {
      voxels += before.at(key) == Occupancy::kUnknown ? 0.0 : 1.0;
      before.set(key, Occupancy::kUnknown);
    }
    looks.maps.push_back(std::move(before));
    looks.voxels.push_back(voxels);
  }
  std::ranges::reverse(looks.maps);
  return looks;
}

// How long it takes to follow a look. The first one is not counted: it may set up what the others use.
double update_seconds(CasterKind kind, const Subject& subject, const Looks& looks) {
  const auto rays = make_ray_caster(kind, looks.maps.front(), subject.tree);
  std::vector<double> seconds;
  for (std::size_t i = 1; i < looks.maps.size(); ++i) {
    const Stopwatch watch;
    rays->update(looks.maps[i]);
    if (i > 1) seconds.push_back(watch.seconds());
  }
  return seconds.empty() ? 0.0 : median(std::move(seconds));
}

std::string megabytes(std::size_t bytes) { return format("%.1f MB", static_cast<double>(bytes) * 1e-6); }

}  // namespace

const RayCaster& Subject::caster(const std::string& caster) const {
  for (const Contender& c : contenders)
    if (c.caster == caster) return *c.rays;
  throw std::invalid_argument("no caster named " + caster);
}

std::string unique_name(const std::filesystem::path& file, std::set<std::string>& taken) {
  const std::string stem = file.stem().string();
  std::string name = stem;
  for (int number = 2; !taken.insert(name).second; ++number) name = stem + "_" + std::to_string(number);
  return name;
}

double median_seconds(const std::function<void()>& build) {
  std::vector<double> seconds(3);
  for (double& s : seconds) {
    const Stopwatch watch;
    build();
    s = watch.seconds();
  }
  return median(std::move(seconds));
}

std::unique_ptr<Subject> make_subject(Octree tree, std::string name) {
  std::optional<VoxelGrid> grid;
  const double grid_seconds = median_seconds([&] {
    grid.reset();
    grid = make_voxel_grid(tree);
  });
  auto subject = std::make_unique<Subject>(
      Subject{std::move(name), std::move(tree), *std::move(grid), grid_seconds, {}, 0, {}});
  const Looks looks = make_looks(subject->grid);
  if (!looks.voxels.empty()) subject->look_voxels = median(looks.voxels);
  // The baseline first: the others are compared with it.
  for (const CasterKind kind :
       {CasterKind::kOctomap, CasterKind::kFast, CasterKind::kEmbree, CasterKind::kGrid}) {
    Contender contender{{std::string(name_of(kind))}, nullptr};
    const double seconds = median_seconds([&] {
      contender.rays.reset();
      contender.rays = make_ray_caster(kind, subject->grid, subject->tree);
    });
    if (kind != CasterKind::kOctomap) {
      contender.build_seconds = grid_seconds + seconds;
      contender.bytes = subject->grid.memory_bytes() + contender.rays->memory_bytes();
      contender.update_seconds = update_seconds(kind, *subject, looks);
    }
    subject->contenders.push_back(std::move(contender));
  }
  return subject;
}

void check_is_place(const VoxelGrid& grid, const std::filesystem::path& file) {
  const auto count = grid.count();
  const std::uint64_t known = count[static_cast<std::size_t>(Occupancy::kFree)] +
                              count[static_cast<std::size_t>(Occupancy::kOccupied)];
  if (known > kMaxKnownVoxels)
    throw std::runtime_error(file.string() + ": declares " + std::to_string(known) +
                             " voxels, too many to be a place; give another map");
}

std::unique_ptr<Subject> load_subject(const std::filesystem::path& file, std::string name) {
  Octree tree = read_octree(file);
  check_is_place(make_voxel_grid(tree), file);
  auto subject = make_subject(std::move(tree), std::move(name));
  subject->drop_in = std::make_unique<OctreeRayCaster>(subject->tree);
  return subject;
}

std::string describe(const CasterCost& cost) {
  return format("built in %.1f ms, ", cost.build_seconds * 1e3) + megabytes(cost.bytes);
}

std::string describe(const Subject& subject) {
  const auto millions = [](auto count) { return format("%.2f M", static_cast<double>(count) * 1e-6); };
  const auto count = subject.grid.count();
  std::string text = subject.name + ": voxels of " + format("%.2f m, ", subject.grid.resolution()) +
                     millions(count[1]) + " free, " + millions(count[2]) + " occupied, " +
                     megabytes(memory_bytes(subject.tree)) + " as OctoMap";
  for (const Contender& c : subject.contenders) {
    if (c.caster == kOctomap) continue;
    text += "; " + c.caster + ": " + describe(static_cast<const CasterCost&>(c));
    // The grid is the map itself.
    if (c.caster != kGrid) text += format(", follows a look in %.2f ms", c.update_seconds * 1e3);
  }
  return text + format("; a look shows %.0f voxels", subject.look_voxels);
}

std::filesystem::path generate_map(const std::string& name, const std::filesystem::path& cache) {
  if (name == kSite) {
    const auto file = cache / (name + ".bt");
    if (std::filesystem::exists(file)) return file;
    std::filesystem::create_directories(cache);
    write_octree(*make_octree(make_site()), file);
    return file;
  }
  bool shown = false;
  const auto file = synthetic::ensure_map(name, cache, [&](std::string_view text) {
    std::cerr << '\r' << text << std::flush;
    shown = true;
  });
  if (shown) std::cerr << std::endl;
  return file;
}

}  // namespace frontlux::bench
