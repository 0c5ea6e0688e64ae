#include "bindings.hpp"

#include <frontlux/frontier_set.hpp>
#include <frontlux/python/arrays.hpp>

namespace frontlux::python {
namespace {

struct Frontiers {
  FrontierSet set;
  VoxelGrid grid;  // whose they are
};
using Self = Held<Frontiers>;

void update(const Self& self, const std::shared_ptr<Change>& change) {
  self->use([&](Frontiers& frontiers) {
    change->expect_from(frontiers.grid);
    frontiers.set.update(change->change());
    frontiers.grid = change->grid;
  });
}

Self make(const Held<VoxelGrid>& held, const py::object& min_key, const py::object& max_key, bool corners) {
  KeyBox bounds = kAllVoxels;
  if (!min_key.is_none()) bounds.min = Keys("min_key", min_key).one();
  if (!max_key.is_none()) bounds.max = Keys("max_key", max_key).one();
  if (!bounds.contains(bounds.min)) throw py::value_error("min_key: above max_key");
  return held->use([&](const VoxelGrid& grid) {
    const Adjacency adjacency = corners ? Adjacency::kCorners : Adjacency::kFaces;
    return std::make_shared<Guarded<Frontiers>>(Frontiers{FrontierSet(grid, bounds, adjacency), grid});
  });
}

}  // namespace

void bind_frontier_set(py::module_& module) {
  py::class_<Guarded<Frontiers>, Self>(
      module, "FrontierSet", "The frontiers of a map: its unknown voxels that have a free neighbour.")
      .def(py::init(&make), py::arg("grid"), py::arg("min_key") = py::none(), py::arg("max_key") = py::none(),
           py::arg("corners") = false,
           R"(The frontiers within a box, whose lowest and highest key have shape (3,); None: everywhere.

corners: voxels that share an edge or a corner are neighbours too, not only those that share a face.)")
      .def("update", &update, py::arg("change"),
           "Takes in a change of the map: every one, in their order. Raises ValueError for one of another "
           "map, or if one before it was left out.")
      .def_property_readonly(
          "keys",
          [](const Self& self) {
            return to_array(self->use([](const Frontiers& frontiers) {
              return std::vector<VoxelKey>(frontiers.set.keys().begin(), frontiers.set.keys().end());
            }));
          },
          "uint16 (n, 3), sorted: all frontiers.")
      .def("__len__", [](const Self& self) {
        return self->use([](const Frontiers& frontiers) { return frontiers.set.size(); });
      });
}

}  // namespace frontlux::python
