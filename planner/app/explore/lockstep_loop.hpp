#pragma once

#include "explore/run_loop.hpp"

#include <frontlux/sim/path_revisits.hpp>
#include <frontlux/sim/simulated_robots.hpp>

#include <vector>

namespace frontlux::app {

/// Alg. 1 as printed: all robots plan, all move and stop at each viewpoint to measure, all have arrived.
class LockstepLoop final : public RunLoop {
 public:
  explicit LockstepLoop(const ExploreSetup& setup);

  planner::ExplorationStep step() override;
  bool repeat(const planner::ExplorationStep& recorded) override;
  std::optional<RunEnd> end() const override;
  const planner::Mapping& mapping() const override { return exploration_.mapping(); }
  const RunNumbers& numbers() const override { return numbers_; }

 private:
  [[nodiscard]] planner::Drive drive();
  void note(const planner::ExplorationStep& step);

  const ExploreSetup& setup_;
  sim::SimulatedRobots robots_;
  planner::Exploration exploration_;
  RunNumbers numbers_;
  std::vector<sim::PathRevisits> paths_;  // of each robot
  bool begun_ = false;
};

}  // namespace frontlux::app
