#pragma once

#include "packet/open_voxels.hpp"
#include "packet/packet_walk.hpp"
#include "packet/single_walk.hpp"
#include "walk/walk.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace frontlux::detail {

/// Answers the queries for which a walk through the table of open voxels is faster than a BVH: those that lie
/// in the table and are not too long.
class TableQuery {
 public:
  static constexpr std::size_t kMaxBatch = kMaxLines;  ///< most queries in a call

  TableQuery(const VoxelGrid& grid, const OpenVoxels& table, UnknownPolicy unknown,
             const PacketWalk& walk = packet_walk())
      : grid_(grid), table_(table), walk_(table.empty() ? nullptr : &walk), unknown_(unknown) {}

  /// @param left  as many places as queries; gets the indices of those not answered
  /// @return how many they are
  [[nodiscard]] std::size_t cast(std::span<const Ray> rays, std::span<Hit> hits,
                                 std::span<std::uint16_t> left) const;
  [[nodiscard]] std::size_t visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                                    std::span<std::uint16_t> left) const;
  /// Why a ray ends; none if it is not answered.
  /// @param end  gets the centre of the voxel in which it does [m]
  [[nodiscard]] std::optional<RayStop> end_alone(const Ray& ray, Eigen::Vector3f& end) const;

 private:
  // Sets `hit`, unless it returns false: then the ray is not answered.
  [[nodiscard]] bool finish(const Ray& ray, const LoneWalk& walk, Hit& hit) const;
  [[nodiscard]] std::optional<RayEnd> end_after(const Ray& ray, const LoneWalk& walk) const;
  /// Whether a cell, by its key, is one that the table contains.
  [[nodiscard]] bool is_inside(const std::array<int, 3>& cell) const;

  const VoxelGrid& grid_;
  const OpenVoxels& table_;
  const PacketWalk* walk_;  // null: no query is answered
  UnknownPolicy unknown_;
};

}  // namespace frontlux::detail
