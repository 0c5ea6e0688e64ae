#include "bindings.hpp"

#include <frontlux/live_map.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/python/arrays.hpp>

#include <Eigen/Geometry>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace frontlux::python {
namespace {

struct Map {
  Octree tree;
  LiveMap live;
  explicit Map(Octree map) : tree(std::move(map)), live(tree) {}
};
using Self = Held<Map>;
using ChangePointer = std::shared_ptr<Change>;

Self make(double resolution) {
  static_cast<void>(Lattice(resolution));  // refuses what is no length before OctoMap sees it
  return std::make_shared<Guarded<Map>>(std::make_shared<octomap::OcTree>(resolution));
}

// Whether OctoMap can follow a ray to its end, or to its range [m] if that is nearer: it prints of one that
// ends outside the key range, and follows one whose length in float is 0, or infinite, for ever.
// @throws std::invalid_argument if it would write past the end of its list of voxels
bool can_follow(const Lattice& lattice, const octomap::point3d& origin, const octomap::point3d& point,
                double max_range) {
  constexpr int kMostSteps = 99'990;  // OctoMap's list has 100,000, and rounding adds a few
  const auto key = [&](const octomap::point3d& at) {
    return lattice.key(Eigen::Vector3f(at.x(), at.y(), at.z()));
  };
  const bool cut_off = max_range > 0.0 && (point - origin).norm() > max_range;
  const octomap::point3d end =
      cut_off ? origin + (point - origin).normalized() * static_cast<float>(max_range) : point;
  const auto from = key(origin), to = key(end);
  if (!from || !to) return false;
  if (*from == *to) return true;
  const auto length = static_cast<float>((end - origin).norm());
  if (!(length > 1e-15F) || std::isinf(length)) return false;
  const int steps = std::abs(to->x - from->x) + std::abs(to->y - from->y) + std::abs(to->z - from->z);
  if (steps > kMostSteps)
    throw std::invalid_argument("a ray passes " + std::to_string(steps) +
                                " voxels, but OctoMap takes at most " + std::to_string(kMostSteps) +
                                "; give a " + (max_range > 0.0 ? "smaller " : "") + "max_range");
  return true;
}

// A scan whose points are in a frame of their own.
ChangePointer insert(const Self& self, const Numbers& points, const Eigen::Isometry3d& T_map_points,
                     const Eigen::Vector3f& origin, double max_range) {
  if (std::isnan(max_range)) throw py::value_error("max_range: not a number");
  const std::size_t size = size_of(points.shape());
  return self->use([&](Map& map) {
    const Lattice lattice = map.live.grid().lattice();
    if (!lattice.key(origin))
      throw std::invalid_argument("the scan's origin is not finite, or outside the key range");
    octomap::Pointcloud cloud;
    for (std::size_t i = 0; i < size; ++i) {
      const Eigen::Vector3f point = (T_map_points * points.point(i).cast<double>()).cast<float>();
      if (point.allFinite() && can_follow(lattice, to_octomap(origin), to_octomap(point), max_range))
        cloud.push_back(to_octomap(point));
    }
    std::visit(
        [&](const auto& tree) {
          tree->insertPointCloud(cloud, to_octomap(origin), max_range > 0.0 ? max_range : -1.0);
        },
        map.tree);
    const MapChange change = map.live.update();
    return ChangePointer(new Change(change));
  });
}

ChangePointer insert_points(const Self& self, const py::object& points, const py::object& origin,
                            double max_range) {
  const Numbers sensor("origin", origin, 3);
  if (!sensor.shape().empty()) throw py::value_error("origin: has to be one point, of shape (3,)");
  return insert(self, Numbers("points", points, 3), Eigen::Isometry3d::Identity(), sensor.point(0),
                max_range);
}

ChangePointer insert_scan(const Self& self, const py::object& points, const py::object& pose,
                          double max_range) {
  const Numbers numbers("pose", pose, 4);
  if (numbers.shape() != Shape{4}) throw py::value_error("pose: has to be of shape (4, 4)");
  const Eigen::Isometry3d T_map_sensor = pose_of(numbers);
  return insert(self, Numbers("points", points, 3), T_map_sensor, T_map_sensor.translation().cast<float>(),
                max_range);
}

ChangePointer change_between(const Held<VoxelGrid>& before, const Held<VoxelGrid>& after) {
  const auto snapshot = [](const VoxelGrid& grid) { return grid; };
  const VoxelGrid was = before->use(snapshot), is = after->use(snapshot);  // never two locks at once
  const OthersRun others_run;
  return std::make_shared<Change>(was, is);
}

}  // namespace

