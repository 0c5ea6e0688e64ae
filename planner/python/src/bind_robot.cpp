#include "bindings.hpp"

#include <frontlux/io/robot_file.hpp>
#include <frontlux/python/arrays.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

namespace frontlux::python {
namespace {

using planner::BodyShape, planner::Motion, planner::RobotDescription, planner::TravelOptions;

constexpr double kDegree = std::numbers::pi / 180.0;

using Self = std::shared_ptr<RobotDescription>;
using View = std::shared_ptr<FieldOfView>;

// The bounds are those of robots' files, which docs/robots.md names, but for yaw rates and angles of view;
// rays a second have none.
double within(const char* name, double value, double low, double high, const char* unit) {
  if (!(value >= low && value <= high))
    throw py::value_error(std::string(name) + ": " + py::str(py::float_(value)).cast<std::string>() +
                          ", but has to be " + py::str(py::float_(low)).cast<std::string>() + " to " +
                          py::str(py::float_(high)).cast<std::string>() + " " + unit);
  return value;
}

template <int kSize>
Eigen::Matrix<double, kSize, 1> edges_of(const char* name, const py::object& object) {
  const Numbers numbers(name, object, kSize);
  if (!numbers.shape().empty())
    throw py::value_error(std::string(name) + ": has to be of shape (" + std::to_string(kSize) + ",)");
  Eigen::Matrix<double, kSize, 1> edges;
  for (std::size_t i = 0; i < kSize; ++i)
    edges[static_cast<Eigen::Index>(i)] =
        within(name, numbers.number(0, i), 0.01, 100.0, "m along each axis");
  return edges;
}

// As robots' files have them: of a cylinder a diameter and a height, of a sphere a diameter.
void set_body(TravelOptions& travel, const std::string& body, const Eigen::Vector3d& box) {
  const auto shape = planner::body_shape_named(body);
  if (!shape) throw py::value_error("body: '" + body + "', but has to be 'box', 'cylinder' or 'sphere'");
  travel.shape = *shape;
  travel.extents = box;
  if (planner::axis_unlike_x(travel))
    throw py::value_error("box: (" + std::to_string(box.x()) + ", " + std::to_string(box.y()) + ", " +
                          std::to_string(box.z()) + "), but of a " + body +
                          (*shape == BodyShape::kSphere ? " x, y and z" : " x and y") +
                          " have to be equal, its diameter");
}

Self make(const std::string& name, const std::string& motion, const py::object& box, const View& view,
          std::size_t columns, std::size_t rows, double rate, double margin, double sensor_height,
          bool require_ground, const py::object& ground, double step, double slope,
          std::optional<double> min_height, double speed, double acceleration, double yaw_rate, bool per_axis,
          const std::string& body, std::optional<double> node_edge) {
  if (name.empty() || name.size() > io::kLongestRobotName)
    throw py::value_error("name: has to have 1 to " + std::to_string(io::kLongestRobotName) +
                          " bytes in UTF-8");
  const auto known = planner::motion_named(motion);
  if (!known) throw py::value_error("motion: '" + motion + "', but has to be 'plane', 'ground' or 'space'");
  RobotDescription robot;
  robot.robot.name = name;
  TravelOptions& travel = robot.robot.travel;
  travel.motion = *known;
  set_body(travel, body, edges_of<3>("box", box));
  travel.margin = within("margin", margin, 0.0, 100.0, "m");
  travel.sensor_height = within("sensor_height", sensor_height, 0.0, 100.0, "m");
  travel.require_ground = require_ground;
  if (!ground.is_none()) {
    if (!travel.drives()) throw py::value_error("ground: a robot in space stands on none");
    travel.ground_extents = edges_of<2>("ground", ground);
  }
  travel.step = within("step", step, 0.001, 10.0, "m");
  travel.slope = within("slope", slope, 0.0, 80.0 * kDegree, "rad");
  if (min_height && travel.drives())
    throw py::value_error("min_height: only a robot in space keeps a height, but its motion is '" + motion +
                          "'");
  travel.min_height = within("min_height", min_height.value_or(travel.extents.z() / 2), 0.0, 100.0, "m");
  if (node_edge) {
    if (travel.drives()) throw py::value_error("node_edge: only a robot in space moves through nodes");
    travel.node_edge = within("node_edge", *node_edge, travel.extents.maxCoeff(), 100.0, "m");
  }
  robot.robot.view = *view;
  within("view.max_range", view->max_range, 0.01, 1000.0, "m");
  if (columns < 1 || rows < 1 || columns > io::kMostRays || rows > io::kMostRays / columns)
    throw py::value_error("columns, rows: " + std::to_string(columns) + " x " + std::to_string(rows) +
                          " rays, but there have to be 1 to " + std::to_string(io::kMostRays));
  robot.columns = columns;
  robot.rows = rows;
  robot.rate = within("rate", rate, 0.01, 10000.0, "scans a second");
  robot.robot.limits = {within("speed", speed, 0.001, 1000.0, "m/s"),
                        within("acceleration", acceleration, 0.001, 1000.0, "m/s^2"),
                        within("yaw_rate", yaw_rate, 0.0001, 1000.0, "rad/s"), per_axis};
  robot.robot.check();
  return std::make_shared<RobotDescription>(robot);
}

// What means nothing to a robot is None.
template <class Value>
std::optional<Value> only_if(bool condition, Value value) {
  return condition ? std::optional(value) : std::nullopt;
}

}  // namespace

void bind_robot(py::module_& module) {
  py::class_<RobotDescription, Self>(
      module, "Robot",
      R"(A robot: its body, its sensor and its limits. Its pose is that of its sensor: in space the middle of its body.

docs/robots.md says more of each value.)")
      .def(py::init(&make), py::arg("name"), py::arg("motion"), py::arg("box"), py::arg("view"),
           py::arg("columns"), py::arg("rows"), py::arg("rate") = 10.0, py::arg("margin") = 0.0,
           py::arg("sensor_height") = 0.75, py::arg("require_ground") = true, py::arg("ground") = py::none(),
           py::arg("step") = 0.15, py::arg("slope") = 20.0 * kDegree, py::arg("min_height") = py::none(),
           py::arg("speed") = 1.0, py::arg("acceleration") = 2.0, py::arg("yaw_rate") = std::numbers::pi / 3,
           py::arg("per_axis") = false, py::arg("body") = "box", py::arg("node_edge") = py::none(),
           R"(A robot of these values.

name: in messages, 1 to 40 bytes in UTF-8. motion: 'plane', on the floor that it starts on, 'ground', up and down slopes and steps as well, or 'space'.
box: (3,) [m] the box around its body along x, y and z, whatever its yaw. body: 'box', 'cylinder', upright, whose x and y are equal,
or 'sphere', whose edges all are. view: FieldOfView of its sensor. columns, rows: rays of a scan. rate: [1/s] of scans in motion.
margin: [m] kept free around the body; of a robot that drives to its sides.
On a plane and on the ground: sensor_height: [m] above the floor; ground: (2,) [m] along x and y, the area of the floor that
must not be missing; None: all under the box. On a plane: require_ground: it goes only where floor is known. On the ground:
step: [m] the highest, at least a voxel; slope: [rad] the steepest.
In space: min_height: [m] of its middle above the bottom of the bounds; None: half of its height. node_edge: [m] it moves through
free octree nodes of this size, as in the paper, at least as wide as its body; None, and on tours: wherever the body fits.
speed [m/s], acceleration [m/s^2], yaw_rate [rad/s]: at most; per_axis: speed and acceleration along x, y and z each.
Raises ValueError naming the value that is out of bounds.)")
      .def_static(
          "read",
          [](const std::filesystem::path& file) {
            const OthersRun others_run;
            return std::make_shared<RobotDescription>(io::read_robot(file));
          },
          py::arg("file"),
          "A robot of a JSON file. Raises RuntimeError naming the file and the value that is wrong.")
      .def(
          "in_motion",
          [](const Self& self, double resolution) {
            RobotDescription robot = *self;
            robot.robot = planner::in_motion(std::move(robot.robot), resolution);
            return std::make_shared<RobotDescription>(std::move(robot));
          },
          py::arg("resolution"),
          "The same robot with the margin, and in space the least height, that `frontlux explore` gives its "
          "own "
          "in motion, in a map of this resolution [m]. Raises ValueError if its body does not go with it.")
      .def("__repr__",
           [](const Self& self) {
             const TravelOptions& travel = self->robot.travel;
             return py::str("<frontlux.planner.Robot {!r}: {}, {} of {:g} x {:g} x {:g} m>")
                 .format(self->robot.name, planner::name_of(travel.motion), planner::name_of(travel.shape),
                         travel.extents.x(), travel.extents.y(), travel.extents.z());
           })
      .def_property_readonly(
          "name", [](const Self& self) { return self->robot.name; }, "As in messages.")
      .def_property_readonly(
          "motion", [](const Self& self) { return planner::name_of(self->robot.travel.motion); },
          "'plane', 'ground' or 'space'.")
      .def_property_readonly(
          "box", [](const Self& self) { return py::array_t<double>(3, self->robot.travel.extents.data()); },
          "float64 (3,): [m] the box around its body along x, y and z.")
      .def_property_readonly(
          "body", [](const Self& self) { return planner::name_of(self->robot.travel.shape); },
          "Its shape: 'box', 'cylinder' or 'sphere'.")
      .def_property_readonly(
          "margin", [](const Self& self) { return self->robot.travel.margin; },
          "[m] kept free around the body; of a robot that drives to its sides.")
      .def_property_readonly(
          "sensor_height",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(travel.drives(), travel.sensor_height);
          },
          "[m] of its sensor above the floor; None in space.")
      .def_property_readonly(
          "require_ground",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(travel.motion == Motion::kPlane, travel.require_ground);
          },
          "Whether it goes only where floor is known; None unless its motion is 'plane'.")
      .def_property_readonly(
          "ground",
          [](const Self& self) -> py::object {
            const auto& ground = self->robot.travel.ground_extents;
            if (!ground || !self->robot.travel.drives()) return py::none();
            return py::array_t<double>(2, ground->data());
          },
          "float64 (2,): [m] along x and y, the area of the floor that must not be missing; None: all under "
          "the box, or in space.")
      .def_property_readonly(
          "step",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(travel.motion == Motion::kGround, travel.step);
          },
          "[m] The highest step; None unless its motion is 'ground'.")
      .def_property_readonly(
          "slope",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(travel.motion == Motion::kGround, travel.slope);
          },
          "[rad] The steepest slope; None unless its motion is 'ground'.")
      .def_property_readonly(
          "min_height",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(!travel.drives(), travel.min_height);
          },
          "[m] of its middle above the bottom of the bounds, at least; None unless its motion is 'space'.")
      .def_property_readonly(
          "node_edge",
          [](const Self& self) {
            const TravelOptions& travel = self->robot.travel;
            return only_if(travel.node_edge > 0.0, travel.node_edge);
          },
          "[m] of the octree's nodes through which it moves; None: it moves wherever its body fits.")
      .def_property_readonly(
          "view", [](const Self& self) { return std::make_shared<FieldOfView>(self->robot.view); },
          "What its sensor sees.")
      .def_property_readonly(
          "columns", [](const Self& self) { return self->columns; }, "Of a scan's rays.")
      .def_property_readonly(
          "rows", [](const Self& self) { return self->rows; }, "Of a scan's rays.")
      .def_property_readonly(
          "rate", [](const Self& self) { return self->rate; }, "[1/s] of scans in motion.")
      .def_property_readonly(
          "speed", [](const Self& self) { return self->robot.limits.speed; }, "[m/s] at most.")
      .def_property_readonly(
          "acceleration", [](const Self& self) { return self->robot.limits.acceleration; },
          "[m/s^2] at most.")
      .def_property_readonly(
          "yaw_rate", [](const Self& self) { return self->robot.limits.yaw_rate; }, "[rad/s] at most.")
      .def_property_readonly(
          "per_axis", [](const Self& self) { return self->robot.limits.per_axis; },
          "Whether speed and acceleration hold along x, y and z each.");
  module.def(
      "ugv", [] { return std::make_shared<RobotDescription>(planner::ugv_description()); },
      "The paper's ground robot: 1.0 x 1.0 x 0.7 m, 1 m/s, a lidar of 40 degrees that sees 6 m far, 32 x 720 "
      "rays, 10 "
      "scans a second.");
  module.def(
      "uav", [] { return std::make_shared<RobotDescription>(planner::uav_description()); },
      "The paper's aerial robot: a cube of 0.8 m, 1.5 m/s, a depth camera of 90 x 72 degrees that sees 10 m "
      "far, 160 x "
      "120 pixels, 15 scans a second.");
}

}  // namespace frontlux::python
