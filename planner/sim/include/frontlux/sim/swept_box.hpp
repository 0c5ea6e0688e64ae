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

  /// Number of triangles that a `SweptBox` or a `SweptBody` touches.
  template <class Swept>
  [[nodiscard]] std::uint64_t count(const Swept& swept) const {
    std::uint64_t met = 0;
    for_each_near(swept.bounds(), [&](const std::array<Eigen::Vector3d, 3>& triangle) {
      met += static_cast<std::uint64_t>(swept.touches(triangle));
    });
    return met;
  }

 private:
  // In depth-first order: the first child of a node comes right after it.
  struct Node {
    Eigen::AlignedBox3d bounds;
    std::uint32_t begin = 0, end = 0;  // of its triangles, in `order_`
    std::uint32_t second = 0;          // its second child; 0: it has none
  };

  std::uint32_t grow(std::uint32_t begin, std::uint32_t end);

  // Calls `visit(corners)` for the triangles whose nodes meet a box.
  template <class Visit>
  void for_each_near(const Eigen::AlignedBox3d& box, const Visit& visit) const {
    std::vector<std::uint32_t> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
      const std::uint32_t number = open.back();
      open.pop_back();
      const Node& node = nodes_[number];
      if (!node.bounds.intersects(box)) continue;
      if (node.second != 0) {
        open.push_back(node.second);
        open.push_back(number + 1);
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) visit(corners_of(mesh_, order_[i]));
    }
  }

  TriangleMesh mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace frontlux::sim
