#pragma once

#include "octomap/quiet_octomap.hpp"

namespace frontlux::detail {

/// The castRay of this tree as compiled here, inlined, with this project's flags. castRay is virtual: called
/// by its name alone, what answers is whatever the class's table holds, which is the copy in OctoMap's
/// library. Debian's checks assertions and prints what leaves the key range. Each file has one of its own:
/// the linker could choose one that was compiled with other flags.
template <class Tree>
[[gnu::flatten]] static bool own_castray(const Tree& tree, const octomap::point3d& origin,
                                         const octomap::point3d& direction, octomap::point3d& end,
                                         bool ignore_unknown, double max_range) {
  return tree.Tree::castRay(origin, direction, end, ignore_unknown, max_range);
}

}  // namespace frontlux::detail
