#pragma once

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace frontlux::sim {

/// The space that an axis-aligned box passes through on a straight motion, compared at once, not in steps.
class SweptBox {
 public:
  /// @param start the box where the motion begins, not empty
  /// @param motion [m]
  SweptBox(const Eigen::AlignedBox3d& start, const Eigen::Vector3d& motion);

  /// The smallest axis-aligned box around.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// Whether it has a point in common with a triangle, borders included: exact but for rounding.
  [[nodiscard]] bool touches(const std::array<Eigen::Vector3d, 3>& triangle) const;

 private:
  [[nodiscard]] bool apart(const Eigen::Vector3d& axis, const std::array<Eigen::Vector3d, 3>& triangle) const;

  Eigen::Vector3d center_, half_, motion_;
  Eigen::AlignedBox3d bounds_;
};

/// A bounding volume hierarchy of a mesh's triangles.
class TriangleBvh {
 public:
  /// Copies the mesh. @throws std::invalid_argument as `check(mesh)`
  explicit TriangleBvh(const TriangleMesh& mesh);

  /// Number of triangles that a box touches on its motion.
  [[nodiscard]] std::uint64_t count(const SweptBox& box) const;

 private:
  // In depth-first order: the first child of a node comes right after it.
  struct Node {
    Eigen::AlignedBox3d bounds;
    std::uint32_t begin = 0, end = 0;  // of its triangles, in `order_`
    std::uint32_t second = 0;          // its second child; 0: it has none
  };

  std::uint32_t grow(std::uint32_t begin, std::uint32_t end);

  TriangleMesh mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace frontlux::sim
