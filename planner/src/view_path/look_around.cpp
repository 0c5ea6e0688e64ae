#include <frontlux/planner/look_around.hpp>

#include <cmath>
#include <numbers>

namespace frontlux::planner {

std::vector<Pose> look_around(const FieldOfView& view, const Pose& sensor_pose) {
  view.check();
  if (view.sees_all_around()) return {sensor_pose};
  constexpr double kRounding = 1e-9;
  const double count = std::ceil(2 * std::numbers::pi / view.horizontal - kRounding);
  std::vector<Pose> poses;
  for (double i = 0; i < count; ++i)
    poses.push_back({sensor_pose.position, sensor_pose.yaw + i * (2 * std::numbers::pi / count)});
  return poses;
}

}  // namespace frontlux::planner
