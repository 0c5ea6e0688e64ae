#include "rays/subject.hpp"

#include "rays/castray_loop.hpp"

#include <frontlux/caster_kind.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <optional>
#include <stdexcept>

namespace frontlux::bench {
namespace {

template <class Build>
double median_seconds(Build&& build) {
  // The first time pays for pages that the allocator keeps afterwards.
  std::array<double, 3> seconds{};
  for (double& s : seconds) {
    const auto start = std::chrono::steady_clock::now();
    build();
    s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[1];
}

VoxelGrid mirror(const Octree& tree) {
  return std::visit([](const auto& octree) { return make_voxel_grid(*octree); }, tree);
}

}  // namespace

const Contender& Subject::contender(const std::string& caster) const {
  for (const Contender& c : contenders) {
    if (c.name == caster) return c;
  }
  throw std::invalid_argument("no caster named " + caster);
}

std::unique_ptr<Subject> make_subject(Octree tree, std::string name) {
  std::optional<VoxelGrid> grid;
  const double grid_seconds = median_seconds([&] {
    grid.reset();
    grid = mirror(tree);
  });
  auto subject =
      std::make_unique<Subject>(Subject{std::move(name), std::move(tree), *std::move(grid), {}, {}});

  // The baseline first: the others are compared with it.
  for (const CasterKind kind :
       {CasterKind::kOctomap, CasterKind::kGrid, CasterKind::kEmbree, CasterKind::kFast}) {
    Contender contender{std::string(name_of(kind)), nullptr};
    const double seconds = median_seconds([&] {
      contender.caster.reset();
      contender.caster = std::visit(
          [&](const auto& octree) { return make_ray_caster(kind, subject->grid, *octree); }, subject->tree);
    });
    if (kind != CasterKind::kOctomap) {
      contender.build_seconds = grid_seconds + seconds;
      contender.bytes = subject->grid.memory_bytes() + contender.caster->memory_bytes();
    }
    subject->contenders.push_back(std::move(contender));
  }
  return subject;
}

std::unique_ptr<Subject> load_subject(const std::filesystem::path& file, std::string name) {
  auto subject = make_subject(read_octree(file), std::move(name));
  std::visit([&](const auto& octree) { subject->drop_in = std::make_unique<OctreeRayCaster>(*octree); },
             subject->tree);
  return subject;
}

std::string describe(const Subject& subject) {
  const auto count = subject.grid.count();
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(),
                "%s: voxels of %.2f m, %.2f M free, %.2f M occupied, %.1f MB as OctoMap",
                subject.name.c_str(), subject.grid.resolution(), static_cast<double>(count[1]) * 1e-6,
                static_cast<double>(count[2]) * 1e-6, static_cast<double>(memory_bytes(subject.tree)) * 1e-6);
  std::string text = line.data();
  for (const Contender& c : subject.contenders) {
    if (c.bytes == 0) continue;
    std::snprintf(line.data(), line.size(), "; %s: built in %.1f ms, %.1f MB", c.name.c_str(),
                  c.build_seconds * 1e3, static_cast<double>(c.bytes) * 1e-6);
    text += line.data();
  }
  return text;
}

}  // namespace frontlux::bench
