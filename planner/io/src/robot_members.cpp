#include "robot_members.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/robot_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace frontlux::io {
namespace {

using nlohmann::json, nlohmann::ordered_json;
using planner::BodyShape, planner::Motion, planner::MotionLimits, planner::RobotDescription,
    planner::TravelOptions;
using Shape = FieldOfView::Shape;

constexpr Range kHeights{0.0, 100.0}, kMargins{0.0, 100.0}, kSensorRanges{0.01, 1000.0}, kAngles{0.1, 179.0};
constexpr Range kSpeeds{0.001, 1000.0}, kYawRates{0.1, 36000.0}, kRates{0.01, 10000.0};
constexpr Range kSteps{0.001, 10.0}, kSlopes{0.0, 80.0};
constexpr double kCameraRate = 15.0;  // [1/s]; that of others is RobotDescription's

const std::string kSeeRobots = "an object, see docs/robots.md";

std::string name_of_robot(Members& members) {
  const std::string wanted = "1 to " + std::to_string(kLongestRobotName) + " letters, digits, - and _";
  std::string name = members.text("name", wanted);
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || name.size() > kLongestRobotName || !std::ranges::all_of(name, fits))
    members.refuse("name", "is " + quote(name), "give " + wanted);
  return name;
}

void check_rays(const Members& members, const RobotDescription& robot) {
  constexpr double kRayBytes = 110.0, kGigabyte = 1e9;  // measured: rays, hits and ranges of a scan
  const double columns = static_cast<double>(robot.columns), rows = static_cast<double>(robot.rows),
               rays = columns * rows;
  const std::string sensor =
      "columns and rows are " + decimals_of(columns) + " and " + decimals_of(rows) + ": ";
  if (rays > static_cast<double>(kMostRays))
    members.refuse(sensor + "a scan would take about " +
                   decimals_of(std::ceil(rays * kRayBytes / kGigabyte)) + " GB of memory; give at most " +
                   std::to_string(kMostRays) + " rays in all");
  if (rays * robot.rate > static_cast<double>(kMostRaysPerSecond))
    members.refuse(sensor + "with a rate_hz of " + decimals_of(robot.rate) + " they are " +
                   decimals_of(std::round(rays * robot.rate)) + " rays a second; give at most " +
                   std::to_string(kMostRaysPerSecond) + " in all");
}

void read_sensor(Members members, RobotDescription& robot) {
  FieldOfView& view = robot.robot.view;
  const std::string kinds = "\"spinning\", \"camera\" or \"cone\"";
  const std::string kind = members.text("kind", kinds);
  if (kind == "spinning") {
    members.not_here({"horizontal_deg"}, "is not for a spinning sensor, which sees all around");
    view.shape = Shape::kSpinning;
  } else if (kind == "camera") {
    view.shape = Shape::kPyramid;
  } else if (kind == "cone") {
    members.not_here({"vertical_deg"}, "is not for a cone, which is as high as it is wide");
    view.shape = Shape::kCone;
  } else {
    members.refuse("kind", "is " + quote(kind), "give " + kinds);
  }
  if (view.shape != Shape::kSpinning)
    view.horizontal = members.number("horizontal_deg", "degrees", kAngles) * kDegree;
  if (view.shape != Shape::kCone)
    view.vertical = members.number("vertical_deg", "degrees", kAngles) * kDegree;
  view.max_range = members.number("range_m", "m", kSensorRanges);
  robot.columns = members.whole("columns", 1, kMostRays);
  robot.rows = members.whole("rows", 1, kMostRays);
  robot.rate = members.number("rate_hz", "scans a second", kRates,
                              view.shape == Shape::kPyramid ? kCameraRate : robot.rate);
  check_rays(members, robot);
  members.expect_no_more();
}

void read_limits(Members members, MotionLimits& limits) {
  limits.speed = members.number("speed_m_s", "m/s", kSpeeds, limits.speed);
  limits.acceleration = members.number("acceleration_m_s2", "m/s2", kSpeeds, limits.acceleration);
  if (const json* rate = members.find("yaw_rate_deg_s"))
    limits.yaw_rate = members.number("yaw_rate_deg_s", *rate, "degrees/s", kYawRates) * kDegree;
  limits.per_axis = members.flag("per_axis", limits.per_axis);
  members.expect_no_more();
}

Eigen::Vector3d read_edges(Members& members, const std::string& name) {
  const std::string three = "three numbers in metres, along x, y and z";
  const auto edges = members.numbers(name, members.get(name, three), 3, three, "m", kLengths);
  return {edges[0], edges[1], edges[2]};
}

void read_body(Members& members, RobotForm form, TravelOptions& travel) {
  if (form == RobotForm::kFile && members.find("body") == nullptr) {
    travel.extents = read_edges(members, "box_m");
    return;
  }
  members.not_here({"box_m"},
                   form == RobotForm::kFile
                       ? "is given beside body"
                       : R"(is for a robot file; in a task the body is {"kind": "box", "size_m": ...})");
  Members body = members.object("body", R"({"kind": "box", "size_m": [x, y, z]})");
  const std::string kinds = R"("box", "cylinder" or "sphere")";
  const std::string kind = body.text("kind", kinds);
  const auto shape = planner::body_shape_named(kind);
  if (!shape) body.refuse("kind", "is " + quote(kind), "give " + kinds);
  travel.shape = *shape;
  if (*shape == BodyShape::kBox) {
    travel.extents = read_edges(body, "size_m");
  } else {
    travel.extents.setConstant(body.number("diameter_m", "m", kLengths));
    if (*shape == BodyShape::kCylinder) travel.extents.z() = body.number("height_m", "m", kLengths);
  }
  body.expect_no_more();
}

