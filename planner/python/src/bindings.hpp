#pragma once

#include <frontlux/planner/exploration.hpp>
#include <frontlux/planner/robot.hpp>
#include <frontlux/planner/trajectory.hpp>
#include <frontlux/python/objects.hpp>

#include <cstddef>
#include <memory>
#include <string>

namespace frontlux::python {

/// A `PlannedMotion` whose parts last as long as Python wants them.
struct Plan {
  std::size_t robot;
  std::string reason;
  std::shared_ptr<planner::Trajectory> trajectory;
  std::shared_ptr<planner::ExplorationStep> step;
};

void bind_robot(py::module_& module);
void bind_trajectory(py::module_& module);
void bind_exploration_step(py::module_& module);
void bind_continuous_exploration(py::module_& module);
void bind_exploration(py::module_& module);

}  // namespace frontlux::python

template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::planner::RobotDescription>>
    : public SomeObject<frontlux::planner::RobotDescription> {};
template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::planner::Trajectory>>
    : public SomeObject<frontlux::planner::Trajectory> {};
template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::planner::ExplorationStep>>
    : public SomeObject<frontlux::planner::ExplorationStep> {};
template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::python::Plan>>
    : public SomeObject<frontlux::python::Plan> {};
