// How far drawn view quality lies from the exact one, and what both cost: the exact image is the truth. Exact
// answers are compared with rays to all frontiers before anything is measured.

#include "machine.hpp"
#include "planner/planner_scene.hpp"
#include "program.hpp"
#include "rays/generated_map.hpp"
#include "rays/subject.hpp"
#include "view_error/error.hpp"

#include <CLI/CLI.hpp>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

using Renderer = ViewQualityOptions::Renderer;
using Sampling = ViewQualityOptions::Sampling;

constexpr double kLambda = 0.1386;  // [1/m] of eq. 1, as `GoalOptions` has it
constexpr std::size_t kPlaces = 64;

struct Options {
  std::vector<std::filesystem::path> maps;
  std::filesystem::path cache = std::filesystem::temp_directory_path() / "frontlux-maps";
  std::vector<int> samples{8, 16, 32, 64, 128, 256, 512};
  std::size_t ground_viewpoints = 40'000, aerial_viewpoints = 20'000, octomap_viewpoints = 1'000;
  int passes = 5, threads = 1;
  std::filesystem::path csv;
};

// One robot on one map.
struct Case {
  std::string robot;
  const Subject& subject;
  FieldOfView view;
  std::vector<VoxelKey> viewpoints, frontiers;
  int azimuth_bins;
};

// A way to render, and what its passes took.
struct Way {
  std::string name, sampling;
  const RayCaster* caster;
  ViewQualityOptions options;
  std::span<const VoxelKey> viewpoints;
  std::vector<double> ms{}, cpu_ms{};
  double pairs = 0;
  std::optional<ErrorSum> errors{};
};

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

ViewQualityImage rendered(const Case& scene, const Way& way) {
  return render_view_quality(*way.caster, scene.subject.grid.lattice(), way.viewpoints, scene.frontiers,
                             scene.view, way.options);
}

Way looking_at_all(const Case& scene, const std::string& name, std::span<const VoxelKey> viewpoints) {
  ViewQualityOptions options;
  options.azimuth_bins = scene.azimuth_bins;
  options.samples = ViewQualityOptions::kAll;
  if (name == "exact") options.renderer = Renderer::kExact;
  return {name, "", scene.subject.contender(name == "exact" ? "grid" : name).caster.get(), options,
          viewpoints};
}

std::vector<VoxelKey> some_of(const std::vector<VoxelKey>& keys, std::size_t count) {
  std::vector<VoxelKey> some;
  const std::size_t chosen = std::min(count, keys.size());
  for (std::size_t i = 0; i < chosen; ++i) some.push_back(keys[i * keys.size() / chosen]);
  return some;
}

double total_gain(const ViewQualityImage& image) {
  double sum = 0;
  for (const ViewQuality& value : image.values()) sum += value.gain;
  return sum;
}

std::size_t differing(const ViewQualityImage& a, const ViewQualityImage& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += a.values()[i] != b.values()[i] || !std::ranges::equal(a.bin_hits(i), b.bin_hits(i)) ? 1 : 0;
  return count;
}

// Whether the exact image of a sample is that of rays to all frontiers, and part of the whole image.
bool agrees(const Case& scene, const ViewQualityImage& truth, const std::vector<VoxelKey>& sample) {
  const auto exact = rendered(scene, looking_at_all(scene, "exact", sample));
  bool equal = true;
  for (const char* caster : {"grid", "embree", "fast", "octomap"}) {
    const std::string name = caster;
    const ViewQualityImage image = rendered(scene, looking_at_all(scene, name, sample));
    const std::size_t different = differing(exact, image);
    const bool wrong = different != 0 && name != "octomap";
    equal = equal && !wrong;
    std::cout << "  " << scene.robot << ": exact differs from " << name << "'s rays to all frontiers for "
              << different << " of " << sample.size() << " viewpoints; of all that it sees, they see "
              << 100.0 * total_gain(image) / total_gain(exact) << " %" << (wrong ? " DISAGREEMENT" : "")
              << std::endl;
  }
  std::size_t different = 0, at = 0;
  for (std::size_t i = 0; i < truth.size() && at < sample.size(); ++i)
    if (truth.viewpoints()[i] == sample[at]) different += truth.values()[i] != exact.values()[at++] ? 1 : 0;
  if (different != 0 || at != sample.size())
    std::cout << "  " << scene.robot << ": the whole exact image has other values DISAGREEMENT" << std::endl;
  return equal && different == 0 && at == sample.size();
}

