#pragma once

#include <frontlux/voxel_grid.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace frontlux::detail {

/// A piece of a straight line, in a scene's own frame: voxels as the unit of length, origin at
/// `BoxScene::origin()`.
struct Probe {
  float origin[3];
  float t_near;
  float direction[3];  ///< finite, any length but zero
  float t_far;         ///< probes with t_far < t_near meet nothing
};

/// Whether a probe meets a box.
enum class Sight : std::uint8_t {
  kClear,
  kBlocked,
  kTooCloseToTell,  ///< it meets none for sure, but passes within the tolerance of one
};

/// Boxes of voxels in a BVH, in single precision, with its error bounded. Batches must not exceed
/// `kMaxBatch`. This is the seam behind which Embree lives: another version or query mode changes only the
/// .cpp.
class BoxScene {
 public:
  static constexpr std::size_t kMaxBatch = 256;
  static constexpr std::uint32_t kNoBox = 0xFFFFFFFF;

  /// @throws std::runtime_error if Embree cannot make its device or the scene
  explicit BoxScene(std::vector<KeyBox> boxes);
  ~BoxScene();

  [[nodiscard]] bool empty() const { return boxes_.empty(); }

  /// Key of the voxel whose lower corner is the origin of the scene's frame.
  [[nodiscard]] const VoxelKey& origin() const { return origin_; }
  /// The smallest box around all boxes, in the scene's frame.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  /// Bound on the error, as a distance in voxels, of everything computed here for probes whose origins lie
  /// within one voxel of the bounds.
  [[nodiscard]] double tolerance() const { return tolerance_; }

  /// Any box between t_near and t_far?
  void occluded(std::span<const Probe> probes, std::span<Sight> sights) const;

  /// For each probe the index of the box that it enters first, or seems to within the tolerance; or kNoBox.
  void first(std::span<const Probe> probes, std::span<std::uint32_t> boxes) const;

  [[nodiscard]] const KeyBox& box(std::uint32_t index) const { return boxes_[index]; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Embree;

  std::vector<KeyBox> boxes_;
  VoxelKey origin_;
  Eigen::AlignedBox3d bounds_;
  double tolerance_ = 0.0;
  std::unique_ptr<Embree> embree_;
};

}  // namespace frontlux::detail
