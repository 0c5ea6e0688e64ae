#pragma once

#include "packet/open_voxels.hpp"
#include "packet/packet_walk.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frontlux::detail {

/// Answers the queries for which a walk through the table of open voxels is faster than a BVH: those that lie
/// in the table and are not too long.
class TableQuery {
 public:
  static constexpr std::size_t kMaxBatch = kMaxLines;  ///< most queries in a call

  TableQuery(const VoxelGrid& grid, const OpenVoxels& table, UnknownPolicy unknown,
             const PacketWalk& walk = packet_walk())
      : grid_(grid),
        table_(table),
        walk_(table.empty() ? nullptr : &walk),
        unknown_(unknown),
        ends_in_(unknown == UnknownPolicy::kBlock
                     ? intersection(grown(table.bounds(), 8), table.window()).value_or(table.bounds())
                     : table.bounds()) {}

  /// @param left  as many places as queries; gets the indices of those not answered
  /// @return how many they are
  std::size_t cast(std::span<const Ray> rays, std::span<Hit> hits, std::span<std::uint16_t> left) const;
  std::size_t visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                      std::span<std::uint16_t> left) const;

 private:
  // Each sets `hit`, unless it returns false: then the ray is not answered.
  [[nodiscard]] bool cast_alone(const Ray& ray, Hit& hit) const;
  [[nodiscard]] bool finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                            std::uint32_t stopped_at, Hit& hit) const;
  /// Whether a cell, by its key, is one that the table contains.
  [[nodiscard]] bool is_inside(const std::array<int, 3>& cell) const;

  const VoxelGrid& grid_;
  const OpenVoxels& table_;
  const PacketWalk* walk_;  // null: no query is answered
  UnknownPolicy unknown_;
  KeyBox ends_in_;  // a segment may end in the border if this stops it as the unknown voxels there do
};

}  // namespace frontlux::detail
