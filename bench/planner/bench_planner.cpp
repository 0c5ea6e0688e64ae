// What it costs to choose goals: rendering view quality and distributing frontiers, by every caster on the
// same map. Answers are compared before anything is timed.

#include "google_benchmark.hpp"
#include "machine.hpp"
#include "planner/planner_scene.hpp"
#include "program.hpp"
#include "rays/generated_map.hpp"
#include "rays/subject.hpp"
#include "report.hpp"

#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

struct Options {
  std::vector<std::filesystem::path> maps;
  std::filesystem::path cache = std::filesystem::temp_directory_path() / "frontlux-maps";
  std::vector<int> threads{1, 2}, samples{16, 64, 256};
  std::size_t ground_viewpoints = 40'000, aerial_viewpoints = 150'000;
  bool corners = false, quick = false;
  std::string json;
};

// Something that is timed.
struct Row {
  std::string work, map, caster, detail;  // detail: "/samples:64", or nothing
  int threads = 1;
  std::size_t items = 0;
  std::function<void()> pass;
  std::vector<std::pair<std::string, double>> counters;

  [[nodiscard]] std::string name() const {
    return work + "/" + map + "/" + caster + detail + "/threads:" + std::to_string(threads);
  }
};

struct Session {
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<std::unique_ptr<PlannerScene>> scenes;
  std::vector<std::unique_ptr<ViewQualityImage>> images;
  std::vector<Row> rows;
  bool agreed = true;
};

std::size_t differing(const ViewQualityImage& a, const ViewQualityImage& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += a.values()[i] != b.values()[i] || !std::ranges::equal(a.bin_hits(i), b.bin_hits(i)) ? 1 : 0;
  return count;
}

std::size_t differing(const planner::FrontierAssignment& a, const planner::FrontierAssignment& b,
                      std::size_t frontiers) {
  const auto owners = [&](const planner::FrontierAssignment& distribution) {
    std::vector<int> owner(frontiers, -1);
    for (std::size_t r = 0; r < distribution.assigned.size(); ++r)
      for (const std::uint32_t f : distribution.assigned[r].frontiers) owner[f] = static_cast<int>(r);
    return owner;
  };
  const auto x = owners(a), y = owners(b);
  std::size_t count = 0;
  for (std::size_t i = 0; i < frontiers; ++i) count += x[i] != y[i] ? 1 : 0;
  return count;
}

// Says how far a caster's answers lie from the grid's, which only OctoMap's may.
void tell(const std::string& what, const std::string& caster, std::size_t different, std::size_t all,
          Session& session) {
  const bool wrong = different != 0 && caster != "octomap";
  session.agreed = session.agreed && !wrong;
  std::cout << "  " << what << ", " << caster << ": " << different << " of " << all
            << " differ from the grid's" << (wrong ? " DISAGREEMENT" : "") << std::endl;
}

void add_renderings(const PlannerScene& scene, const Options& options, Session& session) {
  const Lattice& lattice = scene.subject.grid.lattice();
  const auto render = [&scene, &lattice](const std::string& caster, int samples) {
    return render_view_quality(*scene.subject.contender(caster).caster, lattice, scene.ground_viewpoints,
                               scene.frontiers, scene.ground.view, ground_rendering(samples));
  };
  for (const int samples : options.samples) {
    const ViewQualityImage truth = render("grid", samples);
    for (const char* caster : {"octomap", "grid", "embree", "fast"}) {
      const std::string name = caster;
      const std::size_t different = name == "grid" ? 0 : differing(truth, render(name, samples));
      if (name != "grid") tell(std::to_string(samples) + " samples", name, different, truth.size(), session);
      for (const int threads : options.threads)
        session.rows.push_back({"render_view_quality",
                                scene.subject.name,
                                name,
                                "/samples:" + std::to_string(samples),
                                threads,
                                truth.size(),
                                [render, name, samples] { benchmark::DoNotOptimize(render(name, samples)); },
                                {{"samples", samples},
                                 {"viewpoints", static_cast<double>(truth.size())},
                                 {"frontiers", static_cast<double>(scene.frontiers.size())},
                                 {"different", static_cast<double>(different)}}});
    }
  }
}

// How all targets are looked at: by rays of a caster, or by the exact renderer.
struct Looking {
  std::string name;
  const RayCaster* caster;
  ViewQualityOptions options;
};

