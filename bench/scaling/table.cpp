#include "scaling/table.hpp"

#include "text.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace frontlux::bench {
namespace {

constexpr std::size_t kCell = 9;

double counter(const Point& point, const char* name) { return point.counters.at(name); }

double known_voxels(const Point& point) {
  return counter(point, "free_voxels") + counter(point, "occupied_voxels");
}

std::string value(std::optional<double> number) { return pad(number ? digits(*number) : "-", kCell); }

std::string rate_line(const Point& point, int threads, const Recorder& recorder, std::size_t name_width) {
  const std::string name = point.name();
  std::string line = name + pad("", name_width - name.size()) + pad(std::to_string(threads), 8) +
                     pad(cell("%.1f", point.trial->mean_voxels()), kCell) +
                     pad(cell("%.1f %%", 100 * point.trial->positive_share()), kCell) + " |";
  std::string ratios = " |", agreements = " |";
  std::optional<double> base;
  for (const Entry& entry : point.trial->entries()) {
    const auto rate = recorder.rate(row_name(point, entry, threads));
    line += value(rate ? std::optional(*rate * 1e-6) : std::nullopt);
    if (entry.caster == "octomap") {
      base = rate;
    } else {
      ratios += value(rate && base ? std::optional(*rate / *base) : std::nullopt);
    }
    agreements += pad(percent(entry.agreement), kCell);
  }
  return line + ratios + agreements + '\n';
}

std::string cost_line(const Point& point, std::size_t name_width) {
  const double known = known_voxels(point);
  std::string line = point.trial->map() + pad("", name_width - point.trial->map().size()) +
                     pad(cell("%.2f", known * 1e-6), kCell) +
                     pad(cell("%.2f", counter(point, "occupied_voxels") * 1e-6), kCell) + " |" +
                     value(counter(point, "octree_bytes") / known);
  std::string times = " |";
  for (const Entry& entry : point.trial->entries()) {
    if (entry.caster == "octomap") continue;
    line += value(static_cast<double>(entry.bytes) / known);
    times += value(entry.build_seconds * 1e9 / known);
  }
  return line + times + '\n';
}

}  // namespace

void print_scaling_table(std::span<const Point> points, const Recorder& recorder, std::ostream& out) {
  std::size_t name_width = 0;
  for (const Point& point : points) name_width = std::max(name_width, point.name().size());
  const auto columns = [](auto... names) { return (pad(names, kCell) + ...); };

  out << '\n'
      << pad("", name_width + 8 + 2 * kCell) << " |" << centered("Mrays/s", 4 * kCell) << " |"
      << centered("times castRay", 3 * kCell) << " |" << centered("agrees", 4 * kCell) << '\n'
      << pad("", name_width) << pad("threads", 8) << columns("voxels", "hits") << " |"
      << columns("octomap", "grid", "embree", "fast") << " |" << columns("grid", "embree", "fast") << " |"
      << columns("octomap", "grid", "embree", "fast") << '\n';
  std::string axis;
  for (const Point& point : points) {
    if (point.axis != std::exchange(axis, point.axis))
      out << std::string(name_width + 14 + 13 * kCell, '-') << '\n';
    for (const int threads : point.threads) out << rate_line(point, threads, recorder, name_width);
  }

  out << "\nMemory and build time\n"
      << pad("", name_width) << columns("M known", "M occup.") << " |" << centered("bytes/voxel", 4 * kCell)
      << " |" << centered("ns/voxel", 3 * kCell) << '\n'
      << pad("", name_width + 2 * kCell) << " |" << columns("octree", "grid", "embree", "fast") << " |"
      << columns("grid", "embree", "fast") << '\n';
  std::vector<std::string> listed;
  for (const Point& point : points) {
    if (std::find(listed.begin(), listed.end(), point.trial->map()) != listed.end()) continue;
    listed.push_back(point.trial->map());
    out << cost_line(point, name_width);
  }
  out << "\nvoxels: entered per ray. hits: visible, or stopped by an occupied voxel. agrees: with castRay "
         "bit "
         "for\nbit, or between voxel keys with the integer rule, from which castRay itself may round away. "
         "bytes and ns\nper known voxel; embree's and fast's contain the grid's; from the octree to the "
         "caster.\n";
  std::vector<std::string> rows;
  int threads = 1;
  for (const Point& point : points) {
    threads = point.threads.back();
    for (const Entry& entry : point.trial->entries()) rows.push_back(row_name(point, entry, threads));
  }
  print_cautions(rows, threads, recorder, out);
}

}  // namespace frontlux::bench
