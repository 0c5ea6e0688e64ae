// The error of sampled view quality against exact view quality, and the time of both. Exact values are first
// compared with those of rays to all frontiers.

#include "options.hpp"
#include "planner/planner_scene.hpp"
#include "rays/subject.hpp"
#include "table.hpp"
#include "view_error/error.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/stopwatch.hpp>

#include <tbb/task_arena.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

constexpr double kLambda = 0.1386;  // [1/m] of eq. 1, as `GoalOptions` has it
constexpr std::size_t kPlaces = 64;

// One robot on one map.
struct Case {
  std::string robot;
  const Subject& subject;
  FieldOfView view;
  std::vector<VoxelKey> viewpoints, frontiers;
  int azimuth_bins;
};

// A method to render some viewpoints, and the measurements of its passes.
struct Method : Rendering {
  std::string sampling;  // empty: all frontiers
  std::span<const VoxelKey> viewpoints;
  std::vector<double> ms{}, cpu_ms{};
  double pairs = 0;
  std::optional<ErrorSum> errors{};
};

ViewQualityImage rendered(const Case& scene, const Method& method) {
  return render_view_quality(*method.caster, scene.subject.grid.lattice(), method.viewpoints, scene.frontiers,
                             scene.view, method.options);
}

Method all_by(const Case& scene, const std::string& name, std::span<const VoxelKey> viewpoints) {
  return {all_frontiers(scene.subject, name, scene.azimuth_bins), "", viewpoints};
}

// Whether the exact image of a sample is that of rays to all frontiers, and part of the whole image.
bool agrees(const Case& scene, const ViewQualityImage& truth, const std::vector<VoxelKey>& sample) {
  const auto exact = rendered(scene, all_by(scene, kExact, sample));
  bool equal = true;
  for (const std::string name : {kGrid, kFast, kEmbree, kOctomap}) {
    const ViewQualityImage image = rendered(scene, all_by(scene, name, sample));
    const std::size_t different = differing(exact, image);
    const bool wrong = different != 0 && name != kOctomap;
    equal = equal && !wrong;
    std::cout << "  " << scene.robot << ": " << name << " differs from exact at " << different << " of "
              << sample.size() << " viewpoints; total gain "
              << 100.0 * total(image, &ViewQuality::gain) / total(exact, &ViewQuality::gain)
              << " % of the exact one" << (wrong ? " DISAGREEMENT" : "") << std::endl;
  }
  std::size_t different = 0, at = 0;
  for (std::size_t i = 0; i < truth.size() && at < sample.size(); ++i)
    if (truth.viewpoints()[i] == sample[at]) different += truth.values()[i] != exact.values()[at++] ? 1 : 0;
  if (different != 0 || at != sample.size())
    std::cout << "  " << scene.robot << ": the exact image of all viewpoints has other values DISAGREEMENT"
              << std::endl;
  return equal && different == 0 && at == sample.size();
}

std::vector<Method> methods_of(const Case& scene, const ViewErrorOptions& options,
                               const ViewQualityImage& truth, const std::vector<VoxelKey>& sample) {
  std::vector<Method> methods = {all_by(scene, kExact, scene.viewpoints),
                                 all_by(scene, kFast, scene.viewpoints), all_by(scene, kEmbree, sample),
                                 all_by(scene, kGrid, sample), all_by(scene, kOctomap, sample)};
  for (const char* sampling : {"feasible", "buckets", "paper"})
    for (const int samples : options.samples) {
      Method method = all_by(scene, kFast, scene.viewpoints);
      method.sampling = sampling;
      method.options.samples = samples;
      if (method.sampling == "buckets") method.options.sampling = ViewQualityOptions::Sampling::kBuckets;
      if (method.sampling == "paper") method.options.estimator = ViewQualityOptions::Estimator::kPaper;
      method.errors.emplace(truth, scene.subject.grid.lattice(), scene.view.horizontal, kLambda, kPlaces);
      methods.push_back(std::move(method));
    }
  return methods;
}

// Each pass runs all methods in turn, so that a slow moment does not affect only one; every pass draws anew.
void measure(const Case& scene, int passes, std::vector<Method>& methods) {
  for (int pass = 0; pass < passes; ++pass)
    for (Method& method : methods) {
      method.options.seed = static_cast<std::uint64_t>(pass) + 1;
      const Stopwatch watch;
      const std::clock_t cpu_start = std::clock();
      const ViewQualityImage image = rendered(scene, method);
      method.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
      method.ms.push_back(watch.milliseconds());
      if (method.errors) method.errors->add(image);
      method.pairs = total(image, &ViewQuality::drawn);
    }
}

std::vector<double> errors_of(const Method& method) {
  if (!method.errors) return {};
  const ViewError e = method.errors->mean();
  return {e.rms, e.predicted, e.absolute, e.bias, e.missed, e.best_loss, e.place_loss, e.recounted_loss};
}

