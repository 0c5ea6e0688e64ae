#pragma once

#include <frontlux/python/objects.hpp>

namespace frontlux::python {

void bind_voxel_grid(py::module_& module);
void bind_ray_caster(py::module_& module);
void bind_live_map(py::module_& module);
void bind_sensor_rays(py::module_& module);
void bind_frontier_set(py::module_& module);
void bind_view_quality(py::module_& module);

}  // namespace frontlux::python
