#pragma once

#include <frontlux/field_of_view.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/python/guarded.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <algorithm>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux::python {

/// A caster of its own, or that of a live map, which alone updates it.
struct Caster {
  std::shared_ptr<const RayCaster> answers;
  std::shared_ptr<RayCaster> own{};
  std::mutex updating{};
};

/// A `MapChange` that lasts.
struct Change {
  VoxelGrid grid;
  std::vector<VoxelKey> keys;
  explicit Change(const MapChange& change)
      : grid(change.grid), keys(change.keys.begin(), change.keys.end()) {}
  /// From one map to another. @throws as `changed_keys`
  Change(const VoxelGrid& before, VoxelGrid after)
      : grid(std::move(after)), keys(changed_keys(before, grid)) {}
  [[nodiscard]] MapChange change() const { return {grid, keys}; }
  /// @throws std::invalid_argument unless it leads from this map to its own, which costs about as much as the
  ///         change itself if it does
  void expect_from(const VoxelGrid& before) const {
    if (!std::ranges::includes(keys, changed_keys(before, grid)))
      throw std::invalid_argument("change: of another map, or one before it was left out");
  }
};

}  // namespace frontlux::python

template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::python::Caster>>
    : public SomeObject<frontlux::python::Caster> {};
template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::python::Change>>
    : public SomeObject<frontlux::python::Change> {};
template <>
class pybind11::detail::type_caster<std::shared_ptr<frontlux::FieldOfView>>
    : public SomeObject<frontlux::FieldOfView> {};