std::vector<Way> ways_of(const Case& scene, const Options& options, const ViewQualityImage& truth,
                         const std::vector<VoxelKey>& sample) {
  std::vector<Way> ways = {looking_at_all(scene, "exact", scene.viewpoints),
                           looking_at_all(scene, "fast", scene.viewpoints),
                           looking_at_all(scene, "grid", sample), looking_at_all(scene, "octomap", sample)};
  for (const char* sampling : {"feasible", "buckets", "paper"})
    for (const int samples : options.samples) {
      Way way = looking_at_all(scene, "fast", scene.viewpoints);
      way.sampling = sampling;
      way.options.samples = samples;
      if (way.sampling == "buckets") way.options.sampling = Sampling::kBuckets;
      if (way.sampling == "paper") way.options.estimator = ViewQualityOptions::Estimator::kPaper;
      way.errors.emplace(truth, scene.subject.grid.lattice(), scene.view.horizontal, kLambda, kPlaces);
      ways.push_back(std::move(way));
    }
  return ways;
}

// All ways in turn in each pass, so that a slow moment does not meet one of them only; every pass draws anew.
void measure(const Case& scene, int passes, std::vector<Way>& ways) {
  for (int pass = 0; pass < passes; ++pass)
    for (Way& way : ways) {
      way.options.seed = static_cast<std::uint64_t>(pass) + 1;
      const auto start = std::chrono::steady_clock::now();
      const std::clock_t cpu_start = std::clock();
      const ViewQualityImage image = rendered(scene, way);
      way.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
      way.ms.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
      if (way.errors) way.errors->add(image);
      way.pairs = 0;
      for (const ViewQuality& value : image.values()) way.pairs += value.drawn;
    }
}

void print(const Case& scene, const std::vector<Way>& ways) {
  const double exact_ms = median(ways.front().cpu_ms);
  std::printf("\n%s: %zu viewpoints, %zu frontiers; CPU ms, medians\n", scene.robot.c_str(),
              scene.viewpoints.size(), scene.frontiers.size());
  std::printf("%-8s %-9s %5s %8s %8s %9s %8s %8s %8s %8s %8s %8s %10s %9s %10s\n", "way", "sampling", "n_r",
              "ms", "CPU ms", "to exact", "rms", "said", "absolute", "bias", "missed", "best", "from place",
              "recounted", "Mpairs/s");
  for (const Way& way : ways) {
    const double cpu = median(way.cpu_ms);
    const bool whole = way.viewpoints.size() == scene.viewpoints.size();
    std::printf("%-8s %-9s %5s %8.1f %8.1f ", way.name.c_str(), way.sampling.c_str(),
                way.errors ? std::to_string(way.options.samples).c_str() : "all", median(way.ms), cpu);
    std::printf(whole ? "%9.2f " : "   (part) ", cpu / exact_ms);
    if (way.errors) {
      const ViewError error = way.errors->mean();
      std::printf("%8.4f %8.4f %8.4f %8.4f %8.4f %8.4f %10.4f %9.4f ", error.rms, error.predicted,
                  error.absolute, error.bias, error.missed, error.best_loss, error.place_loss,
                  error.recounted_loss);
    } else {
      std::printf("%74s ", "");
    }
    std::printf("%10.2f\n", way.pairs / cpu * 1e-3);
  }
  std::cout << std::flush;
}

constexpr const char* kHeader =
    "map,robot,viewpoints,frontiers,mean_gain,way,sampling,samples,passes,threads,ms,cpu_ms,drawn,"
    "drawn_per_cpu_s,rms_error,predicted_error,absolute_error,bias,missed,best_loss,place_loss,recounted_"
    "loss\n";