void bind_live_map(py::module_& module) {
  py::class_<Change, std::shared_ptr<Change>>(module, "MapChange",
                                              "What is new in a map, for what is kept up to date with it.")
      .def(
          py::init(&change_between), py::arg("before"), py::arg("after"),
          R"(What has changed from one VoxelGrid to another, as from a copy that was kept to the grid that `set_states` wrote to.

Insertions and updates return such a change by themselves. Between a grid and its edited copy it costs as much as the edit
did. Raises ValueError if the resolutions differ, or if more than 2^28 voxels have changed: make what is kept up to date anew then.)")
      .def_property_readonly(
          "keys",
          [](const std::shared_ptr<Change>& self) {
            py::array_t<std::uint16_t> keys(Shape{static_cast<py::ssize_t>(self->keys.size()), 3},
                                            reinterpret_cast<const std::uint16_t*>(self->keys.data()),
                                            py::cast(self));
            keys.attr("setflags")(py::arg("write") = false);
            return keys;
          },
          "uint16 (n, 3), sorted, read-only: every voxel whose state is not what it was before.")
      .def_property_readonly(
          "grid",
          [](const std::shared_ptr<Change>& self) {
            return std::make_shared<Guarded<VoxelGrid>>(self->grid);
          },
          "A snapshot of the map after the change.");

  py::class_<Guarded<Map>, Self>(
      module, "LiveMap",
      R"(A map that scans are inserted into: an octomap::OcTree with its grid and its caster, always in step.

Methods may be called from several threads; insertions wait for each other, and the caster answers meanwhile.)")
      .def(py::init(&make), py::arg("resolution"), "An empty map of voxels with edges of `resolution` [m].")
      .def_static(
          "read",
          [](const std::filesystem::path& file) {
            const OthersRun others_run;
            return std::make_shared<Guarded<Map>>(read_octree(file));
          },
          py::arg("file"),
          "The map of an OctoMap file, .bt or .ot. Raises RuntimeError if it is none or damaged.")
      .def(
          "insert", &insert_points, py::arg("points"), py::arg("origin"), py::arg("max_range") = -1.0,
          R"(Inserts a scan as OctoMap's insertPointCloud does: its points are occupied, and what lies before them free.

points: float32 or float64 (..., 3) [m], in the map's frame. Those that are not finite change nothing, nor do those whose
ray ends outside the key range, or in another voxel with no length in float32. origin: (3,) [m], where the sensor was.
max_range: [m] rays are free up to there, and points beyond it do not count as hits; <= 0: no limit. Raises ValueError, with
nothing inserted, if a ray passes more than 99,990 voxels. Returns a MapChange.)")
      .def("insert_scan", &insert_scan, py::arg("points"), py::arg("pose"), py::arg("max_range") = -1.0,
           "The same for points in the sensor's frame. pose: (4, 4), maps the sensor's frame into the map's: "
           "a rotation, a translation [m] and (0, 0, 0, 1).")
      .def(
          "write",
          [](const Self& self, const std::filesystem::path& file) {
            self->use([&](const Map& map) { write_octree(map.tree, file); });
          },
          py::arg("file"), "Writes an OctoMap file: all log-odds to .ot, free and occupied only to .bt.")
      .def_property_readonly(
          "grid",
          [](const Self& self) {
            return std::make_shared<Guarded<VoxelGrid>>(
                self->use([](const Map& map) { return map.live.grid(); }));
          },
          "A snapshot of its voxels.")
      .def_property_readonly(
          "caster",
          [](const Self& self) {
            const RayCaster* caster = self->use([](const Map& map) { return &map.live.caster(); });
            return std::shared_ptr<Caster>(new Caster{std::shared_ptr<const RayCaster>(self, caster)});
          },
          "Its caster, which answers from the map as it is at any time.");
}

}  // namespace frontlux::python
