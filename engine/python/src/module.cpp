#include "bindings.hpp"

#include <frontlux/machine.hpp>

#include <string>

#if PYBIND11_VERSION_HEX < 0x020C0000
namespace {

// pybind11 looks for the fields of numpy's arrays where numpy 1 has them.
void expect_numpy_1() {
  const auto version = pybind11::module_::import("numpy").attr("__version__").cast<std::string>();
  if (std::stoi(version) > 1)
    throw pybind11::import_error("numpy " + version +
                                 ", but this frontlux was built with a pybind11 older than 2.12, which needs "
                                 "numpy < 2: install that, or build frontlux with a newer pybind11");
}

}  // namespace
#endif

PYBIND11_MODULE(_engine, module) {
  using namespace frontlux::python;
#if PYBIND11_VERSION_HEX < 0x020C0000
  expect_numpy_1();
#endif
  module.attr("__name__") = "frontlux";  // what names and messages show
  Computing::end_before_the_process();
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
  module.attr("__version__") = FRONTLUX_VERSION;
}