std::vector<Looking> ways_to_look(const PlannerScene& scene, const std::vector<const char*>& casters,
                                  int azimuth_bins) {
  ViewQualityOptions options;
  options.azimuth_bins = azimuth_bins;
  options.samples = ViewQualityOptions::kAll;
  std::vector<Looking> ways;
  for (const char* caster : casters)
    ways.push_back({caster, scene.subject.contender(caster).caster.get(), options});
  options.renderer = ViewQualityOptions::Renderer::kExact;
  ways.push_back({"exact", scene.subject.contender("grid").caster.get(), options});
  return ways;
}

std::vector<std::pair<std::string, double>> count_pairs(const ViewQualityImage& image,
                                                        const PlannerScene& scene) {
  double pairs = 0;
  for (const ViewQuality& value : image.values()) pairs += value.population;
  return {{"viewpoints", static_cast<double>(image.size())},
          {"frontiers", static_cast<double>(scene.frontiers.size())},
          {"pairs", pairs}};
}

// All frontiers in view of the ground robot's viewpoints; everything made anew in each pass.
void add_all_on_ground(const PlannerScene& scene, const Options& options, Session& session) {
  std::optional<ViewQualityImage> truth;
  for (const Looking& way : ways_to_look(scene, {"grid", "octomap", "embree", "fast"}, 0)) {
    const auto render = [&scene, way] {
      return render_view_quality(*way.caster, scene.subject.grid.lattice(), scene.ground_viewpoints,
                                 scene.frontiers, scene.ground.view, way.options);
    };
    const ViewQualityImage image = render();
    if (!truth) truth = image;
    const std::size_t different = differing(*truth, image);
    if (way.name != "grid") tell("all frontiers", way.name, different, image.size(), session);
    for (const int threads : options.threads) {
      Row row{"render_all",
              scene.subject.name,
              way.name,
              "",
              threads,
              image.size(),
              [render] { benchmark::DoNotOptimize(render()); },
              count_pairs(image, scene)};
      row.counters.emplace_back("different", static_cast<double>(different));
      session.rows.push_back(std::move(row));
    }
  }
}

// The same for the aerial robot's corridor, by azimuth, and after one scan.
void add_all_in_space(const PlannerScene& scene, const Options& options, Session& session) {
  std::optional<ViewQualityImage> truth;
  for (const Looking& way : ways_to_look(scene, {"fast"}, 36)) {
    const std::shared_ptr<RayCaster> after =
        way.name == "exact" ? make_grid_ray_caster(scene.scanned) : make_ray_caster(scene.scanned);
    ViewQualityImage image(scene.subject.grid.lattice(), scene.aerial.view, way.options);
    const auto render = [&scene, way](ViewQualityImage& into) {
      into.render(*way.caster, scene.aerial_viewpoints, scene.frontiers);
    };
    const auto step = [&scene, way, after](ViewQualityImage& followed, bool& scanned) {
      scanned = !scanned;
      return followed.update(scanned ? *after : *way.caster, scene.aerial_viewpoints,
                             scanned ? scene.scanned_frontiers : scene.frontiers, scene.change);
    };
    render(image);
    ViewQualityImage followed = image;
    bool scanned = false;
    auto counters = count_pairs(image, scene);
    counters.emplace_back("rendered_again", static_cast<double>(step(followed, scanned)));
    step(followed, scanned);
    if (!truth) truth = image;
    tell("all in space", way.name, differing(*truth, image), image.size(), session);
    tell("all in space after updates", way.name, differing(*truth, followed), image.size(), session);
    for (const int threads : options.threads) {
      session.rows.push_back({"render_space_all", scene.subject.name, way.name, "", threads, image.size(),
                              [render, &scene, way] {
                                ViewQualityImage fresh(scene.subject.grid.lattice(), scene.aerial.view,
                                                       way.options);
                                render(fresh);
                              },
                              counters});
      session.images.push_back(std::make_unique<ViewQualityImage>(image));
      ViewQualityImage& updated = *session.images.back();
      session.rows.push_back({"update_space_all", scene.subject.name, way.name, "", threads, image.size(),
                              [step, &updated, at = false]() mutable { step(updated, at); }, counters});
    }
  }
}

