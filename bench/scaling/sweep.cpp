#include "scaling/sweep.hpp"

#include "maps/filled_maps.hpp"
#include "maps/octree.hpp"
#include "rays/castray_loop.hpp"
#include "scaling/rays.hpp"
#include "table.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>
#include <string_view>
#include <utility>

namespace frontlux::bench {
namespace {

constexpr std::size_t kPilotRays = 2'048, kMinRays = 5'000, kMaxRays = 100'000;

// castRay takes some hundredths of a second for them. That is short because there are many rows.
constexpr double kVoxelsPerPass = 2e6, kVoxelsPerQuickPass = 2e5;

// As many on every map as it takes to start rays in all rooms of the largest one.
constexpr std::size_t kRaysOfSize = 65'536;

constexpr double kNearlyEmpty = 1e-4;

constexpr int kAround = 500;  // voxels: more than half way from street to street

// Makes a sweep, axis by axis.
class SweepMaker {
 public:
  SweepMaker(const ScalingOptions& options, std::ostream& out) : options_(options), out_(out) {}

  Sweep prepare() {
    tbb::task_arena(options_.threads.back()).execute([&] {
      for (const std::string_view axis : kAxes) {
        if (std::find(options_.axes.begin(), options_.axes.end(), axis) == options_.axes.end()) continue;
        if (axis == "resolution") vary_resolution();
        if (axis == "length") vary_length();
        if (axis == "density") vary_density();
        if (axis == "size") vary_size();
        if (axis == "width") vary_width();
        if (axis == "order") vary_order();
      }
    });
    return std::move(sweep_);
  }

 private:
  void vary_resolution() {
    const std::vector<double> resolutions =
        options_.quick ? std::vector{0.5, 0.3} : std::vector{0.5, 0.3, 0.2, 0.1};
    for (const double resolution : resolutions) {
      const Subject& subject = building(resolution);
      for (const std::string_view query : {"visible_uav", "cast_lidar"})
        add("resolution", resolution, format("%g", resolution) + "m", subject, planned(subject, query));
    }
  }

  void vary_length() {
    const std::vector<double> lengths =
        options_.quick ? std::vector{2.0, 10.0, 60.0} : std::vector{2.0, 5.0, 10.0, 20.0, 40.0, 60.0};
    for (const Subject* subject : {&blocks(kNearlyEmpty), &building(options_.quick ? 0.3 : 0.2)})
      for (const double length : lengths)
        add_lines("length", length, format("%g", length) + "m", *subject, length, std::nullopt);
  }

  void vary_density() {
    const std::vector<double> fractions =
        options_.quick ? std::vector{kNearlyEmpty, 0.01, 0.2}
                       : std::vector{kNearlyEmpty, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.2};
    for (const double fraction : fractions)
      add_lines("density", 100 * fraction, format("%g", 100 * fraction) + "pct", blocks(fraction), 20.0,
                std::nullopt);
  }

  void vary_size() {
    // 1, 3, 10, 30 and 100 million voxels, as nearly as whole storeys of rooms allow.
    std::vector<Rooms> sizes{{2, 2, 2}, {3, 3, 3}, {5, 5, 3}};
    if (!options_.quick) sizes.insert(sizes.end(), {{8, 8, 4}, {12, 11, 6}});
    for (const Rooms& size : sizes) {
      const Subject& subject = rooms(size);
      const auto known = static_cast<double>(count_known(subject.grid));
      add_lines("size", known, format("%.1f", known * 1e-6) + "M", subject, 5.0,
                options_.quick ? kRaysOfSize / 16 : kRaysOfSize);
    }
  }

  // Past the width of one table; a robot's rays are near each other.
  void vary_width() {
    std::vector<double> kilometres{0.25, 0.5};
    if (!options_.quick) kilometres.insert(kilometres.end(), {1.0, 2.0});
    for (const double width : kilometres) {
      const Subject& subject = town(width);
      const KeyBox known = *subject.grid.known_bounds();
      const VoxelKey middle = make_key((known.min.x + known.max.x) / 2, (known.min.y + known.max.y) / 2,
                                       (known.min.z + known.max.z) / 2);
      add_lines("width", width, format("%g", width) + "km", subject, 30.0,
                options_.quick ? kRaysOfSize / 16 : kRaysOfSize, grown({middle, middle}, kAround));
    }
  }

  void vary_order() {
    const std::vector<double> resolutions = options_.quick ? std::vector{0.3} : std::vector{0.3, 0.1};
    for (const double resolution : resolutions) {
      const Subject& subject = building(resolution);
      for (const std::string_view query : {"visible_uav", "cast_lidar"}) {
        Workload workload = planned(subject, query);
        add("order", 0, "sorted", subject, workload);
        add("order", 1, "shuffled", subject, shuffled(std::move(workload)));
      }
    }
    for (Point& point : sweep_.points)
      if (point.axis == "order") point.threads = options_.threads;
  }

