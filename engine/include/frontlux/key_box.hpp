#pragma once

#include <frontlux/ray.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace frontlux {

/// The key with these coordinates. @pre each is in the key range, 0 to 65535
[[nodiscard]] constexpr VoxelKey make_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)};
}

/// The key at an offset [voxels]; none outside the key range.
[[nodiscard]] constexpr std::optional<VoxelKey> offset_key(const VoxelKey& key, int dx, int dy, int dz) {
  const auto x = key.x + static_cast<std::uint32_t>(dx), y = key.y + static_cast<std::uint32_t>(dy),
             z = key.z + static_cast<std::uint32_t>(dz);
  if ((x | y | z) > 0xFFFF) return std::nullopt;
  return make_key(x, y, z);
}

/// An axis-aligned box of voxels, both ends included.
struct KeyBox {
  VoxelKey min;  ///< the least key on each axis
  VoxelKey max;  ///< the greatest key on each axis; it belongs to the box
  /// Whether a voxel lies in the box.
  [[nodiscard]] constexpr bool contains(const VoxelKey& k) const {
    return min.x <= k.x && k.x <= max.x && min.y <= k.y && k.y <= max.y && min.z <= k.z && k.z <= max.z;
  }
  friend constexpr bool operator==(const KeyBox&, const KeyBox&) = default;
};

/// The whole key range.
inline constexpr KeyBox kAllVoxels{{0, 0, 0}, {0xFFFF, 0xFFFF, 0xFFFF}};

/// The least and the greatest of two keys along each axis.
[[nodiscard]] constexpr VoxelKey least(const VoxelKey& a, const VoxelKey& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
[[nodiscard]] constexpr VoxelKey greatest(const VoxelKey& a, const VoxelKey& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// A cube of `edge` voxels a side. @pre it lies in the key range
[[nodiscard]] constexpr KeyBox cube(const VoxelKey& corner, int edge) {
  return {corner, make_key(corner.x + edge - 1, corner.y + edge - 1, corner.z + edge - 1)};
}

/// The smallest box that holds two.
[[nodiscard]] constexpr KeyBox hull(const KeyBox& a, const KeyBox& b) {
  return {least(a.min, b.min), greatest(a.max, b.max)};
}

/// The smallest box that holds some keys. @pre there is one
[[nodiscard]] constexpr KeyBox bounds_of(std::span<const VoxelKey> keys) {
  KeyBox box{keys[0], keys[0]};
  for (const VoxelKey& key : keys) box = hull(box, {key, key});
  return box;
}

/// What two boxes have in common; none if that is no voxel.
[[nodiscard]] constexpr std::optional<KeyBox> intersection(const KeyBox& a, const KeyBox& b) {
  const KeyBox box{greatest(a.min, b.min), least(a.max, b.max)};
  if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z) return std::nullopt;
  return box;
}

/// The box and all within so many voxels of it along each axis, cut off at the end of the key range.
[[nodiscard]] constexpr KeyBox grown(const KeyBox& box, int dx, int dy, int dz) {
  const auto down = [](int k, int by) { return std::max(k - by, 0); };
  const auto up = [](int k, int by) { return std::min(k + by, 0xFFFF); };
  return {make_key(down(box.min.x, dx), down(box.min.y, dy), down(box.min.z, dz)),
          make_key(up(box.max.x, dx), up(box.max.y, dy), up(box.max.z, dz))};
}
[[nodiscard]] constexpr KeyBox grown(const KeyBox& box, int by) { return grown(box, by, by, by); }

/// How many voxels a box holds.
[[nodiscard]] constexpr std::uint64_t size_of(const KeyBox& box) {
  const auto along = [](int low, int high) { return static_cast<std::uint64_t>(high - low + 1); };
  return along(box.min.x, box.max.x) * along(box.min.y, box.max.y) * along(box.min.z, box.max.z);
}

/// The place of a voxel among those of a box, in the order of `for_each_key`. @pre box.contains(key)
[[nodiscard]] constexpr std::size_t place_in(const KeyBox& box, const VoxelKey& key) {
  const std::size_t size_x = box.max.x - box.min.x + std::size_t{1};
  const std::size_t size_y = box.max.y - box.min.y + std::size_t{1};
  const std::size_t x = key.x - box.min.x, y = key.y - box.min.y, z = key.z - box.min.z;
  return (z * size_y + y) * size_x + x;
}

/// Whether `holds(key)` for every voxel of a box; stops at the first for which it does not hold.
template <class Holds>
[[nodiscard]] constexpr bool all_of(const KeyBox& box, const Holds& holds) {
  for (int z = box.min.z; z <= box.max.z; ++z)
    for (int y = box.min.y; y <= box.max.y; ++y)
      for (int x = box.min.x; x <= box.max.x; ++x)
        if (!holds(make_key(x, y, z))) return false;
  return true;
}

/// Calls `visit(key)` for every voxel of a box, by z, then y, then x.
template <class Visit>
constexpr void for_each_key(const KeyBox& box, const Visit& visit) {
  static_cast<void>(all_of(box, [&visit](const VoxelKey& key) { return visit(key), true; }));
}

}  // namespace frontlux
