#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace frontlux::synthetic {

/// An axis-aligned solid box, faces included [m].
using Box = Eigen::AlignedBox3d;

/// Solid boxes and the first of them that a ray meets, found through a bounding volume hierarchy.
///
/// The answer is that of testing every box in turn, to the last bit, whatever the shape of the hierarchy.
/// Thread safety: const members may run at the same time.
class BoxSet {
 public:
  struct Hit {
    double distance = 0.0;  ///< [m] from the origin; 0 if that lies inside the box
    std::size_t box = 0;    ///< index into `boxes()`; the lowest, if several are met at the same distance
    friend bool operator==(const Hit&, const Hit&) = default;
  };

  /// @throws std::invalid_argument naming a box that is empty or not finite
  explicit BoxSet(std::vector<Box> boxes);

  /// @param origin     [m]
  /// @param direction  of unit length
  [[nodiscard]] std::optional<Hit> first_hit(const Eigen::Vector3d& origin,
                                             const Eigen::Vector3d& direction) const;

  /// True if a box meets this one, touching faces included.
  [[nodiscard]] bool overlaps(const Box& box) const;

  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }

 private:
  struct Node {
    Box bounds;
    std::uint32_t first = 0;  // leaf: into order_; else the second child, the first being the next node
    std::uint32_t count = 0;  // boxes of a leaf; 0 for an inner node
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace frontlux::synthetic
