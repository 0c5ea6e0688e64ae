// What each part of the path optimiser contributes: methods that choose yaws, side by side on random paths.

#include "options.hpp"
#include "paths/ablation.hpp"
#include "rays/subject.hpp"
#include "table.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/octomap.hpp>

#include <tbb/task_arena.h>

#include <algorithm>
#include <iostream>
#include <span>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

/// The results of one method on all paths of some maps.
struct Summary {
  double distinct = 0.0, tangent = 0.0;  // means
  double evaluations = 0.0;              // mean
  int most_evaluations = 0;
  std::size_t paths = 0, worse_than_tangent = 0;
  std::vector<double> seconds;

  Summary(std::span<const MapTrial> maps, std::size_t method) {
    for (const MapTrial& map : maps)
      for (const PathTrial& path : map.paths) {
        const YawTrial &trial = path.by_method[method], &along = path.by_method.front();
        distinct += static_cast<double>(trial.distinct);
        tangent += static_cast<double>(along.distinct);
        evaluations += trial.evaluations;
        most_evaluations = std::max(most_evaluations, trial.evaluations);
        worse_than_tangent += static_cast<std::size_t>(trial.distinct < along.distinct);
        seconds.push_back(trial.seconds);
      }
    paths = seconds.size();
    distinct /= static_cast<double>(paths);
    tangent /= static_cast<double>(paths);
    evaluations /= static_cast<double>(paths);
  }
  [[nodiscard]] double gain() const { return tangent > 0.0 ? distinct / tangent : 1.0; }
};

std::string milliseconds(const char* pattern, double seconds) {
  return format(pattern, 1e3 * seconds) + " ms";
}

std::string methods_table(std::span<const MapTrial> maps) {
  std::vector<std::string> names{"yaws"};
  for (const MapTrial& map : maps) names.push_back(map.name);
  names.insert(names.end(), {"x tangent", "fewer than tangent", "time", "evaluations, mean (max)"});
  Table table;
  table.add_columns("", names);
  const auto methods = yaw_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Summary all(maps, m);
    std::vector<std::string> row{std::string(methods[m].name)};
    for (const MapTrial& map : maps) row.push_back(format("%.0f", Summary({&map, 1}, m).distinct));
    row.insert(row.end(),
               {format("%.2f", all.gain()),
                std::to_string(all.worse_than_tangent) + " of " + std::to_string(all.paths),
                milliseconds("%.2f", median(all.seconds)),
                format("%.0f", all.evaluations) + " (" + std::to_string(all.most_evaluations) + ")"});
    table.add_row(std::move(row));
  }
  return table.markdown();
}

std::string maps_table(std::span<const MapTrial> maps) {
  Table table;
  table.add_columns("", {"map", "frontiers", "pairs, median (max)", "visibility, median (max)"});
  for (const MapTrial& map : maps) {
    std::vector<double> pairs, seconds;
    for (const PathTrial& path : map.paths) {
      pairs.push_back(static_cast<double>(path.pairs));
      seconds.push_back(path.visibility_seconds);
    }
    table.add_row({map.name, std::to_string(map.frontiers),
                   format("%.0f", median(pairs)) + format(" (%.0f)", *std::ranges::max_element(pairs)),
                   milliseconds("%.2f", median(seconds)) + " (" +
                       milliseconds("%.2f", *std::ranges::max_element(seconds)) + ")"});
  }
  return table.markdown();
}

std::string large_table(const PathTrial& large) {
  Table table;
  table.add_columns("", {"yaws", "distinct", "time", "evaluations"});
  const auto methods = yaw_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const YawTrial& trial = large.by_method[m];
    table.add_row({std::string(methods[m].name), std::to_string(trial.distinct),
                   milliseconds("%.1f", trial.seconds), std::to_string(trial.evaluations)});
  }
  return table.markdown();
}

/// The page: what was measured, methods and maps, the cost of each path, a summary.
std::string page_of(std::span<const MapTrial> maps, const PathTrial& large) {
  const auto gain = [&](std::string_view name) {
    const auto methods = yaw_methods();
    const auto found = std::ranges::find(methods, name, &YawMethod::name);
    return format("%.2f x", Summary(maps, static_cast<std::size_t>(found - methods.begin())).gain());
  };
  return R"(# What each part of the path optimiser contributes

Written by `./dev ablation`. Times are medians of processor time on one core ()" +
         processor_name() + R"().

)" + std::to_string(maps.front().paths.size()) +
         R"( random walks on each map, through known free space, with 12 viewpoints 1.2 m apart and a free cube of 0.8 m
about every point. Camera 90 x 72 degrees, 10 m. The first and the last yaw are fixed, along the path. A cell is the
mean number of distinct frontiers in view of a path. A frontier is in view if the field of view contains it and no
unknown or occupied voxel hides it. All methods but the first return the tangent's yaws where those see more, and never
a result that sees less than their start. Evaluations are of the differentiable gain; three of them are for the report.

)" + methods_table(maps) +
         R"(
## The paths

Pairs of a viewpoint and a frontier that it sees at some yaw, and the time to find them by rays.

)" + maps_table(maps) +
         R"(
## A path with many frontiers

12 viewpoints, )" +
         std::to_string(large.pairs) + " pairs, found by rays in " +
         milliseconds("%.2f", large.visibility_seconds) +
         R"(, along the middle of a free box of 18 x 5.6 x 4 m in voxels of 0.2 m, surrounded by unknown space.

)" + large_table(large) +
         R"(
## Summary

Frontiers in view, against the tangent's: each viewpoint at its best bin )" +
         gain("best of 24 bins") + "; greedy bins, chosen together, " + gain("greedy among 24 bins") +
         ".\nThe gradient alone, from the tangent: " + gain("tangent, Ipopt, SUM (paper)") + " by SUM, " +
         gain("tangent, Ipopt, OR") + " by OR. The gradient after the greedy start:\n" +
         gain("greedy among 24 bins, Ipopt, OR (default)") +
         "; 60 bins instead of 24, without any gradient: " + gain("greedy among 60 bins") + ".\n";
}

}  // namespace

int run(int argc, char** argv) {
  const PathsOptions options = read_paths_options(argc, argv);
  auto files = options.maps;
  files.insert(files.begin(), generate_map("building_0.3m", options.cache));
  std::vector<MapTrial> maps;
  PathTrial large;
  tbb::task_arena(1).execute([&] {
    for (const auto& file : files) {
      maps.push_back(run_ablation(file.stem().string(), make_voxel_grid(read_octree(file)), options.seeds));
    }
    large = run_large_path();
  });
  const std::string page = page_of(maps, large);
  std::cout << page;
  if (!options.table.empty()) write_file(options.table, page);
  return 0;
}

}  // namespace frontlux::bench
