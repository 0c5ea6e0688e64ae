#pragma once

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

namespace frontlux::sim {

/// The triangles of a world, ready to be hit by rays. Both sides count, and no ray slips between triangles
/// that share an edge or a corner. Ranges are computed in double precision from the vertices as they are.
///
/// Thread safety: `cast` from any number of threads.
class Surface {
 public:
  /// A half line, cut off at a range, in the world frame.
  struct Ray {
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();            ///< [m]
    Eigen::Vector3f direction = Eigen::Vector3f::UnitX();        ///< of any length but zero
    double max_range = std::numeric_limits<double>::infinity();  ///< [m] not negative
  };

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// The first point of the surface on a ray.
  struct Hit {
    double range =
        std::numeric_limits<double>::infinity();  ///< [m] from the origin; infinity: nothing is hit
    std::uint32_t triangle = kNone;               ///< its number in the mesh
  };

  /// Copies what it needs of the mesh. A mesh without triangles is hit by nothing.
  /// @throws std::invalid_argument naming the vertex or triangle, if a coordinate is not finite or beyond 1e9
  /// m, or an index has no vertex
  /// @throws std::runtime_error if Embree cannot work here
  explicit Surface(const TriangleMesh& mesh);
  ~Surface();
  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;

  /// hits[i] belongs to rays[i]: the nearest hit with range <= max_range; of several at the same range, the
  /// triangle of the smallest number. Long batches are divided among the threads of TBB's current arena.
  /// @throws std::invalid_argument if the sizes differ, or naming a ray whose origin or direction is not
  /// finite, whose direction has no length, or whose max_range is negative or NaN
  void cast(std::span<const Ray> rays, std::span<Hit> hits) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace frontlux::sim
