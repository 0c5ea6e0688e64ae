#pragma once

#include "view/exact/window_layout.hpp"

#include <frontlux/view_region.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::detail {

/// The rays from a voxel to all offsets in view, each as the voxels that `RayCaster::visible` crosses, as a
/// prefix trie: rays that begin with the same voxels share nodes. The ray to an offset is the same from
/// everywhere, so one walk over the trie answers for any number of viewpoints (trie_walk.hpp).
///
/// The horizon is divided into sectors, with one trie for each, since visible targets are counted by sector.
/// Nodes are listed depth first: a walk that leaves out what lies behind a node goes on at a later node.
/// Places are those of a layout.
class RayTrie {
 public:
  /// A piece of a ray without a fork, and perhaps an offset in view at its end.
  struct Node {
    static constexpr std::size_t kSteps = 4;
    std::array<std::int32_t, kSteps>
        steps;            ///< places that have to be free; the last one is repeated if they are fewer
    std::int32_t target;  ///< place of the offset at its end; any place if `is_target` is 0
    std::uint32_t end;    ///< first node that is not behind this one
    std::uint32_t group;  ///< the group that begins with this node, counted from 1 in its sector; 0: none
    std::uint16_t depth;  ///< nodes before it
    std::uint8_t is_target;
    std::uint8_t is_fork;  ///< so many nodes lie behind it that a walk checks whether it can leave them out
  };
  static_assert(sizeof(Node) == 32);

  /// Targets in one part of the trie, which need not be walked if none of them is there.
  struct Group {
    std::uint32_t begin = 0, end = 0;  ///< of `targets()`
  };
  struct Sector {
    int bin = 0;                                   ///< of azimuth
    std::uint32_t nodes_begin = 0, nodes_end = 0;  ///< the trie
    /// The first group has the targets that belong to no other.
    std::uint32_t groups_begin = 0, groups_end = 0;
    /// Number of its first targets that are next to the viewpoint: they have no node.
    std::uint32_t adjacent = 0;
  };

  /// The trie of a field of view; nothing if the rays are too many.
  /// @param azimuth_bins  sectors, at least 1
  static std::optional<RayTrie> make(const ViewRegion& view, int azimuth_bins, int stride_x, int stride_y);

  [[nodiscard]] const WindowLayout& layout() const { return layout_; }
  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const Group> groups() const { return groups_; }
  /// Places of all offsets in view, once each.
  [[nodiscard]] std::span<const std::int32_t> targets() const { return targets_; }
  [[nodiscard]] std::span<const Sector> sectors() const { return sectors_; }
  /// Of a sector.
  [[nodiscard]] std::size_t most_groups() const { return most_groups_; }
  /// Nodes of the longest ray.
  [[nodiscard]] std::size_t depth() const { return depth_; }

 private:
  friend class RayTrieBuilder;
  void append(const RayTrie& sector);

  WindowLayout layout_;
  std::vector<Node> nodes_;
  std::vector<Group> groups_;
  std::vector<std::int32_t> targets_;
  std::vector<Sector> sectors_;
  std::size_t most_groups_ = 0, depth_ = 0;
};

}  // namespace frontlux::detail
