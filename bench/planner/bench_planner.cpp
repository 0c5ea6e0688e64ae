// The time to choose goals: rendering view quality and assigning frontiers, by every caster on the same map.
// Answers are compared before anything is timed.

#include "google_benchmark.hpp"
#include "planner/planner_scene.hpp"
#include "rays/subject.hpp"
#include "table.hpp"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

using Counters = std::map<std::string, double>;

/// What is timed, on each number of threads.
struct Row {
  std::string work, map, caster, detail;  // detail: "/samples:64", or empty
  std::size_t items = 0;
  std::function<void()> pass;
  Counters counters;
  std::size_t times = 1;  // that a pass does the work

  [[nodiscard]] std::string name(const std::string& by, int threads) const {
    return row_name(work + "/" + map, by + detail, threads);
  }
};

/// Number of frontiers with different robots.
std::size_t differing_owners(const planner::FrontierAssignment& a, const planner::FrontierAssignment& b,
                             std::size_t frontiers) {
  const auto owners = [&](const planner::FrontierAssignment& assignment) {
    std::vector<int> owner(frontiers, -1);
    for (std::size_t r = 0; r < assignment.assigned.size(); ++r)
      for (const std::uint32_t f : assignment.assigned[r].frontiers) owner[f] = static_cast<int>(r);
    return owner;
  };
  const auto x = owners(a), y = owners(b);
  std::size_t count = 0;
  for (std::size_t i = 0; i < frontiers; ++i) count += x[i] != y[i] ? 1 : 0;
  return count;
}

/// The same rendering by several casters.
std::vector<Rendering> by_casters(const Subject& subject, const std::vector<const char*>& casters,
                                  const ViewQualityOptions& options) {
  std::vector<Rendering> renderings;
  for (const char* caster : casters) renderings.push_back({caster, &subject.caster(caster), options});
  return renderings;
}

/// All rows, and what they refer to.
class Session {
 public:
  void prepare(const std::filesystem::path& file, const PlannerOptions& options) {
    subjects_.push_back(load_subject(file, unique_name(file, names_)));
    const Subject& subject = *subjects_.back();
    std::cout << describe(subject) << std::endl;
    scenes_.push_back(
        std::make_unique<PlannerScene>(subject, options.corners ? Adjacency::kCorners : Adjacency::kFaces,
                                       options.ground_viewpoints, options.aerial_viewpoints));
    const PlannerScene& scene = *scenes_.back();
    std::cout << "  " << scene.frontiers.size() << " frontiers; corridors of " << scene.ground_cells.size()
              << " and " << scene.aerial_cells.size()
              << " cells; viewpoints: " << scene.ground_viewpoints.size() << " on the ground, "
              << scene.aerial_viewpoints.size() << " in space; a scan changes " << scene.changed.size()
              << " voxels" << std::endl;
    ViewQualityOptions sampled;
    for (const int samples : options.samples) {
      sampled.samples = samples;
      add_on_ground(scene, "render_view_quality", "/samples:" + std::to_string(samples),
                    by_casters(subject, {kGrid, kOctomap, kEmbree, kFast}, sampled));
    }
    std::vector<Rendering> all;
    for (const char* name : {kGrid, kOctomap, kEmbree, kFast, kExact})
      all.push_back(all_frontiers(subject, name, 0));
    add_on_ground(scene, "render_all", "", all);
    add_assignments(scene);
    ViewQualityOptions in_space;
    in_space.sampling = ViewQualityOptions::Sampling::kBuckets;
    in_space.azimuth_bins = kAzimuthBins;
    add_in_space(scene, scene.aerial_viewpoints, "", "/samples:64",
                 by_casters(subject, {kGrid, kEmbree, kFast}, in_space));
    const std::vector<Rendering> fast_and_exact = {all_frontiers(subject, kFast, kAzimuthBins),
                                                   all_frontiers(subject, kExact, kAzimuthBins)};
    add_in_space(scene, scene.aerial_viewpoints, "_all", "", fast_and_exact);
    // As a planner asks for candidates around one place, and for its goals all over the map.
    constexpr std::size_t kFew = 32, kScattered = 256;
    add_in_space(scene, around_the_middle(scene.aerial_viewpoints, kFew), "_few", "", fast_and_exact);
    add_in_space(scene, thinned(scene.aerial_viewpoints, kScattered), "_scattered", "", fast_and_exact);
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] bool agreed() const { return agreed_; }

