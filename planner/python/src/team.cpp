#include "team.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/planner/exploration_start.hpp>
#include <frontlux/planner/goal_search.hpp>

#include <cmath>
#include <stdexcept>
#include <variant>

namespace frontlux::python {
namespace {

using planner::ExplorationOptions, planner::ExplorationStart, planner::GoalRule, planner::GoalSearch,
    planner::Method;
using planner::Robot;

KeyBox given_bounds(const Lattice& lattice, const py::object& object) {
  const Numbers bounds("bounds", object, 3);
  if (bounds.shape() != Shape{2})
    throw py::value_error("bounds: has to be of shape (2, 3), the lower and the upper corner [m]");
  const auto corner = [&](std::size_t i) {
    return Eigen::Vector3d(bounds.number(i, 0), bounds.number(i, 1), bounds.number(i, 2));
  };
  if (!corner(0).allFinite() || !corner(1).allFinite()) throw py::value_error("bounds: not finite");
  return planner::voxels_of(lattice, {corner(0), corner(1)});
}

// Nothing for tours, which only robots in motion make, and for what the method says.
std::optional<GoalRule> rule_of(const std::optional<std::string>& goal, bool lockstep) {
  if (!goal) return std::nullopt;
  if (const auto search = planner::goal_search(*goal); search && !(lockstep && search == GoalSearch::kTour))
    return planner::rule_of(*search);
  throw py::value_error("goal: '" + *goal + "', but has to be " + (lockstep ? "" : "'tour', ") +
                        "'render', 'cluster' or 'nearest'");
}

planner::SensorModel sensor_model_of(const std::string& name) {
  if (const auto model = planner::sensor_model(name)) return *model;
  throw py::value_error("sensor_model: '" + name + "', but has to be 'octomap' or 'cautious'");
}

// A robot whose body and height the planner accepts, above the bottom of the bounds.
Robot robot_above(const planner::RobotDescription& description, const Lattice& lattice,
                  const KeyBox& bounds) {
  Robot robot = description.robot;
  robot.travel.floor = (bounds.min.z - static_cast<double>(Lattice::kOrigin)) * lattice.resolution();
  try {
    planner::TravelCorridor(robot.travel, lattice, {bounds.min, bounds.min});
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("robot '" + robot.name + "': " + error.what());
  }
  return robot;
}

Team make_team(const TeamArguments& arguments, bool lockstep, Method method) {
  const bool tours = arguments.goal == "tour";
  Team team{arguments.robots,
            lockstep ? planner::exploration_options(method)
            : tours  ? planner::tour_options(arguments.resolution)
                     : planner::motion_options(method),
            {}};
  team.map.resolution = arguments.resolution;
  team.map.sensor_model = sensor_model_of(arguments.sensor_model);
  const Lattice lattice = team.lattice();
  team.map.bounds = given_bounds(lattice, arguments.bounds);
  const std::optional<GoalRule> rule = rule_of(arguments.goal, lockstep);
  ExplorationOptions& options = team.options;
  options.seed = arguments.seed;
  if (rule == GoalRule::kNearest) options.epsilon = 1.0;
  options.epsilon = arguments.epsilon.value_or(options.epsilon);
  options.max_steps = arguments.max_steps.value_or(options.max_steps);
  for (const auto& description : arguments.robots) {
    const Robot robot = robot_above(*description, lattice, team.map.bounds);
    planner::GoalOptions goal = lockstep ? planner::goal_options(robot, method, options.epsilon)
                                         : planner::motion_goal_options(robot, method, options.epsilon);
    goal.rule = rule.value_or(goal.rule);
    goal.rendering.seed = arguments.seed;
    options.team.push_back({robot, goal});
  }
  return team;
}

}  // namespace

const planner::RobotDescription& Team::robot(std::size_t number) const {
  if (number >= robots.size())
    throw py::value_error("robot: " + std::to_string(number) + ", but there are " +
                          std::to_string(robots.size()) + ", counted from 0");
  return *robots[number];
}

Team team_in_motion(const TeamArguments& arguments, double latency, double period) {
  Team team = make_team(arguments, false, Method::kDefault);
  team.options.latency = latency;
  team.options.period = period;
  team.options.check();
  return team;
}

Team team_in_lockstep(const TeamArguments& arguments, bool paper) {
  Team team = make_team(arguments, true, paper ? Method::kPaper : Method::kDefault);
  team.options.check();
  return team;
}

planner::Mapping mapping_of(const Team& team, const std::optional<std::filesystem::path>& known) {
  if (!known) return planner::Mapping(team.map);
  const Octree read = read_octree(*known);
  const auto* const tree = std::get_if<std::shared_ptr<octomap::OcTree>>(&read);
  if (tree == nullptr)
    throw std::invalid_argument("known: '" + known->string() + "' has colours, but has to be without");
  try {
    return {team.map, **tree};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("known: '" + known->string() + "': " + error.what());
  }
}

std::vector<ExplorationStart> starts_of(const Team& team, const py::object& object, double free_radius) {
  const Lattice lattice = team.lattice();
  const Numbers numbers("starts", object, 4);
  const auto robots = static_cast<py::ssize_t>(team.robots.size());
  if (numbers.shape() != Shape{robots})
    throw py::value_error("starts: shape " + text_of(with(numbers.shape(), 4)) + ", but has to be (" +
                          std::to_string(robots) + ", 4)");
  std::vector<ExplorationStart> starts;
  for (std::size_t r = 0; r < team.robots.size(); ++r) {
    const planner::Pose pose{{numbers.number(r, 0), numbers.number(r, 1), numbers.number(r, 2)},
                             numbers.number(r, 3)};
    const auto key = lattice.key(pose.position);
    if (!key || !team.map.bounds.contains(*key) || !std::isfinite(pose.yaw))
      throw py::value_error("starts: number " + std::to_string(r) + " is not finite, or outside the bounds");
    starts.push_back(start_at(lattice, team.options.team[r].robot, pose, free_radius));
  }
  return starts;
}

double known_volume(const VoxelGrid& grid) {
  const auto count = grid.count();
  return static_cast<double>(count[1] + count[2]) * std::pow(grid.resolution(), 3);
}

}  // namespace frontlux::python
