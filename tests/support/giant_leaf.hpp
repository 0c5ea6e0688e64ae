#pragma once

#include "support/test.hpp"

namespace frontlux::test {

inline constexpr unsigned kFreeLeaf = 0x0001, kOccupiedLeaf = 0x0002;

/// A .bt map of two leaves: a block at the origin, of 2^(16 - depth) voxels a side, and a free voxel at its
/// corner.
inline std::string giant_leaf(unsigned depth, unsigned block = kFreeLeaf) {
  std::string data;
  const auto nodes = [&](unsigned count, unsigned children) {
    for (; count > 0; --count)
      data.append({static_cast<char>(children & 0xFFU), static_cast<char>(children >> 8U)});
  };
  nodes(1, 0xC003);
  nodes(14, 0xC000);
  nodes(1, 0x4000);
  nodes(depth - 2, 0x0003);
  nodes(1, block);
  std::string map = "# Octomap OcTree binary file\nid OcTree\nsize ";
  return map.append(std::to_string(depth + 17)).append("\nres 0.1\ndata\n").append(data);
}

}  // namespace frontlux::test