void print(const Case& scene, const std::vector<Method>& methods) {
  const double exact_ms = median(methods.front().cpu_ms);
  Table table;
  table.add_columns("", {"method", "sampling", "n_r"});
  table.add_columns("medians of the passes", {"ms", "CPU ms", "CPU / exact", "Mpairs/s"});
  table.add_columns("error", {"rms", "predicted", "absolute", "bias", "missed"});
  table.add_columns("loss", {"best", "from place", "recounted"});
  for (const Method& method : methods) {
    const double cpu = median(method.cpu_ms);
    const bool whole = method.viewpoints.size() == scene.viewpoints.size();
    std::vector<std::string> row{method.name,
                                 method.sampling,
                                 method.errors ? std::to_string(method.options.samples) : "all",
                                 format("%.1f", median(method.ms)),
                                 format("%.1f", cpu),
                                 whole ? format("%.2f", cpu / exact_ms) : "(part)",
                                 format("%.2f", method.pairs / cpu * 1e-3)};
    for (const double error : errors_of(method)) row.push_back(format("%.4f", error));
    table.add_row(std::move(row));
  }
  std::cout << '\n'
            << scene.robot << ": " << scene.viewpoints.size() << " viewpoints, " << scene.frontiers.size()
            << " frontiers\n"
            << table.text() << std::flush;
}

constexpr const char* kHeader =
    "map,robot,viewpoints,frontiers,mean_gain,method,sampling,samples,passes,threads,ms,cpu_ms,drawn,"
    "drawn_per_cpu_s,rms_error,predicted_error,absolute_error,bias,missed,best_loss,place_loss,recounted_"
    "loss\n";

void write_rows(const Case& scene, const std::vector<Method>& methods, const ViewErrorOptions& options,
                std::ostream& out) {
  std::string map = scene.subject.name;
  std::ranges::replace_if(
      map, [](char c) { return c == ',' || c == '"' || c == '\n'; }, '_');
  for (const Method& method : methods) {
    const double cpu = median(method.cpu_ms);
    out << map << ',' << scene.robot << ',' << method.viewpoints.size() << ',' << scene.frontiers.size()
        << ',' << methods.back().errors->mean_gain() << ',' << method.name << ',' << method.sampling << ','
        << (method.errors ? std::to_string(method.options.samples) : "") << ',' << options.passes << ','
        << options.threads.front() << ',' << median(method.ms) << ',' << cpu << ',' << method.pairs << ','
        << method.pairs / cpu * 1e3;
    for (const double error : errors_of(method)) out << ',' << error;
    out << (method.errors ? "\n" : ",,,,,,,,\n");
  }
}

// @return whether the exact image is right
bool run_case(const Case& scene, const ViewErrorOptions& options, std::ostream& csv) {
  const ViewQualityImage truth = rendered(scene, all_by(scene, kExact, scene.viewpoints));
  const auto sample = thinned(scene.viewpoints, options.checked_viewpoints);
  if (!agrees(scene, truth, sample)) return false;
  std::vector<Method> methods = methods_of(scene, options, truth, sample);
  measure(scene, options.passes, methods);
  print(scene, methods);
  write_rows(scene, methods, options, csv);
  return true;
}

// From the middle, side by side as the cells of a corridor are: the exact renderer needs neighbours.
std::vector<VoxelKey> slab(const std::vector<VoxelKey>& keys, std::size_t count) {
  if (keys.size() <= count) return keys;
  const auto begin = keys.begin() + static_cast<std::ptrdiff_t>((keys.size() - count) / 2);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

bool run_map(const std::filesystem::path& file, std::set<std::string>& names, const ViewErrorOptions& options,
             std::ostream& csv) {
  const auto subject = load_subject(file, unique_name(file, names));
  const PlannerScene scene(*subject, Adjacency::kFaces, options.ground_viewpoints, 10'000'000);
  std::cout << subject->name << ": " << scene.frontiers.size() << " frontiers" << std::endl;
  const Case ground{"ugv", *subject, scene.ground.view, scene.ground_viewpoints, scene.frontiers, 0};
  const Case aerial{"uav",
                    *subject,
                    scene.aerial.view,
                    slab(scene.aerial_viewpoints, options.aerial_viewpoints),
                    scene.frontiers,
                    kAzimuthBins};
  return run_case(ground, options, csv) && run_case(aerial, options, csv);
}

}  // namespace

int run(int argc, char** argv) {
  ViewErrorOptions options = read_view_error_options(argc, argv);
  std::cout << processor_name() << ", " << thread_count(options.threads.front()) << std::endl;
  if (options.maps.empty()) options.maps.push_back(generate_map("building_0.3m", options.cache));
  std::ostringstream csv;
  csv << kHeader;
  std::set<std::string> names;
  const bool agreed = tbb::task_arena(options.threads.front()).execute([&] {
    return std::ranges::all_of(options.maps,
                               [&](const auto& map) { return run_map(map, names, options, csv); });
  });
  if (!agreed) {
    std::cerr
        << "\nThe exact values differ from those of rays (see DISAGREEMENT above): nothing is written.\n";
    return 1;
  }
  if (!options.csv.empty()) write_file(options.csv, csv.str());
  return 0;
}

}  // namespace frontlux::bench
