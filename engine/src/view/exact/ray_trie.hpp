#pragma once

#include "view/view_reach.hpp"
#include "view/exact/window_layout.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace frontlux::detail {

/// All paths that `RayCaster::visible` follows from a voxel to the offsets in view, as a tree: paths that
/// begin alike share what they have in common. The path to an offset is the same from everywhere, so one walk
/// over the tree answers for any number of viewpoints (trie_walk.hpp).
///
/// One tree for each sector of the horizon, since what counts is counted by sector. Nodes are listed depth
/// first, so that to leave out what lies behind one is to go on at a later one. Places are those of a layout.
class RayTrie {
 public:
  /// A piece of path without a fork, and perhaps an offset in view that it leads to.
  struct Node {
    static constexpr std::size_t kSteps = 4;
    std::array<std::int32_t, kSteps> steps;  ///< voxels that have to be free; the last fills up
    std::int32_t target;                     ///< place of the offset it leads to; any if `is_target` is 0
    std::uint32_t end;                       ///< first node that is not behind this one
    std::uint32_t group;                     ///< whose root this is; 0: none's
    std::uint16_t depth;                     ///< nodes before it
    std::uint8_t is_target;
    std::uint8_t is_fork;  ///< enough lies behind it to be worth a look before
  };
  static_assert(sizeof(Node) == 32);

  /// Targets in one part of the tree, which need not be walked if none of them is there.
  struct Group {
    std::uint32_t begin = 0, end = 0;  ///< of `targets()`
  };
  struct Sector {
    int bin = 0;                                     ///< of azimuth
    std::uint32_t nodes_begin = 0, nodes_end = 0;    ///< the tree
    std::uint32_t groups_begin = 0, groups_end = 0;  ///< of the first are targets that belong to no other
    std::uint32_t adjacent = 0;  ///< of these the first so many, which no path leads to: nothing lies between
  };

  /// The paths of a field of view; nothing if they are too many for a tree.
  /// @param azimuth_bins  sectors, at least 1
  static std::optional<RayTrie> make(const ViewReach& reach, int azimuth_bins, int stride_x, int stride_y);

  [[nodiscard]] const WindowLayout& layout() const { return layout_; }
  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const Group> groups() const { return groups_; }
  /// Places of all offsets in view, once each.
  [[nodiscard]] std::span<const std::int32_t> targets() const { return targets_; }
  [[nodiscard]] std::span<const Sector> sectors() const { return sectors_; }
  /// Nodes on the longest way from the root.
  [[nodiscard]] std::size_t depth() const { return depth_; }

 private:
  friend class RayTrieBuilder;
  void append(const RayTrie& sector);

  WindowLayout layout_;
  std::vector<Node> nodes_;
  std::vector<Group> groups_;  // 0 is none
  std::vector<std::int32_t> targets_;
  std::vector<Sector> sectors_;
  std::size_t depth_ = 0;
};

}  // namespace frontlux::detail
