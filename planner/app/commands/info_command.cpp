#include "command.hpp"
#include "commands/commands.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <frontlux/sim/ground_truth.hpp>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace frontlux::app {
namespace {

struct InfoOptions {
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
  const VoxelGrid grid = make_grid(map);
  Info info;
  info.tree = tree_size(map);
  info.mirror_bytes = grid.memory_bytes();
  info.bounds = grid.known_bounds();
  const auto voxels = grid.count();
  info.occupied = voxels[static_cast<std::size_t>(Occupancy::kOccupied)];
  info.free = voxels[static_cast<std::size_t>(Occupancy::kFree)];
  info.frontiers = 0;
  if (info.bounds) {
    info.unknown = size_of(*info.bounds) - info.occupied - info.free;
    if (info.unknown != 0) {
      const auto frontiers = find_frontiers(map, grid, *info.bounds);
      info.frontiers = frontiers ? std::optional(std::uint64_t{frontiers->size()}) : std::nullopt;
    }
  }
  return info;
}

constexpr const char* kNotCounted = "not counted: the surface of the map's large free blocks is too large";

void print_text(const MapFile& map, const Info& info) {
  std::string out = row("map", map.path.string() + " (" + map.tree_type + ")") +
                    row("resolution", rounded(map.resolution) + " m");
  if (info.bounds) {
    const Lattice lattice(map.resolution);
    const auto axis = [&](const char* label, int low, int high) {
      return row(label, rounded(sim::lower_face(lattice, low)) + " to " +
                            rounded(sim::lower_face(lattice, high + 1)) + " m, keys " + std::to_string(low) +
                            " to " + std::to_string(high));
    };
    const auto& [low, high] = *info.bounds;
    out +=
        axis("bounds x", low.x, high.x) + axis("       y", low.y, high.y) + axis("       z", low.z, high.z);
  } else {
    out += row("bounds", "none: every voxel is unknown");
  }
  out += row("occupied", std::to_string(info.occupied) + " voxels") +
         row("free", std::to_string(info.free) + " voxels") +
         row("unknown", std::to_string(info.unknown) + " voxels within the bounds") +
         row("frontiers", info.frontiers
                              ? std::to_string(*info.frontiers) +
                                    " (unknown voxels within the bounds that share a face with a free one)"
                              : kNotCounted) +
         row("leaves", std::to_string(info.tree.leaves)) +
         row("inner nodes", std::to_string(info.tree.inner_nodes)) +
         row("memory", "tree " + bytes_text(info.tree.bytes) + ", mirror " + bytes_text(info.mirror_bytes));
  std::cout << out;
}

void print_json(const MapFile& map, const Info& info) {
  nlohmann::ordered_json out = {{"map", map.path.string()},
                                {"tree", map.tree_type},
                                {"resolution_m", map.resolution},
                                {"bounds", nullptr}};
  if (info.bounds) {
    const auto& [min, max] = *info.bounds;
    const auto face = [lattice = Lattice(map.resolution)](int k) { return sim::lower_face(lattice, k); };
    out["bounds"] = {{"min_m", {face(min.x), face(min.y), face(min.z)}},
                     {"max_m", {face(max.x + 1), face(max.y + 1), face(max.z + 1)}},
                     {"min_key", {min.x, min.y, min.z}},
                     {"max_key", {max.x, max.y, max.z}}};
  }
  out["voxels"] = {{"occupied", info.occupied}, {"free", info.free}, {"unknown", info.unknown}};
  out["frontiers"] = nullptr;
  if (info.frontiers)
    out["frontiers"] = *info.frontiers;
  else
    out["frontiers_note"] = kNotCounted;
  out["leaves"] = info.tree.leaves;
  out["inner_nodes"] = info.tree.inner_nodes;
  out["memory_bytes"] = {{"tree", info.tree.bytes}, {"mirror", info.mirror_bytes}};
  // File names are bytes, JSON is Unicode.
  std::cout << out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

}  // namespace

void add_info_command(CLI::App& app) {
  Command command(app, "info", "Print what a map holds");
  const auto options = std::make_shared<InfoOptions>();
  command.add("MAP", options->map, "", "OctoMap file, .bt or .ot").required();
  command.add_flag("--json", options->json, "Print one JSON object");
  command.examples(R"(Example:
  frontlux info building.bt
prints the map's resolution, the box that holds all known voxels, the number of voxels of each state
and of frontiers in that box, and the memory that the map takes.)");
  command.run([options] {
    const MapFile map = read_map_file(options->map);
    const Info info = gather(map);
    options->json ? print_json(map, info) : print_text(map, info);
  });
}

}  // namespace frontlux::app
