#include "bindings.hpp"

#include <frontlux/python/arrays.hpp>
#include <frontlux/sensor_rays.hpp>

#include <pybind11/stl.h>

#include <optional>
#include <string_view>

namespace frontlux::python {
namespace {

using View = std::shared_ptr<FieldOfView>;

View make_view(FieldOfView::Shape shape, double horizontal, double vertical, double max_range) {
  const FieldOfView view{shape, horizontal, vertical, max_range};
  view.check();
  return std::make_shared<FieldOfView>(view);
}

// An image of the directions that `make()` returns.
template <class Make>
py::array_t<float> image_of(std::size_t columns, std::size_t rows, const Make& make) {
  const std::vector<Eigen::Vector3d> directions = [&] {
    const OthersRun others_run;
    return make();
  }();
  py::array_t<float> array(Shape{static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns), 3});
  float* data = array.mutable_data();
  const OthersRun others_run;
  for (std::size_t i = 0; i < directions.size(); ++i)
    Eigen::Map<Eigen::Vector3f>(data + 3 * i) = directions[i].cast<float>();
  return array;
}

py::array_t<float> directions(const View& self, std::size_t columns, std::size_t rows) {
  return image_of(columns, rows, [&] { return sensor_directions(*self, columns, rows); });
}

py::array_t<bool> contains(const View& self, const py::object& offset_object, const py::object& yaw_object) {
  const Numbers offsets("offsets", offset_object, 3), yaws("yaw", yaw_object, 0);
  py::array_t<bool> array(common_shape({&offsets, &yaws}));
  bool* data = array.mutable_data();
  const auto size = static_cast<std::size_t>(array.size());
  const OthersRun others_run;
  for (std::size_t i = 0; i < size; ++i)
    data[i] =
        self->contains({offsets.number(i, 0), offsets.number(i, 1), offsets.number(i, 2)}, yaws.number(i));
  return array;
}

std::string_view shape_of(const View& self) {
  switch (self->shape) {
    case FieldOfView::Shape::kSpinning:
      return "spinning";
    case FieldOfView::Shape::kPyramid:
      return "pyramid";
    case FieldOfView::Shape::kCone:
      return "cone";
  }
  return "";
}

std::optional<double> horizontal_of(const View& self) {
  return self->shape == FieldOfView::Shape::kSpinning ? std::nullopt : std::optional(self->horizontal);
}

std::optional<double> vertical_of(const View& self) {
  return self->shape == FieldOfView::Shape::kCone ? std::nullopt : std::optional(self->vertical);
}

py::array_t<float> pinhole(const py::object& object, std::size_t columns, std::size_t rows) {
  const Numbers numbers("intrinsics", object, 3);
  if (numbers.shape() != Shape{3}) throw py::value_error("intrinsics: has to be of shape (3, 3)");
  const Eigen::Matrix3d intrinsics = matrix_of<3>(numbers);
  return image_of(columns, rows, [&] { return pinhole_directions(intrinsics, columns, rows); });
}

}  // namespace

void bind_sensor_rays(py::module_& module) {
  py::class_<FieldOfView, View>(
      module, "FieldOfView",
      "The space that a range sensor sees; x forward, y left, z up. Angles in radians.")
      .def_static(
          "spinning",
          [](double vertical, double max_range) {
            return make_view(FieldOfView::Shape::kSpinning, 0.0, vertical, max_range);
          },
          py::arg("vertical"), py::arg("max_range"),
          "A lidar: all azimuths, elevations within +-vertical / 2 [rad]; max_range in metres.")
      .def_static(
          "pyramid",
          [](double horizontal, double vertical, double max_range) {
            return make_view(FieldOfView::Shape::kPyramid, horizontal, vertical, max_range);
          },
          py::arg("horizontal"), py::arg("vertical"), py::arg("max_range"),
          "A camera with these full opening angles [rad]; max_range in metres.")
      .def_static(
          "cone",
          [](double opening, double max_range) {
            return make_view(FieldOfView::Shape::kCone, opening, 0.0, max_range);
          },
          py::arg("opening"), py::arg("max_range"),
          "A sonar with this full opening angle [rad]; max_range in metres.")
      .def_property_readonly("shape", &shape_of, "'spinning', 'pyramid' or 'cone'.")
      .def_property_readonly(
          "horizontal", &horizontal_of,
          "[rad] The full opening angle from left to right, of a cone on all sides; None of a spinning "
          "sensor, which sees all around.")
      .def_property_readonly("vertical", &vertical_of,
                             "[rad] The full opening angle from bottom to top; None of a cone.")
      .def_property_readonly(
          "max_range", [](const View& self) { return self->max_range; }, "[m]")
      .def("contains", &contains, py::arg("offsets"), py::arg("yaw"),
           R"(bool (...): which points are in view; nothing that could hide them counts.

offsets: float32 or float64 (..., 3) [m], from the sensor to the points, along the map's axes. yaw: [rad] of the sensor, which is
upright; one, or of shape (...). The sensor's own position is never in view.)")
      .def(
          "directions", &directions, py::arg("columns"), py::arg("rows"),
          R"(float32 (rows, columns, 3): unit vectors that fill the view, in the sensor's frame, rows from the top.

Spinning: rows are beams, columns azimuths counter-clockwise from straight ahead. Pyramid: through the centres of
pixels, columns from the left. Cone: in a spiral from the axis outwards. Turn them by `directions @ R.T`.)");
  module.def(
      "pinhole_directions", &pinhole, py::arg("intrinsics"), py::arg("columns"), py::arg("rows"),
      R"(float32 (rows, columns, 3): unit vectors through the centres of a camera's pixels, rows from the top.

intrinsics: (3, 3), (fx 0 cx, 0 fy cy, 0 0 1) [pixels]. Optical frame: x right, y down, z forward.)");
}

}  // namespace frontlux::python
