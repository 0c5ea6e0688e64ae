#pragma once

#include <frontlux/export.hpp>
#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <optional>

namespace frontlux {

/// The voxel lattice of an OctoMap of one resolution: keys from points and points from keys, in OctoMap's own
/// arithmetic, so that both agree to the last bit (ray contract, rule 1).
class FRONTLUX_EXPORT Lattice {
 public:
  static constexpr int kOrigin = 32768;  ///< key of the voxel whose lower face lies at 0
  /// Keys on an axis: from 0 to one less.
  static constexpr int kKeysPerAxis = 65536;

  /// @param resolution edge length of a voxel [m]
  /// @throws std::invalid_argument unless it is finite, positive and has a finite inverse
  explicit Lattice(double resolution);

  /// Edge of a voxel [m].
  [[nodiscard]] double resolution() const { return resolution_; }
  /// 1 / resolution, as OctoMap rounds it: by this it multiplies coordinates.
  [[nodiscard]] double voxels_per_metre() const { return voxels_per_metre_; }

  /// Key along one axis of a coordinate [m]; none outside the key range or if it is not finite.
  [[nodiscard]] std::optional<std::uint16_t> key(double coordinate) const {
    const double cells = voxels_per_metre_ * coordinate;
    if (!(cells >= -kOrigin && cells < kKeysPerAxis - kOrigin)) return std::nullopt;
    // Down, from where a conversion cuts off: std::floor is a call where SSE4.1 may be missing.
    const int toward_0 = static_cast<int>(cells), down = cells < toward_0 ? 1 : 0;
    return static_cast<std::uint16_t>(toward_0 - down + kOrigin);
  }

  /// Key of the voxel that holds a point [m], of floats or doubles. Cells are half-open: a point on a face
  /// belongs to the upper one.
  template <class Point>
  [[nodiscard]] std::optional<VoxelKey> key(const Eigen::MatrixBase<Point>& point) const {
    const auto x = key(static_cast<double>(point.x())), y = key(static_cast<double>(point.y())),
               z = key(static_cast<double>(point.z()));
    if (!x || !y || !z) return std::nullopt;
    return VoxelKey{*x, *y, *z};
  }

  /// Centre along one axis [m].
  [[nodiscard]] double center(std::uint16_t key) const {
    return (static_cast<double>(static_cast<int>(key) - kOrigin) + 0.5) * resolution_;
  }

  /// Centre of a voxel [m], not rounded to float as OctoMap's is.
  [[nodiscard]] Eigen::Vector3d exact_center(const VoxelKey& key) const {
    return {center(key.x), center(key.y), center(key.z)};
  }

  /// Centre of a voxel [m].
  [[nodiscard]] Eigen::Vector3f center(const VoxelKey& key) const {
    return {static_cast<float>(center(key.x)), static_cast<float>(center(key.y)),
            static_cast<float>(center(key.z))};
  }

 private:
  double resolution_;
  double voxels_per_metre_;
};

}  // namespace frontlux
