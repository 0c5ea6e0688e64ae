#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace frontlux::planner::detail {

/// A way of straight parts: its ends and bends [m].
using Polyline = std::vector<Eigen::Vector3d>;

[[nodiscard]] double length_of(const Polyline& way);  ///< [m]

/// The same way with so many more points on it that they are at most `spacing` [m] apart, evenly on each
/// straight part. Rounding does not count: a part of 1.2 m is not divided because it comes out a little
/// longer. The points that were there stay as they were.
[[nodiscard]] Polyline divided(const Polyline& way, double spacing);

/// A shorter way between the same ends: bends are cut as far as one can go straight, from points at most
/// `step` [m] apart, until a round gains less than a thousandth.
/// @param is_free  whether one can go straight from one point to another
[[nodiscard]] Polyline shortened(
    Polyline way, double step, int rounds,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& is_free);

}  // namespace frontlux::planner::detail
