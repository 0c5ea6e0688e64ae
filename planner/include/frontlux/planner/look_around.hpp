#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/pose.hpp>

#include <vector>

namespace frontlux::planner {

/// Poses of a sensor at one place that together see all azimuths: one if it spins, else as many as its
/// opening angle needs, evenly turned. The first is the given one.
/// @throws std::invalid_argument naming the value of the field of view that is out of bounds
[[nodiscard]] FRONTLUX_EXPORT std::vector<Pose> look_around(const FieldOfView& view, const Pose& sensor_pose);

}  // namespace frontlux::planner
