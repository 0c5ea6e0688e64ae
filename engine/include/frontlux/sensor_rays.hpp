#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/ray.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <span>
#include <vector>

namespace frontlux {

/// Unit vectors that fill a field of view, in the sensor's frame: x forward, y left, z up. There are
/// `rows` x `columns` of them, row by row from the top: that of row r and column c is at r * columns + c.
/// - spinning: rows are beams, elevations evenly spaced with both extremes included (one row: elevation 0);
///   columns are azimuths 2 pi c / columns, counter-clockwise, from straight ahead;
/// - pyramid: pixels of equal size on the image plane, rays through their centres, columns from the left;
/// - cone: rows * columns rays in a spiral from the axis outwards, each for the same solid angle.
/// @throws std::invalid_argument naming the value, if the field of view does not pass its `check`, or there
///         are no rays or more than 2^26
[[nodiscard]] FRONTLUX_EXPORT std::vector<Eigen::Vector3d> sensor_directions(const FieldOfView& view,
                                                                             std::size_t columns,
                                                                             std::size_t rows);

/// Unit vectors through the pixels of a calibrated camera, in the camera's optical frame: x right, y down,
/// z forward. There are `rows` x `columns` of them, row by row from the top; that of row r and column c is at
/// r * columns + c and goes through the pixel's centre, (c + 0.5, r + 0.5).
/// @param intrinsics  (fx 0 cx, 0 fy cy, 0 0 1) [pixels]; other entries only have to be finite
/// @throws std::invalid_argument naming the value, if an entry is not finite, fx or fy is not positive, or
///         there are no rays or more than 2^26
[[nodiscard]] FRONTLUX_EXPORT std::vector<Eigen::Vector3d> pinhole_directions(
    const Eigen::Matrix3d& intrinsics, std::size_t columns, std::size_t rows);

/// Rays in the map's frame for `RayCaster::cast`: `rays[i]` goes along `directions[i]`.
/// @param T_map_sensor  the pose of the sensor, with the frame of the directions
/// @param max_range     [m] of each ray; <= 0: no limit
[[nodiscard]] FRONTLUX_EXPORT std::vector<Ray> rays_from(const Eigen::Isometry3d& T_map_sensor,
                                                         std::span<const Eigen::Vector3d> directions,
                                                         double max_range = -1.0);

}  // namespace frontlux
