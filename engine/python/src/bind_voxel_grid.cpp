#include "bindings.hpp"

#include <frontlux/octomap.hpp>
#include <frontlux/python/arrays.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <filesystem>
#include <utility>

namespace frontlux::python {
namespace {

constexpr std::uint64_t kMostStates = std::uint64_t{1} << 31;

Occupancy state_of(int state) {
  if (state < 0 || state > 2)
    throw py::value_error("state: " + std::to_string(state) +
                          ", but has to be 0 (unknown), 1 (free) or 2 (occupied)");
  return static_cast<Occupancy>(state);
}

// The box of an array of states whose first voxel is `low`.
KeyBox box_of(const VoxelKey& low, const py::array& states) {
  if (states.ndim() != 3)
    throw py::value_error("states: " + std::to_string(states.ndim()) +
                          " axes, but there have to be 3: x, y and z");
  const std::array<int, 3> first{low.x, low.y, low.z};
  std::array<std::int64_t, 3> last{};
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (states.shape(axis) == 0) throw py::value_error("states: an axis is empty");
    last[axis] = first[axis] + states.shape(axis) - 1;
    if (last[axis] >= Lattice::kKeysPerAxis)
      throw py::value_error("states: axis " + std::to_string(axis) + " ends at key " +
                            std::to_string(last[axis]) + ", but keys end at 65535");
  }
  return {low, make_key(last[0], last[1], last[2])};
}

// Calls visit(key, place) for a box in the order of an array of shape (x, y, z).
template <class Visit>
void for_each_place(const KeyBox& box, const Visit& visit) {
  std::size_t place = 0;
  for (int x = box.min.x; x <= box.max.x; ++x)
    for (int y = box.min.y; y <= box.max.y; ++y)
      for (int z = box.min.z; z <= box.max.z; ++z) visit(make_key(x, y, z), place++);
}

void set_states(const Held<VoxelGrid>& self, const VoxelKey& low, const py::array& states) {
  const KeyBox box = box_of(low, states);
  const bool booleans = py::isinstance<py::array_t<bool>>(states);
  if (!booleans && !py::isinstance<py::array_t<std::uint8_t>>(states))
    throw py::type_error("states: dtype " + py::str(states.dtype()).cast<std::string>() +
                         ", but has to be bool (occupied or free) or uint8 (0 unknown, 1 free, 2 occupied)");
  check_memory("states", states);
  const auto* data = static_cast<const std::uint8_t*>(states.data());
  const std::size_t size = static_cast<std::size_t>(states.size());
  for (std::size_t i = 0; !booleans && i < size; ++i)
    if (data[i] > 2)
      throw py::value_error("states: holds " + std::to_string(data[i]) + ", but 2 is the largest state");
  self->use([&](VoxelGrid& grid) {
    for_each_place(box, [&](const VoxelKey& key, std::size_t place) {
      const auto state =
          static_cast<Occupancy>(booleans ? 1 + (data[place] != 0) : std::min<int>(data[place], 2));
      if (grid.at(key) != state) grid.set(key, state);
    });
  });
}

Held<VoxelGrid> from_occupancy(const py::array& states, double resolution, const py::object& corner) {
  const auto grid = std::make_shared<Guarded<VoxelGrid>>(resolution);
  const Numbers numbers("corner", corner, 3);
  if (!numbers.shape().empty()) throw py::value_error("corner: has to be one point, of shape (3,)");
  const Lattice lattice(resolution);
  const auto low =
      lattice.key((numbers.point(0).cast<double>() + Eigen::Vector3d::Constant(resolution / 2)).eval());
  if (!low) throw py::value_error("corner: not finite, or outside the key range");
  set_states(grid, *low, states);
  return grid;
}

py::array_t<std::uint8_t> states(const Held<VoxelGrid>& self, const py::object& min_key,
                                 const py::object& max_key) {
  const KeyBox box{Keys("min_key", min_key).one(), Keys("max_key", max_key).one()};
  if (!box.contains(box.min)) throw py::value_error("min_key: above max_key");
  if (size_of(box) > kMostStates)
    throw py::value_error("a box of " + std::to_string(size_of(box)) +
                          " voxels, but there may be at most 2^31");
  const auto length = [](int low, int high) { return static_cast<py::ssize_t>(high - low + 1); };
  py::array_t<std::uint8_t> result(
      Shape{length(box.min.x, box.max.x), length(box.min.y, box.max.y), length(box.min.z, box.max.z)});
  std::uint8_t* data = result.mutable_data();
  self->use([&](const VoxelGrid& grid) {
    for_each_place(box, [&](const VoxelKey& key, std::size_t place) {
      data[place] = static_cast<std::uint8_t>(grid.at(key));
    });
  });
  return result;
}

py::array_t<std::uint8_t> at(const Held<VoxelGrid>& self, const py::object& object) {
  const Keys keys("keys", object);
  py::array_t<std::uint8_t> result(keys.shape());
  std::uint8_t* data = result.mutable_data();
  self->use([&](const VoxelGrid& grid) {
    for (const VoxelKey& key : keys.span()) *data++ = static_cast<std::uint8_t>(grid.at(key));
  });
  return result;
}

py::array_t<std::uint16_t> keys_of(const Held<VoxelGrid>& self, const py::object& object) {
  const Numbers points("points", object, 3);
  const Lattice lattice = self->use([](const VoxelGrid& grid) { return grid.lattice(); });
  const std::size_t size = size_of(points.shape());
  py::array_t<std::uint16_t> result(with(points.shape(), 3));
  auto* keys = reinterpret_cast<VoxelKey*>(result.mutable_data());
  const OthersRun others_run;
  for (std::size_t i = 0; i < size; ++i) {
    const auto key = lattice.key(points.point(i));
    if (!key)
      throw py::value_error("points: number " + std::to_string(i) +
                            " is not finite, or outside the key range");
    keys[i] = *key;
  }
  return result;
}

py::array_t<float> centers(const Held<VoxelGrid>& self, const py::object& object) {
  const Keys keys("keys", object);
  const Lattice lattice = self->use([](const VoxelGrid& grid) { return grid.lattice(); });
  py::array_t<float> result(with(keys.shape(), 3));
  float* data = result.mutable_data();
  const OthersRun others_run;
  for (std::size_t i = 0; i < keys.span().size(); ++i)
    Eigen::Map<Eigen::Vector3f>(data + 3 * i) = lattice.center(keys.span()[i]);
  return result;
}

Held<VoxelGrid> copy(const Held<VoxelGrid>& self) {
  return std::make_shared<Guarded<VoxelGrid>>(self->use([](const VoxelGrid& grid) { return grid; }));
}

}  // namespace

