#pragma once

#include "setup/explore_options.hpp"
#include "setup/team.hpp"
#include "world_source.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/scan_messages.hpp>
#include <frontlux/sim/sensor.hpp>
#include <frontlux/sim/simulated_robots.hpp>

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <vector>

namespace frontlux::app {

/// Everything that a run starts with.
struct ExploreSetup {
  SourcedWorld sourced;
  std::unique_ptr<const sim::GroundTruth> truth;
  sim::RangeErrors errors;
  sim::PoseErrors pose_errors;
  sim::MessageErrors message_errors;
  std::vector<Attendance> attendance;  // of each robot
  bool lockstep = false;
  sim::AtContact at_contact = sim::AtContact::kStay;
  std::optional<double> stop_coverage;  // 0 to 1, of the observable voxels
  std::optional<double> stop_time;      // [s]
  planner::SensorModel sensor_model = planner::kOctomapSensorModel;
  planner::ExplorationOptions exploration;
  planner::RecordingHead head;  // with the robots and their starts
  // [m] In the world's frame before the ground is aligned.
  std::optional<Eigen::Vector3f> given_start;
  // In the same frame: of the robots whose starts are not looked for.
  std::vector<std::optional<planner::Pose>> given_starts;
};

/// Makes or reads the world, puts the robots at their starts, and checks all options.
/// @param robots  of a resumed run; nothing: those that the options name
/// @throws BadInput
[[nodiscard]] ExploreSetup make_setup(const ExploreOptions& options,
                                      const std::optional<std::vector<planner::RobotDescription>>& robots);

}  // namespace frontlux::app
