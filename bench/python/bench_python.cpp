// How much of the engine's speed is left in Python: the same million queries by a call in C++ and by one of
// the module `frontlux`, whose answers are compared first. bench_python [MAP.bt]

#include "rays/subject.hpp"
#include "rays/workload.hpp"
#include "table.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/stopwatch.hpp>

#include <pybind11/embed.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <ranges>
#include <stdexcept>

namespace {

namespace py = pybind11;
using namespace frontlux;

constexpr std::size_t kQueries = 1'000'000;
constexpr int kRounds = 15;

// An array of shape (n, width): row i holds what `get(queries[i])` points to.
template <class Number, class Query, class Get>
py::array_t<Number> to_array(const std::vector<Query>& queries, py::ssize_t width, const Get& get) {
  py::array_t<Number> array({static_cast<py::ssize_t>(queries.size()), width});
  Number* to = array.mutable_data();
  for (const Query& query : queries) to = std::copy_n(get(query), width, to);
  return array;
}

void expect(bool equal, const char* what) {
  if (!equal) throw std::runtime_error(std::string(what) + ": Python's answers differ from C++'s");
}

// Calls both in turns, and adds a row with the median of each.
template <class InCpp, class InPython>
void compare(const std::string& name, bench::Table& table, const InCpp& in_cpp, const InPython& in_python) {
  std::vector<double> cpp, python, cpp_work, python_work;
  for (int round = 0; round <= kRounds; ++round) {
    const auto measure = [round](const auto& call, std::vector<double>& seconds, std::vector<double>& work) {
      const std::clock_t begin = std::clock();
      const Stopwatch watch;
      call();
      if (round == 0) return;  // pays for pages
      seconds.push_back(watch.seconds());
      work.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    };
    measure(in_cpp, cpp, cpp_work);
    measure(in_python, python, python_work);
  }
  const auto rate = [](const std::vector<double>& seconds) {
    return kQueries * 1e-6 / bench::median(seconds);
  };
  table.add_row({name, bench::format("%.1f", rate(cpp)), bench::format("%.1f", rate(python)),
                 bench::format("%.2f", rate(python) / rate(cpp)),
                 bench::format("%.2f", rate(python_work) / rate(cpp_work))});
}

bench::Workload made(bench::WorkloadSource& source, const char* name) {
  bench::Workload workload = source.make(name, kQueries);
  if (workload.size() == 0) throw std::runtime_error(std::string(name) + ": " + workload.skipped);
  return workload;
}

void run(const std::string& file) {
  const py::object module = py::module_::import("frontlux");
  const VoxelGrid grid = make_voxel_grid(read_octree(file));
  bench::check_is_place(grid, file);
  const auto caster = make_ray_caster(grid);
  const py::object python = module.attr("RayCaster")(module.attr("VoxelGrid").attr("read")(file));
  bench::WorkloadSource source(grid, *caster);
  bench::Table table;
  table.add_columns("", {"million queries", "C++ [M/s]", "Python [M/s]", "ratio", "by processor time"});

  for (const char* name : {"cast_lidar", "cast_random"}) {
    std::vector<Ray> rays;
    const bench::Workload workload = made(source, name);
    for (const bench::RayBatch& batch : workload.batches)
      rays.insert(rays.end(), batch.rays.begin(), batch.rays.end());
    for (std::size_t i = 0; rays.size() < kQueries; ++i) rays.push_back(rays[i]);
    rays.resize(kQueries);
    const auto origins = to_array<float>(rays, 3, [](const Ray& ray) { return ray.origin.data(); });
    const auto directions = to_array<float>(rays, 3, [](const Ray& ray) { return ray.direction.data(); });
    const auto ranges = to_array<double>(rays, 1, [](const Ray& ray) { return &ray.max_range; });
    const py::object max_range = ranges.attr("ravel")();

    std::vector<Hit> hits(kQueries);
    py::object arrays;
    const auto in_cpp = [&] { caster->cast(rays, hits, UnknownPolicy::kPass); };
    const auto in_python = [&](const py::object& out) {
      arrays = python.attr("cast")(origins, directions, max_range, "pass", out);
    };
    in_cpp();
    in_python(py::none());
    const auto ends = arrays["end"].cast<py::array_t<float>>();
    const auto stops = arrays["stop"].cast<py::array_t<std::uint8_t>>();
    for (std::size_t i = 0; i < kQueries; ++i)
      expect(std::equal(hits[i].end.begin(), hits[i].end.end(), ends.data() + 3 * i) &&
                 static_cast<std::uint8_t>(hits[i].stop) == stops.data()[i],
             name);
    const py::object out = arrays;
    compare(name, table, in_cpp, [&] { in_python(py::none()); });
    compare(std::string(name) + ", out", table, in_cpp, [&] { in_python(out); });
  }

  std::vector<KeySegment> segments = made(source, "visible_uav").segments;
  for (std::size_t i = 0; segments.size() < kQueries; ++i) segments.push_back(segments[i]);
  segments.resize(kQueries);
  const auto from = to_array<std::uint16_t>(segments, 3, [](const KeySegment& s) { return &s.from.x; });
  const auto to = to_array<std::uint16_t>(segments, 3, [](const KeySegment& s) { return &s.to.x; });
  std::vector<std::uint8_t> visible(kQueries);
  const auto in_cpp = [&] { caster->visible(segments, visible, UnknownPolicy::kBlock); };
  py::array_t<bool> seen;
  const auto in_python = [&] { seen = python.attr("visible")(from, to).cast<py::array_t<bool>>(); };
  in_cpp();
  in_python();
  expect(std::ranges::equal(visible, std::span(seen.data(), kQueries)), "visible_uav");
  compare("visible_uav", table, in_cpp, in_python);
  std::cout << file << ", medians of " << kRounds << " calls\n" << table.text();
}

}  // namespace

int main(int argc, char** argv) {
  const py::scoped_interpreter interpreter;
  py::module_::import("sys").attr("path").attr("insert")(0, FRONTLUX_PYTHON_MODULE);
  try {
    run(argc > 1 ? argv[1] : FRONTLUX_DATA_DIR "/maps/storage_0.2m.bt");
  } catch (const std::exception& error) {
    std::cerr << "bench_python: " << error.what() << '\n';
    return 1;
  }
}
