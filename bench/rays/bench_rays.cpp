// Rays per second of every ray caster on OctoMap maps: answers are checked first, then timed.

#include "google_benchmark.hpp"
#include "rays/subject.hpp"
#include "rays/trial.hpp"
#include "rays/workload.hpp"
#include "table.hpp"

#ifdef FRONTLUX_BENCH_NANOVDB
#include "peers/nanovdb_peer.hpp"
#endif
#ifdef FRONTLUX_BENCH_OPEN3D
#include "peers/open3d_peer.hpp"
#endif

#include <tbb/task_arena.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::bench {
namespace {

/// Everything that the timed rows refer to.
struct Session {
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<std::unique_ptr<Trial>> trials;
  bool any_wanted = false, agreed = true;
};

/// Whether a row of a trial passes the filter, so that the others need not be prepared.
bool wanted(const std::string& trial, const std::vector<std::string>& casters,
            const std::vector<int>& threads) {
  for (const std::string& caster : casters)
    for (const int count : threads)
      if (passes_filter(row_name(trial, caster, count) + "/real_time")) return true;
  return false;
}

/// Those that this program was built with, and says what they cost.
std::vector<Peer> make_peers([[maybe_unused]] const Subject& subject) {
  std::vector<Peer> peers;
#ifdef FRONTLUX_BENCH_NANOVDB
  peers.push_back(make_nanovdb_peer(subject.grid));
#endif
#ifdef FRONTLUX_BENCH_OPEN3D
  if (auto peer = make_open3d_peer(subject.grid))
    peers.push_back(*std::move(peer));
  else
    std::cout << "  open3d left out: with this Embree its rays hit nothing" << std::endl;
#endif
  for (Peer& peer : peers) {
    peer.build_seconds += subject.grid_seconds;  // they are made from the grid, as ours are
    std::cout << "  " << peer.caster << ": " << describe(peer) << std::endl;
  }
  return peers;
}

/// Reads a map, draws its workloads, and checks all answers on them.
void prepare(const std::filesystem::path& file, const std::string& name, const RaysOptions& options,
             Session& session) {
  session.subjects.push_back(load_subject(file, name));
  const Subject& subject = *session.subjects.back();
  std::cout << describe(subject) << std::endl;

  const std::vector<Peer> peers = options.peers ? make_peers(subject) : std::vector<Peer>{};
  std::vector<std::string> casters{kOctomap, kFast, kEmbree, kGrid};
  for (const Peer& peer : peers) casters.push_back(peer.caster);
  WorkloadSource source(subject.grid, subject.caster(kGrid));
  for (const std::string_view query : kWorkloads) {
    if (!wanted(std::string(query) + "/" + name, casters, options.threads)) continue;
    session.any_wanted = true;
    Workload workload = source.make(query, options.rays);
    if (workload.size() == 0) {
      std::cout << "  " << query << " skipped: " << workload.skipped << std::endl;
      continue;
    }
    auto trial = std::make_unique<Trial>(subject, std::move(workload), peers);
    session.agreed = trial->check(options.threads, std::cout) && session.agreed;
    std::cout.flush();
    session.trials.push_back(std::move(trial));
  }
}

std::string ray_count(double count) {
  if (count < 1e6) return format(count < 1e3 ? "%.0f" : "%.0f k", count < 1e3 ? count : count * 1e-3);
  return format("%.1f M", count * 1e-6);
}

/// One line per workload and map: rates, speed-up over castRay, agreement, and when a caster pays off.
void print_table(const Session& session, const std::vector<int>& threads, const GoogleBenchmark& timed) {
  std::vector<std::string> casters;
  for (const auto& trial : session.trials)
    for (const Entry& entry : trial->entries())
      if (std::ranges::find(casters, entry.caster) == casters.end()) casters.push_back(entry.caster);
  const std::vector<std::string> ours(casters.begin() + 1, casters.end());
  Table table;
  table.add_columns("", {"", "voxels", "hits"});
  for (const int count : threads) table.add_columns("Mrays/s, " + thread_count(count), casters);
  table.add_columns("times castRay", ours);
  table.add_columns("agrees", casters);
  table.add_columns("pays off after rays", ours);
  for (const auto& trial : session.trials) {
    std::vector<std::string> row{trial->name(), format("%.1f", trial->mean_voxels()),
                                 format("%.1f %%", 100 * trial->positive_fraction())};
    const auto rate = [&](const std::string& caster, int count) {
      return timed.rate(row_name(trial->name(), caster, count));
    };
    for (const int count : threads)
      for (const std::string& caster : casters) {
        const auto found = rate(caster, count);
        row.push_back(found ? digits(*found * 1e-6) : "-");
      }
    const auto add = [&](const std::vector<std::string>& columns, auto text) {
      for (const std::string& caster : columns) {
        const auto entry = std::ranges::find(trial->entries(), caster, &Entry::caster);
        row.push_back(entry == trial->entries().end() ? "-" : text(*entry));
      }
    };
    const auto base = rate(kOctomap, threads.back());
    add(ours, [&](const Entry& entry) -> std::string {
      const auto own = rate(entry.caster, threads.back());
      return own && base ? digits(*own / *base) : "-";
    });
    add(casters, [](const Entry& entry) { return percent(entry.agreement); });
    add(ours, [&](const Entry& entry) -> std::string {
      const auto own = rate(entry.caster, threads.back());
      if (!own || !base) return "-";
      return *own <= *base ? "never" : ray_count(entry.build_seconds / (1 / *base - 1 / *own));
    });
    table.add_row(std::move(row));
  }
  std::cout << '\n'
            << table.text() << R"(
voxels: entered per ray. hits: visible, or stopped by an occupied voxel. times castRay: ratio of the medians on most
threads, of passes that follow each other. agrees: with castRay bit for bit, or between voxel keys with the integer rule,
from which castRay itself differs by rounding. pays off: number of rays after which building and casting together is
faster than castRay. The lines of the maps have build times and memory, from the octree to the caster, the grid's time
included; of fast without Embree's scene, which is built once many rays have needed it.
)";
  timed.print_cautions(std::cout);
}

}  // namespace

int run(int argc, char** argv) {
  const RaysOptions options = read_rays_options(argc, argv);
#if !defined(FRONTLUX_BENCH_NANOVDB) && !defined(FRONTLUX_BENCH_OPEN3D)
  if (options.peers)
    throw std::runtime_error("--peers: built without NanoVDB (Debian: libnanovdb-dev) and without Open3D");
#endif
  GoogleBenchmark google_benchmark(argv[0], options);
  Session session;
  tbb::task_arena(options.threads.back()).execute([&] {
    std::set<std::string> names(options.generated.begin(), options.generated.end());
    for (const std::string& name : options.generated)
      prepare(generate_map(name, options.cache), name, options, session);
    for (const auto& file : options.maps) prepare(file, unique_name(file, names), options, session);
  });
  if (!google_benchmark.may_run(session.agreed)) return 1;
  if (!session.any_wanted) throw_no_row_passes();
  if (session.trials.empty()) {
    std::cout << "Nothing to measure.\n";
    return 0;
  }
  for (const auto& trial : session.trials)
    for (const Entry& entry : trial->entries())
      for (const int threads : options.threads)
        google_benchmark.add(row_name(trial->name(), entry.caster, threads), threads,
                             trial->workload().size(), entry.pass, trial->counters(entry));
  google_benchmark.run();
  print_table(session, options.threads, google_benchmark);
  return 0;
}

}  // namespace frontlux::bench