 private:
  // Prints how many answers differ from those of the first caster. Only OctoMap's may.
  void compare(const std::string& what, const std::string& caster, std::size_t different, std::size_t all) {
    const bool wrong = different != 0 && caster != kOctomap;
    agreed_ = agreed_ && !wrong;
    std::cout << "  " << what << ", " << caster << ": " << different << " of " << all << " differ"
              << (wrong ? " DISAGREEMENT" : "") << std::endl;
  }

  void add(const PlannerScene& scene, const std::string& work, const std::string& caster,
           const std::string& detail, std::size_t items, std::function<void()> pass, Counters counters,
           std::size_t times = 1) {
    counters["frontiers"] = static_cast<double>(scene.frontiers.size());
    rows_.push_back(
        {work, scene.subject.name, caster, detail, items, std::move(pass), std::move(counters), times});
  }

  // The ground robot's viewpoints, rendered anew in each pass.
  void add_on_ground(const PlannerScene& scene, const std::string& work, const std::string& detail,
                     const std::vector<Rendering>& renderings) {
    std::optional<ViewQualityImage> truth;
    for (const Rendering& rendering : renderings) {
      const auto render = [&scene, rendering] {
        return render_view_quality(*rendering.caster, scene.subject.grid.lattice(), scene.ground_viewpoints,
                                   scene.frontiers, scene.ground.view, rendering.options);
      };
      const ViewQualityImage image = render();
      if (!truth) truth = image;
      const std::size_t different = differing(*truth, image);
      compare(work + detail, rendering.name, different, image.size());
      add(scene, work, rendering.name, detail, image.size(), [render] { benchmark::DoNotOptimize(render()); },
          {{"viewpoints", static_cast<double>(image.size())},
           {"pairs", total(image, &ViewQuality::population)},
           {"different", static_cast<double>(different)}});
    }
  }

  // Viewpoints of the aerial robot, from scratch and after one scan. A pass of the latter takes the scan into
  // the map and out again.
  void add_in_space(const PlannerScene& scene, const std::vector<VoxelKey>& viewpoints,
                    const std::string& suffix, const std::string& detail,
                    const std::vector<Rendering>& renderings) {
    std::optional<ViewQualityImage> truth, scanned_truth;
    for (const Rendering& rendering : renderings) {
      // A caster of its own for the map after the scan, so that only rendering is timed.
      std::shared_ptr<RayCaster> after = make_grid_ray_caster(scene.scanned);
      if (rendering.name == kFast || rendering.name == kExact) after = make_ray_caster(scene.scanned);
      if (rendering.name == kEmbree) after = make_embree_ray_caster(scene.scanned);
      const auto render = [&scene, viewpoints, rendering](const RayCaster& rays,
                                                          const std::vector<VoxelKey>& frontiers) {
        ViewQualityImage image(scene.subject.grid.lattice(), scene.aerial.view, rendering.options);
        image.render(rays, viewpoints, frontiers);
        return image;
      };
      const auto render_anew = [&scene, rendering, render] {
        return render(*rendering.caster, scene.frontiers);
      };
      const ViewQualityImage image = render_anew();
      if (!truth) truth = image;
      if (!scanned_truth) scanned_truth = render(*after, scene.scanned_frontiers);
      const auto updated = std::make_shared<ViewQualityImage>(image);
      const auto take_in = [&scene, viewpoints, after, updated] {
        return updated->update(*after, viewpoints, scene.scanned_frontiers, {scene.scanned, scene.changed});
      };
      const auto take_out = [&scene, viewpoints, rendering, updated] {
        return updated->update(*rendering.caster, viewpoints, scene.frontiers,
                               {scene.subject.grid, scene.changed});
      };
      const auto again = static_cast<double>(take_in());
      const std::size_t scanned_differ = differing(*scanned_truth, *updated);
      take_out();
      compare("render_space" + suffix, rendering.name, differing(*truth, image), image.size());
      compare("update_space" + suffix + ", scan taken in", rendering.name, scanned_differ, image.size());
      compare("update_space" + suffix + ", scan taken out", rendering.name, differing(*truth, *updated),
              image.size());
      const Counters counters = {{"viewpoints", static_cast<double>(image.size())},
                                 {"pairs", total(image, &ViewQuality::population)},
                                 {"changed_voxels", static_cast<double>(scene.changed.size())},
                                 {"rendered_again", again}};
      add(
          scene, "render_space" + suffix, rendering.name, detail, image.size(),
          [render_anew] { benchmark::DoNotOptimize(render_anew()); }, counters);
      add(
          scene, "update_space" + suffix, rendering.name, detail, image.size(),
          [take_in, take_out] {
            take_in();
            take_out();
          },
          counters, 2);
    }
  }

