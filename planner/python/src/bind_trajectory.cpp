#include "bindings.hpp"
#include "motion_arrays.hpp"

namespace frontlux::python {

void bind_trajectory(py::module_& module) {
  using planner::Trajectory;
  using Self = std::shared_ptr<Trajectory>;
  py::class_<Trajectory, Self>(
      module, "Trajectory",
      R"(A robot's position and yaw over time: along lines, and arcs in the place of corners, until it rests.

Speed, acceleration and yaw rate are within the robot's limits at every moment. Times are in seconds on the clock of
whoever explores.)")
      .def_property_readonly(
          "begin", [](const Self& self) { return self->begin(); }, "[s] Before it the robot rests.")
      .def_property_readonly(
          "end", [](const Self& self) { return self->end(); }, "[s] From here on the robot rests.")
      .def_property_readonly(
          "length", [](const Self& self) { return self->length(); }, "[m] From begin to end.")
      .def(
          "at",
          [](const Self& self, const py::object& times) {
            return motion_arrays(
                times, [&](const auto& fill) { fill([&](double time) { return self->at(time); }); });
          },
          py::arg("times"),
          R"(Where the robot is at some times, and how it moves.

times: [s] a number, or float32 or float64 (...). Returns a dict of arrays:
  pose      float64 (..., 4)  x, y, z [m] and yaw [rad] of its sensor, in the map's frame; yaw is not wrapped
  velocity  float64 (..., 3)  [m/s]
  yaw_rate  float64 (...)     [rad/s])");
}

}  // namespace frontlux::python
