#include "commands/info_command.hpp"

#include "frontier_count.hpp"
#include "json.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace frontlux::app {
namespace {

// A few seconds of counting.
constexpr std::uint64_t kMaxSurfaceBricks = std::uint64_t{1} << 24;

struct Options {
  std::string map;
  bool json = false;
};

struct Info {
  TreeSize tree;
  std::uint64_t mirror_bytes = 0;
  std::optional<KeyBox> bounds;
  std::uint64_t occupied = 0, free = 0, unknown = 0;  // unknown: inside the bounds
  std::optional<std::uint64_t> frontiers;
};

Info gather(const MapFile& map) {
  const VoxelGrid grid = make_voxel_grid(map);
  Info info;
  info.tree = tree_size(map);
  info.mirror_bytes = grid.memory_bytes();
  info.bounds = grid.known_bounds();
  const auto voxels = grid.count();
  info.occupied = voxels[static_cast<std::size_t>(Occupancy::kOccupied)];
  info.free = voxels[static_cast<std::size_t>(Occupancy::kFree)];
  info.frontiers = 0;
  if (info.bounds) {
    const auto edge = [](int min, int max) { return static_cast<std::uint64_t>(max - min + 1); };
    const auto& [min, max] = *info.bounds;
    info.unknown = edge(min.x, max.x) * edge(min.y, max.y) * edge(min.z, max.z) - info.occupied - info.free;
    info.frontiers = count_frontiers(grid, *info.bounds, kMaxSurfaceBricks);
  }
  return info;
}

// Corner [m] at the lower or, with one voxel added, the upper end of a box.
Eigen::Vector3d corner(const VoxelKey& key, int added, double resolution) {
  const auto along = [&](int k) { return (k + added - Lattice::kOrigin) * resolution; };
  return {along(key.x), along(key.y), along(key.z)};
}

constexpr const char* kNotCounted = "not counted: the map's large free blocks have too wide a surface";

void print_text(const MapFile& map, const Info& info) {
  std::string out = row("map", map.path.string() + " (" + map.tree_type + ")") +
                    row("resolution", rounded(map.resolution) + " m");
  if (info.bounds) {
    const Eigen::Vector3d min = corner(info.bounds->min, 0, map.resolution),
                          max = corner(info.bounds->max, 1, map.resolution);
    const auto axis = [&](const char* label, int i, int key_min, int key_max) {
      return row(label, rounded(min[i]) + " to " + rounded(max[i]) + " m, keys " + std::to_string(key_min) +
                            " to " + std::to_string(key_max));
    };
    const auto& [low, high] = *info.bounds;
    out += axis("bounds x", 0, low.x, high.x) + axis("       y", 1, low.y, high.y) +
           axis("       z", 2, low.z, high.z);
  } else {
    out += row("bounds", "none: every voxel is unknown");
  }
  out += row("occupied", std::to_string(info.occupied) + " voxels") +
         row("free", std::to_string(info.free) + " voxels") +
         row("unknown", std::to_string(info.unknown) + " voxels within the bounds") +
         row("frontiers", info.frontiers ? std::to_string(*info.frontiers) +
                                               " unknown voxels within the bounds beside a free one"
                                         : kNotCounted) +
         row("leaves", std::to_string(info.tree.leaves)) +
         row("inner nodes", std::to_string(info.tree.inner_nodes)) +
         row("memory",
             "tree " + to_text_bytes(info.tree.bytes) + ", mirror " + to_text_bytes(info.mirror_bytes));
  std::cout << out;
}

void print_json(const MapFile& map, const Info& info) {
  JsonObject out;
  out.add("map", map.path.string()).add("tree", map.tree_type).add("resolution_m", map.resolution);
  if (info.bounds)
    out.add("bounds", JsonObject()
                          .add("min_m", corner(info.bounds->min, 0, map.resolution))
                          .add("max_m", corner(info.bounds->max, 1, map.resolution))
                          .add("min_key", info.bounds->min)
                          .add("max_key", info.bounds->max));
  else
    out.add_null("bounds");
  out.add("voxels",
          JsonObject().add("occupied", info.occupied).add("free", info.free).add("unknown", info.unknown));
  if (info.frontiers)
    out.add("frontiers", *info.frontiers);
  else
    out.add_null("frontiers").add("frontiers_note", kNotCounted);
  out.add("leaves", info.tree.leaves)
      .add("inner_nodes", info.tree.inner_nodes)
      .add("memory_bytes", JsonObject().add("tree", info.tree.bytes).add("mirror", info.mirror_bytes));
  std::cout << out.text() << '\n';
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Say what a map holds");
  const auto options = std::make_shared<Options>();
  command->add_option("MAP", options->map, "OctoMap file, .bt or .ot")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Example:\n"
      "  frontlux info building.bt\n"
      "prints the map's resolution, the box that holds all known voxels, how many voxels of each state\n"
      "that box holds, how many of the unknown ones are frontiers, and what the map takes in memory.");
  command->callback([options] {
    const MapFile map = read_map_file(options->map);
    const Info info = gather(map);
    options->json ? print_json(map, info) : print_text(map, info);
  });
}

}  // namespace frontlux::app
