#include "poses.hpp"

#include <cmath>
#include <string>

namespace frontlux::python {
namespace {

using planner::Pose;

void write(const Pose& pose, double* numbers) {
  Eigen::Map<Eigen::Vector4d>(numbers) << pose.position, pose.yaw;
}

}  // namespace

SensorPose sensor_pose(const char* name, const py::object& object, const Lattice& lattice) {
  const Numbers numbers(name, object, 4);
  SensorPose pose;
  if (numbers.shape() == Shape{4}) {
    pose.T_map_sensor = pose_of(numbers);
    pose.upright = {pose.T_map_sensor.translation(), planner::yaw_along(pose.T_map_sensor.linear().col(0))};
  } else if (numbers.shape().empty()) {
    pose.upright = {{numbers.number(0, 0), numbers.number(0, 1), numbers.number(0, 2)}, numbers.number(0, 3)};
    pose.T_map_sensor = Eigen::Translation3d(pose.upright.position) *
                        Eigen::AngleAxisd(pose.upright.yaw, Eigen::Vector3d::UnitZ());
  } else {
    throw py::value_error(std::string(name) + ": shape " + text_of(with(numbers.shape(), 4)) +
                          ", but has to be (4,), x, y, z and yaw, or (4, 4)");
  }
  if (!std::isfinite(pose.upright.yaw) || !lattice.key(pose.upright.position))
    throw py::value_error(std::string(name) + ": not finite, or outside the key range");
  return pose;
}

py::array_t<double> to_array(std::span<const Pose> poses) {
  py::array_t<double> array(Shape{static_cast<py::ssize_t>(poses.size()), 4});
  double* numbers = array.mutable_data();
  for (std::size_t i = 0; i < poses.size(); ++i) write(poses[i], numbers + 4 * i);
  return array;
}

py::array_t<double> to_array(const Pose& pose) {
  py::array_t<double> array(4);
  write(pose, array.mutable_data());
  return array;
}

}  // namespace frontlux::python
