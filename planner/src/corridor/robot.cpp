#include <frontlux/planner/robot.hpp>

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

RobotDescription ugv_description() { return {ugv(), 720, 32, 10.0}; }

RobotDescription uav_description(Method method) { return {uav(method), 160, 120, 15.0}; }

}  // namespace frontlux::planner
