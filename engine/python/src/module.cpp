#include "bindings.hpp"

#include <frontlux/machine.hpp>

PYBIND11_MODULE(_engine, module) {
  using namespace frontlux::python;
  module.attr("__name__") = "frontlux";  // what names and messages show
  module.def(
      "instruction_set", &frontlux::instruction_set_name,
      "The vector instructions in use: 'avx512', 'avx2', 'vector' or 'none'; FRONTLUX_ISA asks for others.");
  bind_voxel_grid(module);
  bind_ray_caster(module);
  bind_live_map(module);
  bind_sensor_rays(module);
  bind_frontier_set(module);
  bind_view_quality(module);
  module.attr("__name__") = "frontlux._engine";
}
