#include "bindings.hpp"

PYBIND11_MODULE(_planner, module) {
  using namespace frontlux::python;
  py::module_::import("frontlux");               // its grids, changes and fields of view are ours, too
  module.attr("__name__") = "frontlux.planner";  // what names and messages show
  Computing::end_before_the_process();
  bind_robot(module);
  bind_trajectory(module);
  bind_exploration_step(module);
  bind_continuous_exploration(module);
  bind_exploration(module);
  module.attr("__name__") = "frontlux.planner._planner";
}
