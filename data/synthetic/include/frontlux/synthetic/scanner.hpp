#pragma once

#include <frontlux/synthetic/scene.hpp>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace frontlux::synthetic {

struct ScanOptions {
  double resolution = 0.1;       ///< [m] of the map
  double max_range = 10.0;       ///< [m] up to which a ray clears and marks voxels
  int rays = 20'000;             ///< per scan, evenly over the sphere
  std::uint64_t seed = 1;        ///< of the turns about z between one scan's rays and the next's
  double beyond_surface = 1e-3;  ///< [m] by which an end point lies inside the solid
};

/// Told after each scan how many are done, and of how many.
using ScanProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Up to `count` places 1.2 m above a floor, at least `spacing` from one another on the same storey and 0.4 m
/// from all solids.
/// @param spacing [m]
/// @return fewer than `count` places where no more were found
[[nodiscard]] std::vector<Eigen::Vector3d> draw_places(const Scene& scene, std::size_t count, double spacing,
                                                       std::uint64_t seed);

/// What a range sensor sees from these places [m], in their order, as OctoMap inserts it with its default
/// sensor model: the tree has its inner nodes updated and is pruned.
/// @tparam Tree  an OcTree, or a ColorOcTree: with a colour for each solid, in the voxels where it was hit
/// @throws std::invalid_argument if an option is not positive, or a place lies within a solid
template <class Tree = octomap::OcTree>
[[nodiscard]] std::unique_ptr<Tree> scan(const Scene& scene, const std::vector<Eigen::Vector3d>& places,
                                         const ScanOptions& options, const ScanProgress& progress = {});

}  // namespace frontlux::synthetic