void write_rows(const Case& scene, const std::vector<Way>& ways, double mean_gain, const Options& options,
                std::ostream& out) {
  std::string map = scene.subject.name;
  std::ranges::replace_if(
      map, [](char c) { return c == ',' || c == '"' || c == '\n'; }, '_');
  for (const Way& way : ways) {
    const double cpu = median(way.cpu_ms);
    out << map << ',' << scene.robot << ',' << way.viewpoints.size() << ',' << scene.frontiers.size() << ','
        << mean_gain << ',' << way.name << ',' << way.sampling << ',';
    if (way.errors) out << way.options.samples;
    out << ',' << options.passes << ',' << options.threads << ',' << median(way.ms) << ',' << cpu << ','
        << way.pairs << ',' << way.pairs / cpu * 1e3;
    if (way.errors) {
      const ViewError e = way.errors->mean();
      out << ',' << e.rms << ',' << e.predicted << ',' << e.absolute << ',' << e.bias << ',' << e.missed
          << ',' << e.best_loss << ',' << e.place_loss << ',' << e.recounted_loss << '\n';
    } else {
      out << ",,,,,,,,\n";
    }
  }
}

// @return whether the exact image is what it has to be
bool run_case(const Case& scene, const Options& options, std::ostream& csv) {
  const ViewQualityImage truth = rendered(scene, looking_at_all(scene, "exact", scene.viewpoints));
  const auto sample = some_of(scene.viewpoints, options.octomap_viewpoints);
  if (!agrees(scene, truth, sample)) return false;
  std::vector<Way> ways = ways_of(scene, options, truth, sample);
  measure(scene, options.passes, ways);
  print(scene, ways);
  write_rows(scene, ways, ways.back().errors->mean_gain(), options, csv);
  return true;
}

// From the middle, side by side as a robot's corridor is: neighbours are what the exact renderer lives on.
std::vector<VoxelKey> slab(const std::vector<VoxelKey>& keys, std::size_t count) {
  if (keys.size() <= count) return keys;
  const auto begin = keys.begin() + static_cast<std::ptrdiff_t>((keys.size() - count) / 2);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

bool run_map(const std::filesystem::path& file, const Options& options, std::ostream& csv) {
  const auto subject = load_subject(file, file.stem().string());
  const PlannerScene scene(*subject, planner::Adjacency::kFaces, options.ground_viewpoints, 10'000'000);
  std::cout << subject->name << ": " << scene.frontiers.size() << " frontiers" << std::endl;
  const Case ground{"ugv", *subject, scene.ground.view, scene.ground_viewpoints, scene.frontiers, 0};
  const Case aerial{
      "uav",           *subject, scene.aerial.view, slab(scene.aerial_viewpoints, options.aerial_viewpoints),
      scene.frontiers, 36};
  return run_case(ground, options, csv) && run_case(aerial, options, csv);
}

void write_whole(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path unfinished = file.string() + ".unfinished";
  std::ofstream out(unfinished, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written; give a place that can");
  std::filesystem::rename(unfinished, file);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Measures how far drawn view quality lies from the exact one and what both cost, after checking that\n"
      "the exact one is what rays to all frontiers give."};
  app.add_option("--map", options.maps, "maps, .bt or .ot (default: the generated building_0.3m)");
  app.add_option("--samples", options.samples, "targets drawn for each viewpoint")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--viewpoints", options.ground_viewpoints, "of the ground robot, at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}));
  app.add_option("--viewpoints-in-space", options.aerial_viewpoints, "of the aerial robot, at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}));
  app.add_option("--checked", options.octomap_viewpoints,
                 "viewpoints that are compared, and that the slow casters are timed on")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}));
  app.add_option("--passes", options.passes, "medians are of so many; each draws anew")
      ->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "number of threads")->check(CLI::Range(1, 1024));
  app.add_option("--csv", options.csv, "write the table to this file");
  app.add_option("--map-cache", options.cache, "folder in which generated maps are kept");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  std::cout << cpu_name() << ", threads: " << options.threads << std::endl;
  if (options.maps.empty()) options.maps.push_back(generate_map("building_0.3m", options.cache));
  std::ostringstream csv;
  csv << kHeader;
  tbb::task_arena arena(options.threads);
  bool agreed = true;
  arena.execute([&] {
    for (const auto& map : options.maps) agreed = agreed && run_map(map, options, csv);
  });
  if (!agreed) {
    std::cerr << "\nThe exact image is not what rays give (see DISAGREEMENT above): nothing is written.\n";
    return 1;
  }
  if (!options.csv.empty()) write_whole(options.csv, csv.str());
  return 0;
}

}  // namespace
}  // namespace frontlux::bench

int main(int argc, char** argv) {
  return frontlux::bench::run_program("bench_view_error", frontlux::bench::run, argc, argv);
}