  void add_assignments(const PlannerScene& scene) {
    std::optional<planner::FrontierAssignment> truth;
    for (const char* caster : {kGrid, kOctomap, kEmbree, kFast}) {
      const auto assign = [&scene, &rays = scene.subject.caster(caster)] {
        return planner::assign_frontiers(rays, scene.subject.grid, scene.frontiers, scene.agents());
      };
      const auto assignment = assign();
      if (!truth) truth = assignment;
      const std::size_t different = differing_owners(*truth, assignment, scene.frontiers.size());
      compare("assign_frontiers", caster, different, scene.frontiers.size());
      double rays = 0;
      for (const auto& assigned : assignment.assigned) rays += static_cast<double>(assigned.rays);
      add(scene, "assign_frontiers", caster, "", scene.frontiers.size(),
          [assign] { benchmark::DoNotOptimize(assign()); },
          {{"ground_cells", static_cast<double>(scene.ground_cells.size())},
           {"aerial_cells", static_cast<double>(scene.aerial_cells.size())},
           {"rays", rays},
           {"different", static_cast<double>(different)}});
    }
  }

  std::set<std::string> names_;  // of the maps
  std::vector<std::unique_ptr<Subject>> subjects_;
  std::vector<std::unique_ptr<PlannerScene>> scenes_;
  std::vector<Row> rows_;
  bool agreed_ = true;
};

}  // namespace

int run(int argc, char** argv) {
  const PlannerOptions options = read_planner_options(argc, argv);
  GoogleBenchmark google_benchmark(argv[0], options);
  auto maps = options.maps;
  if (maps.empty()) maps.push_back(generate_map("building_0.3m", options.cache));
  Session session;
  tbb::task_arena(options.threads.back()).execute([&] {
    for (const auto& map : maps) session.prepare(map, options);
  });
  if (!google_benchmark.may_run(session.agreed())) return 1;
  for (const Row& row : session.rows()) {
    auto counters = row.counters;
    if (row.times > 1) counters["times_in_a_pass"] = static_cast<double>(row.times);
    for (const int threads : options.threads)
      google_benchmark.add(row.name(row.caster, threads), threads, row.items * row.times, row.pass, counters);
  }
  google_benchmark.run();
  Table table;
  table.add_columns("", {"median of the repetitions", "ms", "CPU ms", "times castRay", "times embree"});
  for (const Row& row : session.rows())
    for (const int threads : options.threads) {
      const auto rate = google_benchmark.rate(row.name(row.caster, threads));
      if (!rate) continue;
      const auto against = [&](const char* caster) {
        const auto base = google_benchmark.rate(row.name(caster, threads));
        return base ? digits(*rate / *base) : "-";
      };
      const double ms = 1e3 * static_cast<double>(row.items) / *rate;
      const double busy = *google_benchmark.busy_processors(row.name(row.caster, threads));
      table.add_row({row.name(row.caster, threads), format("%.1f", ms), format("%.1f", ms * busy),
                     against(kOctomap), against(kEmbree)});
    }
  std::cout << '\n' << table.text();
  google_benchmark.print_cautions(std::cout);
  return 0;
}

}  // namespace frontlux::bench
