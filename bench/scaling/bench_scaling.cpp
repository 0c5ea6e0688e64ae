// How the rays per second of every ray caster change with the map, the rays and the threads.

#include "google_benchmark.hpp"
#include "scaling/sweep.hpp"
#include "table.hpp"

#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace frontlux::bench {
namespace {

/// One line per point and number of threads: rates, speed-up over castRay and agreement.
void print_rates(const std::vector<Point>& points, const GoogleBenchmark& timed) {
  Table table;
  table.add_columns("", {"", "threads", "voxels", "hits"});
  table.add_columns("Mrays/s", {kOctomap, kFast, kEmbree, kGrid});
  table.add_columns("times castRay", {kFast, kEmbree, kGrid});
  table.add_columns("agrees", {kOctomap, kFast, kEmbree, kGrid});
  std::string axis;
  for (const Point& point : points) {
    if (std::exchange(axis, point.axis) != point.axis && axis != points.front().axis) table.add_line();
    for (const int threads : point.threads) {
      std::vector<std::string> row{point.name(), std::to_string(threads),
                                   format("%.1f", point.trial->mean_voxels()),
                                   format("%.1f %%", 100 * point.trial->positive_fraction())};
      std::vector<std::string> ratios, agreements;
      const auto base = timed.rate(row_name(point.name(), kOctomap, threads));
      for (const Entry& entry : point.trial->entries()) {
        const auto rate = timed.rate(row_name(point.name(), entry.caster, threads));
        row.push_back(rate ? digits(*rate * 1e-6) : "-");
        if (entry.caster != kOctomap) ratios.push_back(rate && base ? digits(*rate / *base) : "-");
        agreements.push_back(percent(entry.agreement));
      }
      row.insert(row.end(), ratios.begin(), ratios.end());
      row.insert(row.end(), agreements.begin(), agreements.end());
      table.add_row(std::move(row));
    }
  }
  std::cout << '\n' << table.text();
}

/// One line per map: memory and build time per known voxel, and the time to follow a change.
void print_costs(const std::vector<Point>& points) {
  Table table;
  table.add_columns("Memory, build and update", {"", "M known", "M occupied"});
  table.add_columns("bytes/voxel", {"octree", kFast, kEmbree, kGrid});
  table.add_columns("ns/voxel", {kFast, kEmbree, kGrid});
  table.add_columns("", {"look"});
  table.add_columns("ms to follow it", {kFast, kEmbree});
  std::set<std::string> listed;
  for (const Point& point : points) {
    if (!listed.insert(point.trial->map()).second) continue;
    const double occupied = point.counters.at("occupied_voxels"),
                 known = point.counters.at("free_voxels") + occupied;
    std::vector<std::string> row{point.trial->map(), format("%.2f", known * 1e-6),
                                 format("%.2f", occupied * 1e-6),
                                 digits(point.counters.at("octree_bytes") / known)};
    std::vector<std::string> times,
        updates{format("%.0f", point.trial->counters(point.trial->entries().front()).at("look_voxels"))};
    for (const Entry& entry : point.trial->entries()) {
      if (entry.caster == kOctomap) continue;
      row.push_back(digits(static_cast<double>(entry.bytes) / known));
      times.push_back(digits(entry.build_seconds * 1e9 / known));
      if (entry.caster != kGrid) updates.push_back(digits(entry.update_seconds * 1e3));
    }
    row.insert(row.end(), times.begin(), times.end());
    row.insert(row.end(), updates.begin(), updates.end());
    table.add_row(std::move(row));
  }
  std::cout << '\n'
            << table.text() << R"(
voxels: entered per ray. hits: visible, or stopped by an occupied voxel. agrees: with castRay bit for bit, or between
voxel keys with the integer rule, from which castRay itself differs by rounding. bytes and ns per known voxel: from the
octree to the caster; every caster includes the grid. look: voxels that a look all around shows within 6 m; to follow it
is an update of the caster to a map that has these as well.
)";
}

}  // namespace

int run(int argc, char** argv) {
  const ScalingOptions options = read_scaling_options(argc, argv);
  GoogleBenchmark google_benchmark(argv[0], options);
  const Sweep sweep = prepare_sweep(options, std::cout);
  if (!google_benchmark.may_run(sweep.agreed)) return 1;
  for (const Point& point : sweep.points)
    for (const Entry& entry : point.trial->entries())
      for (const int threads : point.threads) {
        auto counters = point.trial->counters(entry);
        counters.insert(point.counters.begin(), point.counters.end());
        google_benchmark.add(row_name(point.name(), entry.caster, threads), threads,
                             point.trial->workload().size(), entry.pass, std::move(counters));
      }
  google_benchmark.run();
  print_rates(sweep.points, google_benchmark);
  print_costs(sweep.points);
  google_benchmark.print_cautions(std::cout);
  return 0;
}

}  // namespace frontlux::bench
