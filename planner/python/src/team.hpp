#pragma once

#include "poses.hpp"

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/planner/robot.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::python {

/// Who explores what, and how.
struct Team {
  std::vector<std::shared_ptr<planner::RobotDescription>> robots;
  planner::ExplorationOptions options;
  planner::MappingOptions map;

  [[nodiscard]] Lattice lattice() const { return Lattice(map.resolution); }
  /// @throws py::value_error if there is no such robot
  [[nodiscard]] const planner::RobotDescription& robot(std::size_t number) const;
};

/// What Python says of a team; the values that are not given are those of `frontlux explore`.
struct TeamArguments {
  std::vector<std::shared_ptr<planner::RobotDescription>> robots;
  py::object bounds;
  double resolution = 0.3;
  std::optional<std::string> goal;
  std::uint64_t seed = 1;
  std::optional<double> epsilon;
  std::optional<int> max_steps;
  std::string sensor_model = "octomap";
};

/// What a team knows at the beginning: nothing, or the map in a file.
/// @throws std::invalid_argument naming the file, if it has colours or another resolution;
///         std::runtime_error from `read_octree`
[[nodiscard]] planner::Mapping mapping_of(const Team& team,
                                          const std::optional<std::filesystem::path>& known);

/// Of robots in motion.
/// @throws py::value_error naming the argument; std::invalid_argument naming the robot's value
[[nodiscard]] Team team_in_motion(const TeamArguments& arguments, double latency, double period);
/// Of robots in lock-step.
/// @param paper  the method as printed
/// @throws the same
[[nodiscard]] Team team_in_lockstep(const TeamArguments& arguments, bool paper);

/// Of each robot: its pose, of shape (r, 4), and the free voxels around it.
/// @throws py::value_error naming the argument
[[nodiscard]] std::vector<planner::ExplorationStart> starts_of(const Team& team, const py::object& starts,
                                                               double free_radius);

/// [m^3] of all free and occupied voxels.
[[nodiscard]] double known_volume(const VoxelGrid& grid);

}  // namespace frontlux::python