void read_travel(Members& members, RobotForm form, TravelOptions& travel) {
  const std::string motions = R"("plane", "ground" or "space")";
  const std::string motion = members.text("motion", motions);
  const auto known = planner::motion_named(motion);
  if (!known) members.refuse("motion", "is " + quote(motion), "give " + motions);
  travel.motion = *known;
  read_body(members, form, travel);
  travel.margin = members.number("margin_m", "m", kMargins, travel.margin);
  if (travel.motion != Motion::kPlane)
    members.not_here({"require_ground"}, "is for a robot with the motion \"plane\"");
  if (travel.motion != Motion::kGround)
    members.not_here({"step_m", "slope_deg"}, "is for a robot with the motion \"ground\"");
  if (travel.drives()) {
    members.not_here({"min_height_m", "node_edge_m"}, "is for a robot with the motion \"space\"");
    travel.sensor_height = members.number("mount_height_m", "m", kHeights);
    if (travel.motion == Motion::kPlane)
      travel.require_ground = members.flag("require_ground", travel.require_ground);
    if (travel.motion == Motion::kGround) {
      travel.step = members.number("step_m", "m", kSteps, travel.step);
      travel.slope = members.number("slope_deg", "degrees", kSlopes, degrees_of(travel.slope)) * kDegree;
    }
    if (const json* ground = members.find("ground_m")) {
      const auto edges =
          members.numbers("ground_m", *ground, 2, "two numbers in metres, along x and y", "m", kLengths);
      travel.ground_extents = Eigen::Vector2d(edges[0], edges[1]);
    }
  } else {
    members.not_here({"mount_height_m", "ground_m"}, R"(is for a robot with the motion "plane" or "ground")");
    travel.min_height = members.number("min_height_m", "m", kHeights, travel.extents.z() / 2);
    if (members.find("node_edge_m") != nullptr)
      travel.node_edge = members.number("node_edge_m", "m", {travel.extents.maxCoeff(), kLengths.high});
  }
}

ordered_json json_of_body(const TravelOptions& travel) {
  const Eigen::Vector3d& size = travel.extents;
  ordered_json object;
  object["kind"] = planner::name_of(travel.shape);
  if (travel.shape == BodyShape::kBox)
    object["size_m"] = {size.x(), size.y(), size.z()};
  else
    object["diameter_m"] = size.x();
  if (travel.shape == BodyShape::kCylinder) object["height_m"] = size.z();
  return object;
}

ordered_json json_of_sensor(const RobotDescription& robot) {
  const FieldOfView& view = robot.robot.view;
  ordered_json object;
  object["kind"] = view.shape == Shape::kSpinning ? "spinning"
                   : view.shape == Shape::kCone   ? "cone"
                                                  : "camera";
  if (view.shape != Shape::kSpinning) object["horizontal_deg"] = degrees_of(view.horizontal);
  if (view.shape != Shape::kCone) object["vertical_deg"] = degrees_of(view.vertical);
  object["range_m"] = view.max_range;
  object["columns"] = robot.columns;
  object["rows"] = robot.rows;
  object["rate_hz"] = robot.rate;
  return object;
}

}  // namespace

RobotDescription read_robot_members(Members& members, RobotForm form) {
  RobotDescription robot;
  robot.robot.name = name_of_robot(members);
  read_travel(members, form, robot.robot.travel);
  if (const json* limits = members.find("limits"))
    read_limits(members.object("limits", *limits, kSeeRobots), robot.robot.limits);
  read_sensor(members.object("sensor", kSeeRobots), robot);
  return robot;
}

ordered_json json_of(const RobotDescription& robot) {
  const TravelOptions& travel = robot.robot.travel;
  ordered_json object;
  object["name"] = robot.robot.name;
  object["motion"] = planner::name_of(travel.motion);
  object["body"] = json_of_body(travel);
  object["margin_m"] = travel.margin;
  if (travel.drives()) {
    object["mount_height_m"] = travel.sensor_height;
    if (travel.motion == Motion::kPlane) object["require_ground"] = travel.require_ground;
    if (travel.motion == Motion::kGround) {
      object["step_m"] = travel.step;
      object["slope_deg"] = degrees_of(travel.slope);
    }
    if (travel.ground_extents) object["ground_m"] = {travel.ground_extents->x(), travel.ground_extents->y()};
  } else {
    object["min_height_m"] = travel.min_height;
    if (travel.node_edge > 0.0) object["node_edge_m"] = travel.node_edge;
  }
  const MotionLimits& limits = robot.robot.limits;
  object["limits"] = {{"speed_m_s", limits.speed},
                      {"acceleration_m_s2", limits.acceleration},
                      {"yaw_rate_deg_s", degrees_of(limits.yaw_rate)},
                      {"per_axis", limits.per_axis}};
  object["sensor"] = json_of_sensor(robot);
  return object;
}

}  // namespace frontlux::io
