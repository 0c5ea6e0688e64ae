#pragma once

#include "support/test.hpp"

#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/ground_truth.hpp>
#include <frontlux/sim/start_pose.hpp>

#include <string_view>

namespace frontlux::sim::test {

/// A world, where in it robots start, and what can be reached from there.
struct Place {
  World world;
  double resolution = 0.3;
  Eigen::Vector3d start;
  GroundTruth truth{world, resolution, start};

  Place(World in, bool faces_away, double edge = 0.3)
      : world(std::move(in)), resolution(edge), start(free_start(world, edge, faces_away)) {}
  Place(std::string_view name, std::uint64_t seed) : Place(make_world(name, seed), true) {}

  [[nodiscard]] std::vector<std::optional<planner::Pose>> starts(
      const std::vector<planner::Robot>& team) const {
    return find_starts(truth, start, team);
  }
};

}  // namespace frontlux::sim::test