void add_distributions(const PlannerScene& scene, const Options& options, Session& session) {
  const auto distribute = [&scene](const std::string& caster) {
    return planner::assign_frontiers(*scene.subject.contender(caster).caster, scene.subject.grid,
                                     scene.frontiers, scene.agents());
  };
  const auto truth = distribute("grid");
  for (const char* caster : {"octomap", "grid", "embree", "fast"}) {
    const std::string name = caster;
    const auto mine = distribute(name);
    const std::size_t different = differing(truth, mine, scene.frontiers.size());
    if (name != "grid") tell("distribution", name, different, scene.frontiers.size(), session);
    double rays = 0;
    for (const auto& share : mine.assigned) rays += static_cast<double>(share.rays);
    for (const int threads : options.threads)
      session.rows.push_back({"assign_frontiers",
                              scene.subject.name,
                              name,
                              "",
                              threads,
                              scene.frontiers.size(),
                              [distribute, name] { benchmark::DoNotOptimize(distribute(name)); },
                              {{"frontiers", static_cast<double>(scene.frontiers.size())},
                               {"ground_cells", static_cast<double>(scene.ground_cells.size())},
                               {"aerial_cells", static_cast<double>(scene.aerial_cells.size())},
                               {"rays", rays},
                               {"different", static_cast<double>(different)}}});
  }
}

// The aerial robot's corridor, from scratch and after one scan.
void add_space(const PlannerScene& scene, const Options& options, Session& session) {
  const VoxelGrid& grid = scene.subject.grid;
  std::optional<ViewQualityImage> truth;
  for (const char* caster : {"grid", "fast"}) {
    const std::string name = caster;
    const RayCaster& before = *scene.subject.contender(name).caster;
    // A caster of its own for the map after the scan, so that only rendering is timed.
    const std::shared_ptr<RayCaster> after =
        name == "grid" ? make_grid_ray_caster(scene.scanned) : make_ray_caster(scene.scanned);
    ViewQualityImage image(grid.lattice(), scene.aerial.view, aerial_rendering());
    const auto render = [&scene, &before](ViewQualityImage& into) {
      into.render(before, scene.aerial_viewpoints, scene.frontiers);
    };
    render(image);
    if (!truth)
      truth = image;
    else
      tell("in space", name, differing(*truth, image), image.size(), session);
    const auto step = [&scene, &before, after](ViewQualityImage& followed, bool& scanned) {
      scanned = !scanned;
      return followed.update(scanned ? *after : before, scene.aerial_viewpoints,
                             scanned ? scene.scanned_frontiers : scene.frontiers, scene.change);
    };
    bool scanned = false;
    ViewQualityImage followed = image;
    const auto rendered = static_cast<double>(step(followed, scanned));
    step(followed, scanned);
    if (const std::size_t different = differing(image, followed); different != 0) {
      session.agreed = false;
      std::cout << "  in space, " << name << ": " << different << " differ after updates DISAGREEMENT\n";
    }
    const std::vector<std::pair<std::string, double>> counters = {
        {"viewpoints", static_cast<double>(image.size())},
        {"frontiers", static_cast<double>(scene.frontiers.size())},
        {"changed_voxels", static_cast<double>(scene.changed_voxels)},
        {"rendered_again", rendered}};
    for (const int threads : options.threads) {
      session.images.push_back(std::make_unique<ViewQualityImage>(image));
      ViewQualityImage& mine = *session.images.back();
      session.rows.push_back({"render_space", scene.subject.name, name, "/samples:64", threads, image.size(),
                              [render, &mine] { render(mine); }, counters});
      session.images.push_back(std::make_unique<ViewQualityImage>(image));
      ViewQualityImage& updated = *session.images.back();
      session.rows.push_back({"update_space", scene.subject.name, name, "/samples:64", threads, image.size(),
                              [step, &updated, at = false]() mutable { step(updated, at); }, counters});
    }
  }
}

