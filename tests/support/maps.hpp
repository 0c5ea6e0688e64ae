#pragma once

#include "octomap/quiet_octomap.hpp"
#include "support/test.hpp"

#include <frontlux/octomap.hpp>

namespace frontlux::test {

/// A map to test on.
struct NamedMap {
  std::string name;
  std::shared_ptr<octomap::OcTree> tree;
};

/// A tree of random leaves of all sizes, some kilometres away, that holds all states and pruned leaves.
std::shared_ptr<octomap::OcTree> make_random_tree(std::uint64_t seed, double resolution);

/// Voxels in a small cube, each free, occupied or unknown with equal chance: as many edges and corners as
/// there can be.
std::shared_ptr<octomap::OcTree> make_noise_tree(std::uint64_t seed, double resolution, int edge);

/// Occupied voxels 512 voxels apart: those that a mirror takes most memory for.
/// @param edge  of the cube of them; at most 120
std::shared_ptr<octomap::OcTree> make_sparse_tree(int edge);

/// All maps in data/maps that hold an OcTree, and random ones.
std::vector<NamedMap> small_maps();

/// The maps in the folder that FRONTLUX_EXTRA_MAPS names; none if it is not set.
std::vector<NamedMap> extra_maps();

/// FRONTLUX_LONG=1 asks for the long mode.
bool long_mode();

}  // namespace frontlux::test
