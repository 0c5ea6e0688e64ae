#include "explore/continuous_loop.hpp"
#include "explore/lockstep_loop.hpp"
#include "text.hpp"

namespace frontlux::app {

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
