#include "paths/table.hpp"

#include "text.hpp"

#include <algorithm>
#include <vector>

namespace frontlux::bench {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// What one method did on all paths of some maps.
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

void print_methods(std::span<const MapTrial> maps, std::ostream& out) {
  const auto methods = yaw_methods();
  out << "| yaws |";
  for (const MapTrial& map : maps) out << ' ' << map.name << " |";
  out << " x tangent | fewer than tangent | time | evaluations, mean (most) |\n|---|";
  for (std::size_t i = 0; i < maps.size() + 4; ++i) out << "---:|";
  out << '\n';
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Summary all(maps, m);
    out << "| " << methods[m].name << " |";
    for (const MapTrial& map : maps) out << ' ' << cell("%.0f", Summary({&map, 1}, m).distinct) << " |";
    out << ' ' << cell("%.2f", all.gain()) << " | " << all.worse_than_tangent << " of " << all.paths << " | "
        << cell("%.2f", 1e3 * median(all.seconds)) << " ms | " << cell("%.0f", all.evaluations) << " ("
        << all.most_evaluations << ") |\n";
  }
}

void print_maps(std::span<const MapTrial> maps, std::ostream& out) {
  out << "| map | frontiers | pairs, median (most) | visibility, median (most) |\n|---|---:|---:|---:|\n";
  for (const MapTrial& map : maps) {
    std::vector<double> pairs, seconds;
    for (const PathTrial& path : map.paths) {
      pairs.push_back(static_cast<double>(path.pairs));
      seconds.push_back(path.visibility_seconds);
    }
    out << "| " << map.name << " | " << map.frontiers << " | " << cell("%.0f", median(pairs)) << " ("
        << cell("%.0f", *std::max_element(pairs.begin(), pairs.end())) << ") | "
        << cell("%.2f", 1e3 * median(seconds)) << " ms ("
        << cell("%.2f", 1e3 * *std::max_element(seconds.begin(), seconds.end())) << " ms) |\n";
  }
}

void print_large(const PathTrial& large, std::ostream& out) {
  const auto methods = yaw_methods();
  out << "| yaws | distinct | time | evaluations |\n|---|---:|---:|---:|\n";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const YawTrial& trial = large.by_method[m];
    out << "| " << methods[m].name << " | " << trial.distinct << " | " << cell("%.1f", 1e3 * trial.seconds)
        << " ms | " << trial.evaluations << " |\n";
  }
}

}  // namespace

void print_ablation(std::span<const MapTrial> maps, const PathTrial& large, std::ostream& out) {
  const std::size_t seeds = maps.empty() ? 0 : maps.front().paths.size();
  out << "# Which part of the path optimiser does what\n\n"
         "Written by `./dev ablation`; times on one core of an x86-64 machine that did other work beside it, "
         "median\n"
         "of processor time.\n\n"
         "On each map "
      << seeds
      << " random walks through known free space, of 12 viewpoints 1.2 m apart, with a free cube of 0.8 m\n"
         "about every point. Camera 90 x 72 degrees, 10 m. The first and last yaw are given, along the path, "
         "and\n"
         "about every point. Camera 90 x 72 degrees, 10 m. The first and last yaw are given, along the path, "
         "and\n"
         "count. A cell is the mean number of distinct frontiers in view of a path. A frontier is in view if "
         "the\n"
         "field of view contains it and no unknown or occupied voxel lies between. Every method but the "
         "first\n"
         "returns the tangent's yaws if those see more; the ascent never sees fewer than its start. "
         "Evaluations\n"
         "are of the differentiable gain; three of them are for the report.\n\n";
  print_methods(maps, out);
  out << "\n## The paths\n\nPairs of a viewpoint and a frontier that it sees at some yaw, and the time to "
         "find "
         "them by rays.\n\n";
  print_maps(maps, out);
  out << "\n## A path with many frontiers\n\n12 viewpoints, " << large.pairs << " pairs, found by rays in "
      << cell("%.2f", 1e3 * large.visibility_seconds)
      << " ms: along the middle of a free box of 18 x 5.6 x 4 m in voxels of 0.2 m, all around\n"
         "which is unknown.\n\n";
  print_large(large, out);
  const auto find = [](std::string_view name) {
    const auto methods = yaw_methods();
    return static_cast<std::size_t>(
        std::find_if(methods.begin(), methods.end(), [&](const YawMethod& m) { return m.name == name; }) -
        methods.begin());
  };
  const auto gain = [&](std::string_view name) { return cell("%.2f", Summary(maps, find(name)).gain()); };
  out << "\n## Conclusions\n\nTurning each viewpoint by itself to its best bin sees "
      << gain("best of 24 bins") << " x as much as the tangent; choosing the bins\ntogether, greedily, "
      << gain("greedy among 24 bins") << " x. The gradient alone, from the tangent, reaches "
      << gain("tangent, Ipopt, SUM (paper)") << " x by SUM and " << gain("tangent, Ipopt, OR")
      << " x by OR.\nAfter the greedy start the ascent reaches "
      << gain("greedy among 24 bins, Ipopt, OR (default)")
      << " x; 60 bins instead of 24, without any gradient, " << gain("greedy among 60 bins") << " x.\n";
}

}  // namespace frontlux::bench
