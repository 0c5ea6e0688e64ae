#include "report.hpp"

#include "text.hpp"

#include <algorithm>
#include <cmath>

namespace frontlux::bench {
namespace {

/// @pre there are values
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::optional<double> median_of(const std::map<std::string, std::vector<double>>& samples,
                                const std::string& row) {
  const auto found = samples.find(row);
  if (found == samples.end()) return std::nullopt;
  return median(found->second);
}

std::string rays(double count) {
  if (count < 1e3) return cell("%.0f", count);
  if (count < 1e6) return cell("%.0f k", count * 1e-3);
  return cell("%.1f M", count * 1e-6);
}

struct Speed {
  const Recorder& recorder;
  const Trial& trial;
  std::span<const int> threads;

  [[nodiscard]] std::optional<double> rate(const Entry& entry, int count) const {
    return recorder.rate(row_name(trial, entry, count));
  }
  /// Against castRay on as many threads, the most that were timed.
  [[nodiscard]] std::optional<double> ratio(const Entry& entry) const {
    const auto ours = rate(entry, threads.back()), base = rate(trial.entries().front(), threads.back());
    if (!ours || !base) return std::nullopt;
    return *ours / *base;
  }
  /// Number of rays after which building the caster and casting is faster than castRay.
  [[nodiscard]] std::string pays_back(const Entry& entry) const {
    const auto ours = rate(entry, threads.back()), base = rate(trial.entries().front(), threads.back());
    if (!ours || !base) return "-";
    if (*ours <= *base) return "never";
    return rays(entry.build_seconds / (1 / *base - 1 / *ours));
  }
};

const Entry* find_entry(const Trial& trial, const std::string& caster) {
  const auto& entries = trial.entries();
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.caster == caster; });
  return found == entries.end() ? nullptr : &*found;
}

class Table {
 public:
  Table(std::span<const std::unique_ptr<Trial>> trials, std::span<const int> threads,
        const Recorder& recorder)
      : threads_(threads), recorder_(recorder) {
    for (const auto& trial : trials) {
      name_width_ = std::max(name_width_, name_of(*trial).size());
      for (const Entry& entry : trial->entries()) {
        if (std::find(casters_.begin(), casters_.end(), entry.caster) == casters_.end()) {
          casters_.push_back(entry.caster);
        }
      }
    }
  }

  [[nodiscard]] std::string head() const {
    const std::size_t block = kCell * casters_.size();
    std::string groups = pad("", name_width_ + 15),
                heads = pad("", name_width_) + pad("voxels", 8) + pad("hits", 7);
    for (const int count : threads_) {
      groups += " |" + centered("Mrays/s, " + words(count), block);
      heads += " |";
      for (const std::string& caster : casters_) heads += pad(caster, kCell);
    }
    groups += " |" + centered("times castRay", block - kCell) + " |" + centered("fast", 36);
    heads += " |";
    for (const std::string& caster : casters_) heads += caster == kBaseline ? "" : pad(caster, kCell);
    heads += " |" + pad("agrees", 8) + pad("build ms", 9) + pad("MB", 7) + pad("pays after", 12);
    return groups + '\n' + heads + '\n' + std::string(heads.size(), '-') + '\n';
  }

  [[nodiscard]] std::string row(const Trial& trial) const {
    const Speed speed{recorder_, trial, threads_};
    const auto value = [](std::optional<double> v) { return pad(v ? digits(*v) : "-", kCell); };
    std::string line = name_of(trial) + pad("", name_width_ - name_of(trial).size());
    line += pad(cell("%.1f", trial.mean_voxels()), 8) + pad(cell("%.1f %%", 100 * trial.positive_share()), 7);
    for (const int count : threads_) {
      line += " |";
      for (const std::string& caster : casters_) {
        const Entry* entry = find_entry(trial, caster);
        auto rate = entry == nullptr ? std::nullopt : speed.rate(*entry, count);
        if (rate) *rate *= 1e-6;
        line += value(rate);
      }
    }
    line += " |";
    for (const std::string& caster : casters_) {
      if (caster == kBaseline) continue;
      const Entry* entry = find_entry(trial, caster);
      line += value(entry == nullptr ? std::nullopt : speed.ratio(*entry));
    }
    if (const Entry* fast = find_entry(trial, "fast"); fast != nullptr) {
      line += " |" + pad(percent(fast->agreement), 8) + pad(digits(fast->build_seconds * 1e3), 9) +
              pad(digits(static_cast<double>(fast->bytes) * 1e-6), 7) + pad(speed.pays_back(*fast), 12);
    }
    return line + '\n';
  }

