#include <frontlux/lattice.hpp>
#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/robot.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace frontlux::planner {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

Robot ugv() { return {"ugv", ugv_travel(), {FieldOfView::Shape::kSpinning, 0.0, 40.0 * kDegree, 6.0}, {}}; }

Robot uav(Method method) {
  return {"uav",
          method == Method::kPaper ? uav_node_travel() : uav_travel(),
          {FieldOfView::Shape::kPyramid, 90.0 * kDegree, 72.0 * kDegree, 10.0},
          {.speed = 1.5}};
}

Robot in_motion(Robot robot, double resolution) {
  constexpr double kMost = 0.05, kWhole = 0.001;  // [m]
  TravelOptions& travel = robot.travel;
  const BodyStencil stencil(travel, Lattice(resolution).resolution());
  double room = 4 * kMost;
  for (const std::size_t axis : {0U, 1U, 2U}) {
    if (axis == 2 && travel.drives()) continue;
    const double voxels = stencil.high()[axis] - stencil.low()[axis] + 1;
    room = std::min(room, voxels * resolution - travel.extents[static_cast<Eigen::Index>(axis)]);
  }
  travel.margin = std::max(0.0, std::floor(room / 4 / kWhole + 1e-6) * kWhole);
  if (travel.motion == Motion::kSpace) travel.min_height = travel.extents.z() / 2;
  return robot;
}

RobotDescription ugv_description() { return {ugv(), 720, 32, 10.0}; }

RobotDescription uav_description(Method method) { return {uav(method), 160, 120, 15.0}; }

}  // namespace frontlux::planner
