#pragma once

#include <frontlux/key_box.hpp>

#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// A value for every key of a box.
template <class T>
class BoxArray {
 public:
  /// Holds nothing.
  BoxArray() : box_{{1, 1, 1}, {0, 0, 0}} {}
  explicit BoxArray(const KeyBox& box)
      : box_(box),
        size_y_(static_cast<std::size_t>(box.max.y - box.min.y + 1)),
        size_z_(static_cast<std::size_t>(box.max.z - box.min.z + 1)),
        values_(size_of(box)) {}

  [[nodiscard]] const KeyBox& box() const { return box_; }

  /// @pre box().contains(key)
  [[nodiscard]] T& operator[](const VoxelKey& key) { return values_[index(key)]; }
  [[nodiscard]] const T& operator[](const VoxelKey& key) const { return values_[index(key)]; }

 private:
  [[nodiscard]] std::size_t index(const VoxelKey& key) const {
    return (static_cast<std::size_t>(key.x - box_.min.x) * size_y_ +
            static_cast<std::size_t>(key.y - box_.min.y)) *
               size_z_ +
           static_cast<std::size_t>(key.z - box_.min.z);
  }

  KeyBox box_;
  std::size_t size_y_ = 0, size_z_ = 0;
  std::vector<T> values_;
};

}  // namespace frontlux::planner::detail
