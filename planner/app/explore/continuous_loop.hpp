#pragma once

#include "explore/run_loop.hpp"

#include <frontlux/planner/continuous_exploration.hpp>
#include <frontlux/sim/moving_robots.hpp>
#include <frontlux/sim/scan_messages.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frontlux::app {

/// Robots in motion, under a clock: scans at the sensors' rates, and plannings in between.
class ContinuousLoop final : public RunLoop {
 public:
  explicit ContinuousLoop(const ExploreSetup& setup);

  planner::ExplorationStep step() override;
  bool repeat(const planner::ExplorationStep& recorded) override;
  std::optional<RunEnd> end() const override { return end_; }
  const planner::Mapping& mapping() const override { return exploration_.mapping(); }
  const RunNumbers& numbers() const override { return numbers_; }
  MotionRows take_rows() override { return std::exchange(rows_, {}); }

 private:
  // The next step; `recorded` if it is taken again, with the times that it took then.
  planner::ExplorationStep go_on(const planner::ExplorationStep* recorded);
  planner::ExplorationStep plan_or_finish(const planner::ExplorationStep* recorded);
  void note_end();
  bool note_attendance();
  [[nodiscard]] double next_moment() const;
  void move_and_sense();
  void count(const MapChange& change, Mapped& mapped);
  void note_numbers(Mapped mapped);
  void judge_contacts();
  void note_motion(std::span<const sim::MovingRobots::Stopped> stopped);
  void note_plan(const planner::PlannedMotion& planned, const planner::ExplorationStep& measured);

  const ExploreSetup& setup_;
  sim::MovingRobots robots_;
  sim::ScanMessages scans_;
  planner::ContinuousExploration exploration_;
  VoxelGrid known_;  // what is counted as mapped
  RunNumbers numbers_;
  std::vector<std::size_t> judged_;  // contacts of each robot, by the map
  std::optional<RunEnd> end_;
  bool begun_ = false;
  int plannings_ = 0;
  double time_ = 0.0;          // [s] until which robots have moved
  std::uint64_t samples_ = 0;  // of the motion
  MotionRows rows_;
};

}  // namespace frontlux::app
