#include <frontlux/sensor_rays.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

constexpr std::size_t kMostRays = std::size_t{1} << 26;

void check_size(std::size_t columns, std::size_t rows) {
  if (columns == 0 || rows == 0 || columns > kMostRays / rows)
    throw std::invalid_argument("sensor: " + std::to_string(columns) + " x " + std::to_string(rows) +
                                " rays, but there have to be between 1 and 2^26");
}

std::vector<Eigen::Vector3d> pyramid(const FieldOfView& view, std::size_t columns, std::size_t rows) {
  // Offset of a pixel's centre from the middle of the image, in halves of the image: in (-1, 1).
  const auto offset = [](std::size_t pixel, std::size_t count) {
    return 1.0 - (2.0 * static_cast<double>(pixel) + 1.0) / static_cast<double>(count);
  };
  const double width = std::tan(view.horizontal / 2), height = std::tan(view.vertical / 2);
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      directions.push_back(
          Eigen::Vector3d(1.0, width * offset(column, columns), height * offset(row, rows)).normalized());
  return directions;
}

std::vector<Eigen::Vector3d> spinning(const FieldOfView& view, std::size_t columns, std::size_t rows) {
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t row = 0; row < rows; ++row) {
    const double down = rows == 1 ? 0.5 : static_cast<double>(row) / static_cast<double>(rows - 1);
    const double elevation = view.vertical * (0.5 - down);
    for (std::size_t column = 0; column < columns; ++column) {
      const double azimuth =
          2.0 * std::numbers::pi * static_cast<double>(column) / static_cast<double>(columns);
      directions.emplace_back(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    }
  }
  return directions;
}

std::vector<Eigen::Vector3d> cone(const FieldOfView& view, std::size_t count) {
  // Equal steps of height cut a sphere into rings of equal area; the golden angle between successive rays
  // keeps rays on neighbouring rings apart.
  const double cap = 1.0 - std::cos(view.horizontal / 2);
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t i = 0; i < count; ++i) {
    const double below = cap * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double off_axis = std::sqrt(below * (2.0 - below));
    const double turn = golden_angle * static_cast<double>(i);
    directions.emplace_back(1.0 - below, off_axis * std::cos(turn), off_axis * std::sin(turn));
  }
  return directions;
}

}  // namespace

std::vector<Eigen::Vector3d> sensor_directions(const FieldOfView& view, std::size_t columns,
                                               std::size_t rows) {
  view.check();
  check_size(columns, rows);
  switch (view.shape) {
    case FieldOfView::Shape::kPyramid:
      return pyramid(view, columns, rows);
    case FieldOfView::Shape::kCone:
      return cone(view, columns * rows);
    case FieldOfView::Shape::kSpinning:
      break;
  }
  return spinning(view, columns, rows);
}

std::vector<Eigen::Vector3d> pinhole_directions(const Eigen::Matrix3d& intrinsics, std::size_t columns,
                                                std::size_t rows) {
  check_size(columns, rows);
  const double fx = intrinsics(0, 0), fy = intrinsics(1, 1), cx = intrinsics(0, 2), cy = intrinsics(1, 2);
  if (!(fx > 0.0 && fy > 0.0) || !intrinsics.allFinite())
    throw std::invalid_argument("pinhole: focal lengths of " + std::to_string(fx) + " and " +
                                std::to_string(fy) + " pixels, but they have to be positive, and all finite");
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      directions.push_back(Eigen::Vector3d((static_cast<double>(column) + 0.5 - cx) / fx,
                                           (static_cast<double>(row) + 0.5 - cy) / fy, 1.0)
                               .normalized());
  return directions;
}

std::vector<Ray> rays_from(const Eigen::Isometry3d& T_map_sensor, std::span<const Eigen::Vector3d> directions,
                           double max_range) {
  std::vector<Ray> rays;
  rays.reserve(directions.size());
  const Eigen::Vector3f origin = T_map_sensor.translation().cast<float>();
  for (const Eigen::Vector3d& direction : directions)
    rays.push_back({origin, (T_map_sensor.linear() * direction).cast<float>(), max_range});
  return rays;
}

}  // namespace frontlux
