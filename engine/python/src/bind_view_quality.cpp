#include "bindings.hpp"

#include <frontlux/python/arrays.hpp>
#include <frontlux/view_quality.hpp>

#include <pybind11/stl.h>

namespace frontlux::python {
namespace {

// An image, and the map that it shows; none before it shows any.
struct Shown : ViewQualityImage {
  using ViewQualityImage::ViewQualityImage;
  std::optional<VoxelGrid> grid{};
};
using Self = Held<Shown>;

Self make(double resolution, const std::shared_ptr<FieldOfView>& view, const std::string& renderer,
          std::optional<int> samples, int azimuth_bins, std::uint64_t seed) {
  ViewQualityOptions options;
  if (renderer == "exact")
    options.renderer = ViewQualityOptions::Renderer::kExact;
  else if (renderer != "rays")
    throw py::value_error("renderer: '" + renderer + "', but has to be 'rays' or 'exact'");
  options.samples = samples.value_or(ViewQualityOptions::kAll);
  options.azimuth_bins = azimuth_bins;
  options.seed = seed;
  return std::make_shared<Guarded<Shown>>(Lattice(resolution), *view, options);
}

// Calls use(image, viewpoints, targets).
template <class Use>
auto with_keys(const Self& self, const py::object& viewpoints, const py::object& targets, const Use& use) {
  const Keys places("viewpoints", viewpoints), seen("targets", targets);
  return self->use([&](Shown& image) { return use(image, places.span(), seen.span()); });
}

// An array of one number of each value.
template <class T, class Get>
auto column(const Get& get) {
  return [get](const Self& self) {
    const auto numbers = self->use([&](const ViewQualityImage& image) {
      std::vector<T> of_all;
      for (const ViewQuality& value : image.values()) of_all.push_back(get(value));
      return of_all;
    });
    return py::array_t<T>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
  };
}

py::array_t<std::uint32_t> bin_hits(const Self& self) {
  std::vector<std::uint32_t> hits;
  const auto [rows, bins] = self->use([&](const ViewQualityImage& image) {
    for (std::size_t i = 0; i < image.size(); ++i)
      hits.insert(hits.end(), image.bin_hits(i).begin(), image.bin_hits(i).end());
    return std::pair(image.size(), image.options().azimuth_bins);
  });
  return py::array_t<std::uint32_t>(Shape{static_cast<py::ssize_t>(rows), bins}, hits.data());
}

AzimuthWindow window(const py::object& object, double opening, std::optional<double> containing) {
  const py::array_t<std::uint32_t> hits = integers_of<std::uint32_t>("bin_hits", object);
  if (hits.ndim() != 1) throw py::value_error("bin_hits: has to be of shape (bins,)");
  return best_window({hits.data(), static_cast<std::size_t>(hits.size())}, opening, containing);
}

}  // namespace

void bind_view_quality(py::module_& module) {
  py::class_<Guarded<Shown>, Self>(module, "ViewQualityImage",
                                   R"(How many targets each of many viewpoints sees, updated with the map.

Arrays have one entry for each viewpoint, in the order in which these were given.)")
      .def(py::init(&make), py::arg("resolution"), py::arg("field_of_view"), py::arg("renderer") = "rays",
           py::arg("samples") = 64, py::arg("azimuth_bins") = 0, py::arg("seed") = 1,
           R"(An image without viewpoints.

resolution: [m] of the map. renderer: 'rays' casts to `samples` of the targets in view, None: to all; 'exact' looks at
all, many viewpoints at once. azimuth_bins: sectors of the horizon in which visible targets are counted.)")
      .def(
          "render",
          [](const Self& self, const std::shared_ptr<Caster>& caster, const py::object& viewpoints,
             const py::object& targets) {
            with_keys(self, viewpoints, targets, [&](Shown& image, const auto& places, const auto& seen) {
              const VoxelGrid grid = caster->answers->grid().value();
              image.render(*caster->answers, places, seen);
              image.grid = grid;
            });
          },
          py::arg("caster"), py::arg("viewpoints"), py::arg("targets"),
          "Renders every viewpoint. viewpoints, targets: uint16 keys (..., 3).")
      .def(
          "update",
          [](const Self& self, const std::shared_ptr<Caster>& caster, const py::object& viewpoints,
             const py::object& targets, const std::shared_ptr<Change>& change) {
            return with_keys(
                self, viewpoints, targets, [&](Shown& image, const auto& places, const auto& seen) {
                  if (image.grid) change->expect_from(*image.grid);
                  const std::size_t rendered = image.update(*caster->answers, places, seen, change->change());
                  image.grid = change->grid;
                  return rendered;
                });
          },
          py::arg("caster"), py::arg("viewpoints"), py::arg("targets"), py::arg("change"),
          R"(Renders only what is new, and what a change since the last call may concern; the same values as `render`'s.

change: every one since the last call, in their order. Returns the number of viewpoints that were rendered. Raises
ValueError for a change of another map, or if one before it was left out: `render` begins anew.)")
      .def("__len__",
           [](const Self& self) {
             return self->use([](const ViewQualityImage& image) { return image.size(); });
           })
      .def_property_readonly(
          "viewpoints",
          [](const Self& self) {
            return to_array(self->use([](const ViewQualityImage& image) {
              return std::vector<VoxelKey>(image.viewpoints().begin(), image.viewpoints().end());
            }));
          },
          "uint16 (n, 3)")
      .def_property_readonly("gain", column<double>([](const ViewQuality& value) { return value.gain; }),
                             "float64 (n,): estimated number of visible targets.")
      .def_property_readonly("standard_error",
                             column<double>([](const ViewQuality& value) { return value.standard_error; }),
                             "float64 (n,): of the gain.")
      .def_property_readonly("population",
                             column<std::uint32_t>([](const ViewQuality& value) { return value.population; }),
                             "uint32 (n,): targets in view at some yaw, seen or not.")
      .def_property_readonly(
          "bin_hits", &bin_hits,
          "uint32 (n, azimuth_bins): visible targets among the drawn ones, by sector from azimuth 0 upwards.")
      .def_property_readonly(
          "best",
          [](const Self& self) {
            return self->use([](const ViewQualityImage& image) {
              if (image.size() == 0) throw std::invalid_argument("the image has no viewpoints");
              return image.best();
            });
          },
          "The place of the viewpoint with the greatest gain. Raises ValueError if there are no viewpoints.");
  module.def(
      "best_window",
      [](const py::object& hits, double opening, std::optional<double> containing) {
        const AzimuthWindow best = window(hits, opening, containing);
        return py::make_tuple(best.yaw, best.hits);
      },
      py::arg("bin_hits"), py::arg("opening"), py::arg("containing") = py::none(),
      R"((yaw [rad], hits): the neighbouring sectors within an opening angle [rad] that have the most hits.

bin_hits: integers (bins,), from 0 to 2^32 - 1, as a row of `ViewQualityImage.bin_hits`. containing: [rad]
only windows with this azimuth.)");
}

}  // namespace frontlux::python
