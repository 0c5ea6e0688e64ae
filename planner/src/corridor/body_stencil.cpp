#include "corridor/whole_voxels.hpp"

#include <frontlux/planner/body_stencil.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

constexpr double kIgnored = 1e-4;  // of a voxel: centres that were floats are in the middle, too

int node_edge_log2(double edge, double resolution) {
  int log2 = 0;
  while (std::ldexp(resolution, log2) < edge - detail::kSlack * resolution) ++log2;
  return log2;
}

// [voxels] From the middle of a cell to a voxel, along an axis.
double distance_to(int voxel) { return std::max(std::abs(voxel) - 0.5, 0.0); }

// [m] How far a box of an edge may stick out of its voxels, anywhere in its cell.
double reach_along(double edge, double resolution) {
  const double beyond = edge / 2 - detail::half_width(edge, resolution) * resolution;
  return beyond > kIgnored * resolution ? std::min(beyond, (0.5 - kIgnored) * resolution) : 0.0;
}

}  // namespace

// A cylinder, of which z does not matter here, or a sphere, in the middle of a cell.
struct BodyStencil::RoundBody {
  bool sphere;
  double radius;  // [voxels] with the margin

  // How many layers of a column the body reaches, from its middle up; of a cylinder 0 or 1.
  [[nodiscard]] int layers(int x, int y) const {
    const double side = std::hypot(distance_to(x), distance_to(y)), within = radius - detail::kSlack;
    const auto reaches = [&](int layer) { return std::hypot(side, distance_to(layer)) < within; };
    int count = reaches(0) ? 1 : 0;
    if (sphere && count > 0) {  // about so many, since rounding may be for one more or less
      count = std::max(1, static_cast<int>(std::sqrt(std::max(0.0, within * within - side * side))));
      while (reaches(count)) ++count;
      while (count > 1 && !reaches(count - 1)) --count;
    }
    return x == 0 && y == 0 ? std::max(count, 1) : count;
  }
  // The distance of the nearest voxel of a column that it does not reach.
  [[nodiscard]] double nearest_beyond(int x, int y) const {
    const int count = layers(x, y);
    if (!sphere && count > 0) return std::numeric_limits<double>::infinity();
    return std::hypot(distance_to(x), distance_to(y), distance_to(count));
  }
};

namespace {

// Whether the extents are those of the shape.
void check(const TravelOptions& options, double resolution) {
  if (options.shape == BodyShape::kBox) return;
  const std::string shape(name_of(options.shape));
  const auto is = [&](const char* name, int axis) {
    return "travel corridor: " + std::string(name) + " is " + std::to_string(options.extents[axis]) + " m";
  };
  if (const auto axis = axis_unlike_x(options))
    throw std::invalid_argument(is(*axis == 1 ? "extents.y" : "extents.z", *axis) + ", but of a " + shape +
                                " it has to be extents.x, " + std::to_string(options.extents.x()) + " m");
  if (!(options.box().maxCoeff() / resolution <= detail::kMaxWindow))
    throw std::invalid_argument(is("extents.x", 0) + ", but with its margin a " + shape +
                                " may be no wider than " + std::to_string(detail::kMaxWindow) +
                                " voxels of " + std::to_string(resolution) + " m");
}

}  // namespace

BodyStencil::BodyStencil(const TravelOptions& options, double resolution) {
  check(options, resolution);
  if (options.node_edge > 0.0) {
    const int edge = 1 << node_edge_log2(options.node_edge, resolution);
    low_.fill(-(edge / 2));
    high_.fill(edge - 1 - edge / 2);
    return;
  }
  const Eigen::Vector3d box = options.box();
  for (std::size_t a = 0; a < 3; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    high_[a] = detail::half_width(box[i], resolution);
    low_[a] = -high_[a];
    if (a < 2 || !options.drives()) reach_[i] = reach_along(box[i], resolution);
  }
  if (options.drives()) {
    const int below = detail::layers_below(options, resolution);
    low_[2] = std::min(0, detail::reached_from_below(options, resolution) - below);
    high_[2] = std::max(0, detail::voxels_over(options.extents.z(), resolution) - 1 - below);
  }
  switch (options.planned_shape()) {
    case BodyShape::kBox:
      break;
    case BodyShape::kCylinder:
      round_off({false, box.x() / 2 / resolution}, resolution);
      break;
    case BodyShape::kSphere:
      round_off({true, box.x() / 2 / resolution}, resolution);
      break;
  }
}

void BodyStencil::round_off(const RoundBody& body, double resolution) {
  double beyond = std::numeric_limits<double>::infinity();
  std::vector<Range> columns;
  bool all = true;
  for (int x = low_[0] - 1; x <= high_[0] + 1; ++x)
    for (int y = low_[1] - 1; y <= high_[1] + 1; ++y) {
      beyond = std::min(beyond, body.nearest_beyond(x, y));
      if (x < low_[0] || x > high_[0] || y < low_[1] || y > high_[1]) continue;
      const int layers = body.layers(x, y);
      if (!body.sphere) columns.push_back(layers > 0 ? Range{low_[2], high_[2]} : Range{});
      if (body.sphere) columns.push_back({1 - layers, layers - 1});
      all = all && columns.back().low == low_[2] && columns.back().high == high_[2];
    }
  // Along each axis a voxel is nearest from one of the two middles around a point. So each voxel that a body
  // at the point touches is in the stencil of a cell within half a voxel of it. Voxels are nearer to a middle
  // than the radius, or at least `beyond` far: axes off by less than this room in all need their own cell
  // only. A shape that rounds off no corner reaches as far as its box.
  const double room = std::max(0.0, beyond - body.radius) / std::sqrt(body.sphere ? 3.0 : 2.0);
  double reach = std::min(0.5 - room, 0.5 - kIgnored) * resolution;
  if (reach < kIgnored * resolution) reach = 0.0;
  for (Eigen::Index a = 0; a < (body.sphere ? 3 : 2); ++a)
    reach_[a] = all ? std::min(reach, reach_[a]) : reach;
  if (!all) columns_ = std::move(columns);
}

}  // namespace frontlux::planner
