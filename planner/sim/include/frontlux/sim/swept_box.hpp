#pragma once

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::sim {

/// The space that an axis-aligned box passes through as it moves straight: what it meets there is found at
/// once and not step by step.
class SweptBox {
 public:
  /// @param start where the box begins, not empty  @param way [m] from there on
  SweptBox(const Eigen::AlignedBox3d& start, const Eigen::Vector3d& way);

  /// The smallest axis-aligned box around.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// Whether it has a point in common with a triangle, borders included: exact but for the rounding of
  /// double.
  [[nodiscard]] bool touches(const std::array<Eigen::Vector3d, 3>& triangle) const;

 private:
  [[nodiscard]] bool apart(const Eigen::Vector3d& axis, const std::array<Eigen::Vector3d, 3>& triangle) const;

  Eigen::Vector3d center_, half_, way_;
  Eigen::AlignedBox3d bounds_;
};

/// The triangles of a mesh, sorted so that those near a box are found quickly.
class TriangleTree {
 public:
  /// Copies the mesh. @throws std::invalid_argument naming the vertex or triangle that cannot be
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Number of triangles that a box touches on its way.
  [[nodiscard]] std::uint64_t count(const SweptBox& box) const;

 private:
  // Nodes in the order of a walk from the root; a node's first child follows it.
  struct Node {
    Eigen::AlignedBox3d bounds;
    std::uint32_t begin = 0, end = 0;  // of its triangles, in `order_`
    std::uint32_t second = 0;          // its second child; 0: it has none
  };

  std::uint32_t grow(std::uint32_t begin, std::uint32_t end);
  [[nodiscard]] std::array<Eigen::Vector3d, 3> corners(std::uint32_t triangle) const;

  TriangleMesh mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace frontlux::sim