void bind_voxel_grid(py::module_& module) {
  using Grid = Held<VoxelGrid>;
  py::class_<Guarded<VoxelGrid>, Grid>(module, "VoxelGrid",
                                       R"(Which voxels of a map are unknown (0), free (1) and occupied (2).

Keys are OctoMap's: uint16 arrays of shape (..., 3); the voxel (32768, 32768, 32768) has its lower corner at the
map's origin. A copy is a snapshot and costs nothing.)")
      .def(py::init<double>(), py::arg("resolution"),
           "A grid of unknown voxels with edges of `resolution` [m].")
      .def_static(
          "read",
          [](const std::filesystem::path& file) {
            const OthersRun others_run;
            return std::make_shared<Guarded<VoxelGrid>>(make_voxel_grid(read_octree(file)));
          },
          py::arg("file"),
          "The grid of an OctoMap file, .bt or .ot. Raises RuntimeError if it is none or damaged.")
      .def_static("from_occupancy", &from_occupancy, py::arg("states"), py::arg("resolution"),
                  py::arg("corner") = py::make_tuple(0.0, 0.0, 0.0),
                  R"(The grid of an array of voxels.

states: shape (x, y, z), contiguous; bool (True is occupied, False free) or uint8 (0 unknown, 1 free, 2 occupied).
resolution: [m] edge of a voxel. corner: [m] shape (3,), lower corner of states[0, 0, 0], rounded to the lattice.
All other voxels are unknown.)")
      .def("__repr__",
           [](const Grid& self) {
             const auto [resolution, box] = self->use(
                 [](const VoxelGrid& grid) { return std::pair(grid.resolution(), grid.known_bounds()); });
             const py::str text("<frontlux.VoxelGrid of {:g} m: {}>");
             if (!box) return text.format(resolution, "all unknown");
             const auto size = [](int low, int high) { return high - low + 1; };
             return text.format(resolution,
                                py::str("known within {} x {} x {} voxels")
                                    .format(size(box->min.x, box->max.x), size(box->min.y, box->max.y),
                                            size(box->min.z, box->max.z)));
           })
      .def_property_readonly(
          "resolution",
          [](const Grid& self) { return self->use([](const VoxelGrid& grid) { return grid.resolution(); }); },
          "[m] Edge of a voxel.")
      .def_property_readonly(
          "known_bounds",
          [](const Grid& self) -> py::object {
            const auto box = self->use([](const VoxelGrid& grid) { return grid.known_bounds(); });
            if (!box) return py::none();
            return to_array(std::array{box->min, box->max});
          },
          "uint16 (2, 3): lowest and highest key of the box of all free and occupied voxels; None if there "
          "are none.")
      .def(
          "count",
          [](const Grid& self) { return self->use([](const VoxelGrid& grid) { return grid.count(); }); },
          "[unknown, free, occupied]: the number of voxels in each state, over the whole key range.")
      .def("states", &states, py::arg("min_key"), py::arg("max_key"),
           "uint8 (x, y, z): the states of the voxels of a box, both keys of shape (3,) included.")
      .def(
          "set_states",
          [](const Grid& self, const py::object& min_key, const py::array& states) {
            set_states(self, Keys("min_key", min_key).one(), states);
          },
          py::arg("min_key"), py::arg("states"),
          "Writes an array of states as that of `from_occupancy`; min_key, of shape (3,), is that of "
          "states[0, 0, 0].")
      .def("at", &at, py::arg("keys"), "uint8 (...): the states of voxels; keys is uint16 (..., 3).")
      .def(
          "keys",
          [](const Grid& self, int state) {
            const Occupancy wanted = state_of(state);
            return to_array(self->use([&](const VoxelGrid& grid) { return keys_in(grid, wanted); }));
          },
          py::arg("state"), "uint16 (n, 3), sorted: the keys of all voxels that are FREE or OCCUPIED.")
      .def("keys_of", &keys_of, py::arg("points"),
           "uint16 (..., 3): the voxels that hold points [m], float32 or float64 (..., 3).")
      .def("centers", &centers, py::arg("keys"),
           "float32 (..., 3): the centres [m] of voxels, uint16 (..., 3).")
      .def("copy", &copy, "A snapshot: later changes to either leave the other alone.")
      .def("__copy__", &copy)
      .def(
          "__deepcopy__", [](const Grid& self, const py::object&) { return copy(self); }, py::arg("memo"))
      .def(
          "__eq__",
          [](const Grid& self, const Grid& other) {
            const Grid snapshot = copy(other);  // never two locks at once
            const VoxelGrid theirs = snapshot->use([](const VoxelGrid& grid) { return grid; });
            return self->use([&](const VoxelGrid& grid) { return grid == theirs; });
          },
          py::arg("other"), py::is_operator())
      .attr("__hash__") = py::none();
}

}  // namespace frontlux::python
