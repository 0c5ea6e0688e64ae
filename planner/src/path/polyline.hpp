#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace frontlux::planner::detail {

/// A path of straight segments: its ends and bends [m].
using Polyline = std::vector<Eigen::Vector3d>;

/// Whether a robot can go straight from one point [m] to another.
using SegmentCheck = std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

[[nodiscard]] double length_of(const Polyline& path);  ///< [m]

/// The same path with more points on it, so that they are at most `spacing` [m] apart, evenly on each
/// segment. Rounding does not count: a segment of 1.2 m is not divided because it comes out a little longer.
/// The points of the path stay as they are.
[[nodiscard]] Polyline divided(const Polyline& path, double spacing);

/// A shorter path between the same ends. Each round cuts bends as far as one can go straight, from points at
/// most `step` [m] apart, until a round gains less than a thousandth.
[[nodiscard]] Polyline shortened(Polyline path, double step, int rounds, const SegmentCheck& is_free);

}  // namespace frontlux::planner::detail
