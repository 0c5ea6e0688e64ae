#include <frontlux/planner/travel_corridor.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace frontlux::planner {
namespace {

constexpr std::array<std::string_view, 3> kMotions = {"plane", "space", "ground"};
constexpr std::array<std::string_view, 3> kShapes = {"box", "cylinder", "sphere"};

template <class Value>
std::optional<Value> value_named(const std::array<std::string_view, 3>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Value>(found - names.begin());
}

}  // namespace

std::string_view name_of(Motion motion) { return kMotions.at(static_cast<std::size_t>(motion)); }

std::string_view name_of(BodyShape shape) { return kShapes.at(static_cast<std::size_t>(shape)); }

std::optional<BodyShape> body_shape_named(std::string_view name) {
  return value_named<BodyShape>(kShapes, name);
}

std::optional<Motion> motion_named(std::string_view name) { return value_named<Motion>(kMotions, name); }

TravelOptions ugv_travel() {
  TravelOptions options;
  options.motion = Motion::kPlane;
  options.extents = {1.0, 1.0, 0.7};
  // Where the wheels are. Some beam always grazes a floor voxel under the rest of the box.
  options.ground_extents = Eigen::Vector2d(0.9, 0.9);
  return options;
}

TravelOptions uav_travel() {
  TravelOptions options;
  options.extents = {0.8, 0.8, 0.8};
  return options;
}

TravelOptions uav_node_travel() {
  TravelOptions options = uav_travel();
  options.node_edge = 1.2;
  return options;
}

Eigen::AlignedBox3d body_of(const TravelOptions& travel) {
  const Eigen::Vector3d half = travel.extents / 2;
  if (travel.motion == Motion::kSpace) return {-half, half};
  const double bottom = -travel.sensor_height;
  return {Eigen::Vector3d(-half.x(), -half.y(), bottom + travel.ground_intrusion()),
          Eigen::Vector3d(half.x(), half.y(), bottom + travel.extents.z())};
}

std::optional<int> axis_unlike_x(const TravelOptions& travel) {
  int checked = 0;  // the last axis that has to be like x
  switch (travel.shape) {
    case BodyShape::kBox:
      break;
    case BodyShape::kCylinder:
      checked = 1;
      break;
    case BodyShape::kSphere:
      checked = 2;
      break;
  }
  for (int axis = 1; axis <= checked; ++axis)
    if (travel.extents[axis] != travel.extents.x()) return axis;
  return std::nullopt;
}

}  // namespace frontlux::planner
