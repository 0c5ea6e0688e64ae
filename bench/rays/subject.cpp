#include "rays/subject.hpp"

#include "rays/castray_loop.hpp"
#include "table.hpp"

#include <frontlux/caster_kind.hpp>
#include <frontlux/stopwatch.hpp>
#include <frontlux/synthetic/maps.hpp>

#include <iostream>
#include <optional>
#include <stdexcept>

namespace frontlux::bench {
namespace {

template <class Build>
double median_seconds(Build&& build) {
  // The first time pays for pages that the allocator keeps afterwards.
  std::vector<double> seconds(3);
  for (double& s : seconds) {
    const Stopwatch watch;
    build();
    s = watch.seconds();
  }
  return median(std::move(seconds));
}

}  // namespace

const RayCaster& Subject::caster(const std::string& caster) const {
  for (const Contender& c : contenders)
    if (c.caster == caster) return *c.rays;
  throw std::invalid_argument("no caster named " + caster);
}

std::unique_ptr<Subject> make_subject(Octree tree, std::string name) {
  std::optional<VoxelGrid> grid;
  const double grid_seconds = median_seconds([&] {
    grid.reset();
    grid = make_voxel_grid(tree);
  });
  auto subject =
      std::make_unique<Subject>(Subject{std::move(name), std::move(tree), *std::move(grid), {}, {}});
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
    }
    subject->contenders.push_back(std::move(contender));
  }
  return subject;
}

std::unique_ptr<Subject> load_subject(const std::filesystem::path& file, std::string name) {
  auto subject = make_subject(read_octree(file), std::move(name));
  subject->drop_in = std::make_unique<OctreeRayCaster>(subject->tree);
  return subject;
}

std::string describe(const Subject& subject) {
  const auto millions = [](auto count) { return format("%.2f M", static_cast<double>(count) * 1e-6); };
  const auto megabytes = [](std::size_t bytes) {
    return format("%.1f MB", static_cast<double>(bytes) * 1e-6);
  };
  const auto count = subject.grid.count();
  std::string text = subject.name + ": voxels of " + format("%.2f m, ", subject.grid.resolution()) +
                     millions(count[1]) + " free, " + millions(count[2]) + " occupied, " +
                     megabytes(memory_bytes(subject.tree)) + " as OctoMap";
  for (const Contender& c : subject.contenders)
    if (c.bytes != 0)
      text +=
          "; " + c.caster + ": built in " + format("%.1f ms, ", c.build_seconds * 1e3) + megabytes(c.bytes);
  return text;
}

std::filesystem::path generate_map(const std::string& name, const std::filesystem::path& cache) {
  bool shown = false;
  const auto file = synthetic::ensure_map(name, cache, [&](std::string_view text) {
    std::cerr << '\r' << text << std::flush;
    shown = true;
  });
  if (shown) std::cerr << std::endl;
  return file;
}

}  // namespace frontlux::bench