void prepare(const std::filesystem::path& file, const Options& options, Session& session) {
  tbb::task_arena arena(*std::max_element(options.threads.begin(), options.threads.end()));
  arena.execute([&] {
    session.subjects.push_back(load_subject(file, file.stem().string()));
    const Subject& subject = *session.subjects.back();
    std::cout << describe(subject) << std::endl;
    session.scenes.push_back(std::make_unique<PlannerScene>(
        subject, options.corners ? planner::Adjacency::kCorners : planner::Adjacency::kFaces,
        options.quick ? 2'000 : options.ground_viewpoints,
        options.quick ? 5'000 : options.aerial_viewpoints));
    const PlannerScene& scene = *session.scenes.back();
    std::cout << "  " << scene.frontiers.size() << " frontiers; corridors of " << scene.ground_cells.size()
              << " and " << scene.aerial_cells.size()
              << " cells; viewpoints: " << scene.ground_viewpoints.size() << " on the ground, "
              << scene.aerial_viewpoints.size() << " in space; a scan changes " << scene.changed_voxels
              << " voxels" << std::endl;
    add_renderings(scene, options, session);
    add_all_on_ground(scene, options, session);
    add_distributions(scene, options, session);
    add_space(scene, options, session);
    add_all_in_space(scene, options, session);
  });
}

void register_row(const Row& row) {
  const auto run = [&row](benchmark::State& state) {
    tbb::task_arena arena(row.threads);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    for (auto _ : state) arena.execute(row.pass);
    const double cpu = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(row.items));
    state.counters["busy_processors"] = cpu / seconds.count();
    state.counters["cpu_ms"] = 1e3 * cpu / static_cast<double>(state.iterations());
    for (const auto& [name, value] : row.counters) state.counters[name] = value;
  };
  benchmark::RegisterBenchmark(row.name().c_str(), run)->UseRealTime()->Unit(benchmark::kMillisecond);
}

void print_rows(const Session& session, const Recorder& recorder) {
  std::printf("\n%-66s %10s %10s %12s\n", "median of the repetitions", "ms", "CPU ms", "over octomap");
  for (const Row& row : session.rows) {
    const auto rate = recorder.rate(row.name());
    if (!rate) continue;
    Row base = row;
    base.caster = "octomap";
    const auto base_rate = recorder.rate(base.name());
    const double ms = 1e3 * static_cast<double>(row.items) / *rate;
    const double busy = recorder.busy_processors(row.name()).value_or(0.0);
    std::printf("%-66s %10.1f %10.1f", row.name().c_str(), ms, ms * busy);
    if (base_rate) std::printf(" %10.1f x", *rate / *base_rate);
    std::printf("\n");
  }
}

std::optional<Options> read_options(SplitArguments& arguments, int& exit_code) {
  Options options;
  CLI::App app{
      "Measures what it costs to choose goals, after checking that all ray casters give the same answers.\n"
      "Takes Google Benchmark's options (--benchmark_...) as well."};
  app.add_option("--map", options.maps, "maps, .bt or .ot (default: the generated building_0.3m)");
  app.add_option("--threads", options.threads, "numbers of threads")->check(CLI::Range(1, 1024));
  app.add_option("--samples", options.samples, "targets drawn for each viewpoint")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--viewpoints", options.ground_viewpoints, "of the ground robot, at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}));
  app.add_option("--viewpoints-in-space", options.aerial_viewpoints, "of the aerial robot, at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}));
  app.add_option("--json", options.json, "write Google Benchmark's JSON to this file");
  app.add_option("--map-cache", options.cache, "folder in which generated maps are kept");
  app.add_flag("--corners", options.corners,
               "frontiers share an edge or corner with a free voxel, too: more of them");
  app.add_flag("--quick", options.quick, "a smoke run: few viewpoints, one repetition");
  try {
    app.parse(arguments.own);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  // A slow or disturbed moment must not meet one caster only: repetitions of all rows in random order.
  std::vector<std::string> defaults = {
      "--benchmark_enable_random_interleaving=true",
      options.quick ? "--benchmark_repetitions=1" : "--benchmark_repetitions=5",
      options.quick ? "--benchmark_min_time=0.005" : "--benchmark_min_time=0.1"};
  if (!options.json.empty()) {
    check_writable(options.json);
    defaults.push_back("--benchmark_out=" + options.json);
    defaults.push_back("--benchmark_out_format=json");
  }
  arguments.passed_on.insert(arguments.passed_on.begin(), defaults.begin(), defaults.end());
  return options;
}

int run(int argc, char** argv) {
  int exit_code = 0;
  SplitArguments arguments(argc, argv);
  auto options = read_options(arguments, exit_code);
  if (!options) return exit_code;
  GoogleBenchmark google_benchmark(argv[0], arguments.passed_on);
  add_context();
  warn_of_too_many_threads(*std::max_element(options->threads.begin(), options->threads.end()));
  std::cout << cpu_name() << ". Answers are compared first.\n";
  if (options->maps.empty()) options->maps.push_back(generate_map("building_0.3m", options->cache));
  Session session;
  for (const auto& map : options->maps) prepare(map, *options, session);
  if (!session.agreed) {
    std::cerr << "\nCasters disagree where they must not (see DISAGREEMENT above): nothing is timed.\n";
    return 1;
  }
  for (const Row& row : session.rows) register_row(row);
  std::cout << "Timing, in random order of all repetitions ..." << std::endl;
  Recorder recorder;
  benchmark::RunSpecifiedBenchmarks(&recorder);
  print_rows(session, recorder);
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  return frontlux::bench::run_program("bench_planner", frontlux::bench::run, argc, argv);
}
