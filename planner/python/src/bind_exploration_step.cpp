#include "bindings.hpp"
#include "poses.hpp"

#include <frontlux/python/arrays.hpp>

#include <pybind11/stl.h>

#include <limits>

namespace frontlux::python {
namespace {

using planner::ExplorationStep, planner::RobotStep;
using Self = std::shared_ptr<ExplorationStep>;

// A value of each robot, float64 or int64 (r,).
template <class Number, class Value>
auto of_robots(Value value) {
  return [value](const Self& self) {
    py::array_t<Number> array(static_cast<py::ssize_t>(self->robots.size()));
    Number* numbers = array.mutable_data();
    for (const RobotStep& robot : self->robots) *numbers++ = static_cast<Number>(value(robot));
    return array;
  };
}

py::dict tour_of(const RobotStep& robot) {
  std::vector<planner::Pose> poses;
  py::array_t<std::int64_t> clusters(static_cast<py::ssize_t>(robot.tour.size())), frontiers(clusters.size());
  for (std::size_t i = 0; i < robot.tour.size(); ++i) {
    poses.push_back(robot.tour[i].pose);
    clusters.mutable_data()[i] = static_cast<std::int64_t>(robot.tour[i].clusters);
    frontiers.mutable_data()[i] = static_cast<std::int64_t>(robot.tour[i].frontiers);
  }
  py::dict tour;
  tour["pose"] = to_array(poses);
  tour["clusters"] = clusters;
  tour["frontiers"] = frontiers;
  return tour;
}

py::array_t<double> goals(const Self& self) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<planner::Pose> poses;
  for (const RobotStep& robot : self->robots)
    poses.push_back(robot.goal.pose.value_or(planner::Pose{{kNan, kNan, kNan}, kNan}));
  return to_array(poses);
}

}  // namespace

void bind_exploration_step(py::module_& module) {
  py::class_<ExplorationStep, Self>(module, "Step",
                                    R"(What a team of r robots planned, did and mapped between two moments.

Poses are x, y, z [m] and yaw [rad] of sensors, in the map's frame.)")
      .def("__repr__",
           [](const Self& self) {
             return py::str("<frontlux.planner.Step {}: {:.2f} s, {} frontiers>")
                 .format(self->number, self->time, self->frontiers);
           })
      .def_property_readonly(
          "number", [](const Self& self) { return self->number; }, "From 0, the start.")
      .def_property_readonly(
          "time", [](const Self& self) { return self->time; }, "[s] of the clock at its end.")
      .def_property_readonly(
          "frontiers", [](const Self& self) { return self->frontiers; }, "In the map when it was planned.")
      .def_property_readonly(
          "unassigned", [](const Self& self) { return self->unassigned; }, "Frontiers that are no robot's.")
      .def_property_readonly(
          "abandoned", [](const Self& self) { return self->abandoned; },
          "Frontiers no longer tried, since they stay unknown when looked at.")
      .def_property_readonly(
          "rays", [](const Self& self) { return self->rays; }, "Cast to plan it.")
      .def_property_readonly("goals", &goals, "float64 (r, 4): the robots' goals; NaN where there is none.")
      .def_property_readonly(
          "goal_states",
          [](const Self& self) {
            std::vector<std::string> states;
            for (const RobotStep& robot : self->robots) states.emplace_back(name_of(robot.goal.state));
            return states;
          },
          "r words: 'assigned', 'received' or 'uncovered', whose frontiers the goal is for; 'no_corridor', "
          "'no_frontiers', 'nothing_assigned' or 'nothing_visible', why there is none.")
      .def_property_readonly(
          "goal_reasons",
          [](const Self& self) {
            std::vector<std::string> reasons;
            for (const RobotStep& robot : self->robots) reasons.push_back(robot.goal.reason);
            return reasons;
          },
          "r sentences: the same in words, as 'no goal: the map has no frontiers'.")
      .def_property_readonly("goal_gains",
                             of_robots<double>([](const RobotStep& robot) { return robot.goal.gain; }),
                             "float64 (r,): frontiers that the goals are expected to see.")
      .def_property_readonly(
          "poses",
          [](const Self& self) {
            std::vector<py::array_t<double>> poses;
            for (const RobotStep& robot : self->robots) poses.push_back(to_array(robot.planned));
            return poses;
          },
          "r arrays, float64 (n, 4): in motion where each robot took scans, after the last one of the step "
          "before; in lock-step the viewpoints planned for it.")
      .def_property_readonly(
          "tours",
          [](const Self& self) {
            std::vector<py::dict> tours;
            for (const RobotStep& robot : self->robots) tours.push_back(tour_of(robot));
            return tours;
          },
          "r dicts: where each robot that chose its goal means to look from, in order: pose, float64 (n, 4); "
          "clusters "
          "and frontiers, int64 (n,), that it sees from there.")
      .def_property_readonly("travelled",
                             of_robots<std::int64_t>([](const RobotStep& robot) { return robot.travelled; }),
                             "int64 (r,): how many of `poses` each robot reached.")
      .def_property_readonly("lengths",
                             of_robots<double>([](const RobotStep& robot) { return robot.length; }),
                             "float64 (r,): [m] that each robot travelled.")
      .def_property_readonly("gained",
                             of_robots<std::int64_t>([](const RobotStep& robot) { return robot.gained; }),
                             "int64 (r,): frontiers of the step's beginning that each robot's scans mapped.")
      .def_property_readonly(
          "seconds",
          [](const Self& self) {
            py::dict seconds;
            for (std::size_t i = 0; i < planner::kPhases; ++i)
              seconds[py::str(std::string(name_of(static_cast<planner::Phase>(i))))] = self->seconds[i];
            return seconds;
          },
          "A dict of what it took on this machine [s]: frontiers, caster, goals, paths, optimization, "
          "moving.");
}

}  // namespace frontlux::python
