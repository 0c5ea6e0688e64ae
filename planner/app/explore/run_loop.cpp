#include "explore/continuous_loop.hpp"
#include "explore/lockstep_loop.hpp"
#include "text.hpp"

namespace frontlux::app {

double fraction(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::optional<double> time_to(const RunNumbers& numbers, std::uint64_t observable, double part) {
  for (const Mapped& mapped : numbers.mapped)
    if (static_cast<double>(mapped.observable) >= part * static_cast<double>(observable)) return mapped.time;
  return std::nullopt;
}

double mean_coverage(const RunNumbers& numbers, std::uint64_t observable) {
  const double end = numbers.mapped.back().time;
  if (end <= 0.0) return fraction(numbers.mapped.back().observable, observable);
  double area = 0.0;
  for (std::size_t i = 1; i < numbers.mapped.size(); ++i)
    area += (numbers.mapped[i].time - numbers.mapped[i - 1].time) *
            fraction(numbers.mapped[i - 1].observable, observable);
  return area / end;
}

std::optional<RunEnd> limit_reached(const ExploreSetup& setup, const Mapped& mapped) {
  if (setup.stop_coverage && static_cast<double>(mapped.observable) >=
                                 *setup.stop_coverage * static_cast<double>(setup.head.observable))
    return RunEnd{"coverage", percent(*setup.stop_coverage) + " of the observable space is mapped"};
  if (setup.stop_time && mapped.time >= *setup.stop_time)
    return RunEnd{"time_limit", "the limit of " + fixed(*setup.stop_time, 1) + " s is reached"};
  return std::nullopt;
}

std::unique_ptr<RunLoop> make_run_loop(const ExploreSetup& setup) {
  if (setup.lockstep) return std::make_unique<LockstepLoop>(setup);
  return std::make_unique<ContinuousLoop>(setup);
}

}  // namespace frontlux::app