  const Subject& building(double resolution) {
    const std::string name = "building_" + format("%g", resolution) + "m";
    return subject(name, [&] { return read_octree(generate_map(name, options_.cache)); });
  }

  const Subject& blocks(double fraction) {
    return subject("blocks_" + format("%g", 100 * fraction) + "pct",
                   [&] { return make_octree(make_blocks(fraction)); });
  }

  const Subject& town(double kilometres) {
    return subject("town_" + format("%g", kilometres) + "km",
                   [&] { return make_octree(make_town(static_cast<int>(std::lround(5000 * kilometres)))); });
  }

  const Subject& rooms(const Rooms& rooms) {
    const auto [x, y, z] = rooms;
    return subject("rooms_" + std::to_string(x) + "x" + std::to_string(y) + "x" + std::to_string(z),
                   [&] { return make_octree(make_rooms(rooms)); });
  }

  const Subject& subject(const std::string& name, const std::function<Octree()>& make) {
    for (const auto& made : sweep_.subjects)
      if (made->name == name) return *made;
    sweep_.subjects.push_back(make_subject(make(), name));
    const Subject& subject = *sweep_.subjects.back();
    out_ << describe(subject) << std::endl;
    const auto count = subject.grid.count();
    facts_[&subject] = {{"resolution", subject.grid.resolution()},
                        {"free_voxels", static_cast<double>(count[1])},
                        {"occupied_voxels", static_cast<double>(count[2])},
                        {"octree_bytes", static_cast<double>(memory_bytes(subject.tree))}};
    return subject;
  }

  void add(std::string axis, double x, std::string label, const Subject& subject, Workload workload) {
    const std::string where = axis + " " + label + " on " + subject.name;
    if (workload.size() == 0) {
      out_ << "  " << where << ", " << workload.name << " skipped: "
           << (workload.skipped.empty() ? "no free voxels are so far apart" : workload.skipped) << std::endl;
      return;
    }
    auto counters = facts_[&subject];
    counters["x"] = x;
    if (heading_ != where) out_ << where << '\n';
    heading_ = where;
    auto trial = std::make_unique<Trial>(subject, std::move(workload), std::span<const Peer>{});
    sweep_.agreed = trial->check(options_.threads, out_) && sweep_.agreed;
    out_.flush();
    sweep_.points.push_back({std::move(axis),
                             x,
                             std::move(label),
                             {options_.threads.back()},
                             std::move(counters),
                             std::move(trial)});
  }

  void add_lines(const std::string& axis, double x, const std::string& label, const Subject& subject,
                 double length, std::optional<std::size_t> rays, const KeyBox& within = kAllVoxels) {
    const auto make = [&](const std::string& query, std::size_t count) {
      Workload workload{query, {}, {}, {}};
      auto segments = segments_of_length(subject.grid, length, count, within);
      if (query == "visible") {
        workload.segments = std::move(segments);
      } else if (!segments.empty()) {
        workload.batches.push_back(
            {rays_along(segments, subject.grid.lattice(), length), UnknownPolicy::kPass});
      }
      return workload;
    };
    for (const char* query : {"visible", "cast"}) {
      const std::size_t count = rays ? *rays : rays_for(make(query, kPilotRays), subject);
      add(axis, x, label, subject, make(query, count));
    }
  }

  Workload planned(const Subject& subject, std::string_view query) const {
    WorkloadSource source(subject.grid, subject.caster(kGrid));
    return source.make(query, rays_for(source.make(query, kPilotRays), subject));
  }

  std::size_t rays_for(const Workload& pilot, const Subject& subject) const {
    const double length = mean_voxels(pilot, subject.caster(kGrid), subject.grid.lattice());
    const double voxels = options_.quick ? kVoxelsPerQuickPass : kVoxelsPerPass;
    return std::clamp(static_cast<std::size_t>(voxels / std::max(length, 1.0)), kMinRays, kMaxRays);
  }

  const ScalingOptions& options_;
  std::ostream& out_;
  Sweep sweep_;
  std::map<const Subject*, std::map<std::string, double>> facts_;
  std::string heading_;  // printed last
};

}  // namespace

std::string Point::name() const { return axis + "/" + trial->name() + "/" + label; }

Sweep prepare_sweep(const ScalingOptions& options, std::ostream& out) {
  return SweepMaker(options, out).prepare();
}

}  // namespace frontlux::bench