 private:
  static constexpr std::size_t kCell = 8;
  static constexpr const char* kBaseline = "octomap";

  static std::string name_of(const Trial& trial) { return trial.workload().name + "/" + trial.map(); }

  std::span<const int> threads_;
  const Recorder& recorder_;
  std::vector<std::string> casters_;
  std::size_t name_width_ = 0;
};

}  // namespace

std::string row_name(const Trial& trial, const Entry& entry, int threads) {
  return trial.workload().name + "/" + trial.map() + "/" + entry.caster +
         "/threads:" + std::to_string(threads);
}

bool Recorder::ReportContext(const Context&) { return true; }

void Recorder::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    const auto rate = run.counters.find("items_per_second");
    if (run.run_type != Run::RT_Iteration || run.error_occurred || rate == run.counters.end()) continue;
    std::string name = run.run_name.str();
    if (const auto suffix = name.rfind("/real_time"); suffix != std::string::npos) name.resize(suffix);
    rates_[name].push_back(rate->second.value);
    const auto busy = run.counters.find("busy_processors");
    if (busy != run.counters.end()) busy_processors_[name].push_back(busy->second.value);
  }
}

std::optional<double> Recorder::rate(const std::string& row) const { return median_of(rates_, row); }

std::optional<double> Recorder::busy_processors(const std::string& row) const {
  return median_of(busy_processors_, row);
}

std::optional<Recorder::Spread> Recorder::spread() const {
  std::vector<double> spreads;
  for (const auto& [row, rates] : rates_) {
    if (rates.size() < 2) continue;
    const auto [low, high] = std::minmax_element(rates.begin(), rates.end());
    spreads.push_back((*high - *low) / median(rates));
  }
  if (spreads.empty()) return std::nullopt;
  return Spread{median(spreads), *std::max_element(spreads.begin(), spreads.end())};
}

void print_table(std::span<const std::unique_ptr<Trial>> trials, std::span<const int> threads,
                 const Recorder& recorder, std::ostream& out) {
  const Table table(trials, threads, recorder);
  out << '\n' << table.head();
  for (const auto& trial : trials) out << table.row(*trial);
  out << "\nvoxels: entered per ray. hits: visible, or stopped by an occupied voxel. times castRay: ratio of "
         "the "
         "medians on "
      << words(threads.back())
      << ".\nagrees: with castRay bit for bit, or between voxel keys with the integer rule. build, MB: from "
         "the "
         "tree to the caster, grid included.\npays after: so many rays until building and casting is faster "
         "than "
         "castRay.\n";
  std::vector<std::string> rows;
  for (const auto& trial : trials) {
    for (const Entry& entry : trial->entries()) rows.push_back(row_name(*trial, entry, threads.back()));
  }
  print_cautions(rows, threads.back(), recorder, out);
}

void print_cautions(std::span<const std::string> rows, int threads, const Recorder& recorder,
                    std::ostream& out) {
  std::vector<double> busy;
  for (const std::string& row : rows) {
    if (const auto processors = recorder.busy_processors(row)) busy.push_back(*processors);
  }
  if (const double typical = busy.empty() ? threads : median(busy); typical < 0.9 * threads) {
    out << "CAUTION: rows of " << words(threads) << " kept only " << cell("%.1f", typical)
        << " processors busy: others use this machine, or the batches are small.\n";
  }
  if (const auto spread = recorder.spread()) {
    out << "The repetitions of a row lie " << cell("%.0f %%", 100 * spread->typical)
        << " apart (median of all rows; the worst " << cell("%.0f %%", 100 * spread->worst) << ").\n";
  }
}

}  // namespace frontlux::bench
