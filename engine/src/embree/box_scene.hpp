#pragma once

#include "embree/blocker_boxes.hpp"

#include <frontlux/voxel_grid.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace frontlux::detail {

/// A part of a straight line, in a scene's own frame: lengths in voxels, origin at `BoxScene::origin()`.
struct Probe {
  float origin[3];
  float t_near;
  float direction[3];  ///< finite, any length but zero
  float t_far;         ///< probes with t_far < t_near meet no box
};

/// Whether a probe meets a box.
enum class Sight : std::uint8_t {
  kClear,
  kBlocked,
  kTooClose,  ///< it passes so close to a box, within the tolerance, that rounding may decide
};

/// Embree's device, which all scenes of one caster share.
class BoxSceneDevice;
/// @throws std::runtime_error if Embree cannot make a device
[[nodiscard]] std::shared_ptr<BoxSceneDevice> make_box_scene_device();
/// Bytes that Embree holds for all scenes of a device.
[[nodiscard]] std::size_t memory_bytes(const BoxSceneDevice& device);

/// Boxes of voxels in a BVH, in single precision, with a bounded error. Embree is asked in
/// `embree_query.hpp`.
///
/// Thread safety: const members may run at the same time as each other, not as `update`.
class BoxScene {
 public:
  static constexpr std::size_t kMaxBatch = 256;  ///< most probes in a call

  explicit BoxScene(std::shared_ptr<BoxSceneDevice> device);
  ~BoxScene();
  BoxScene(const BoxScene&) = delete;
  BoxScene& operator=(const BoxScene&) = delete;

  /// Makes the scene hold these boxes, and no others. Groups that it holds already are free.
  /// @throws std::runtime_error if Embree cannot build the scene
  void update(const Blockers& blockers);

  /// Key of the voxel whose lower corner is the origin of the scene's frame.
  [[nodiscard]] const VoxelKey& origin() const { return origin_; }
  /// The smallest box around all boxes, in the scene's frame; empty if there are none.
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  /// Bound on the error, as a distance in voxels, of everything computed here for probes whose origins lie
  /// within one voxel of the bounds.
  [[nodiscard]] double tolerance() const { return tolerance_; }

  /// Any box between t_near and t_far?
  void occluded(std::span<const Probe> probes, std::span<Sight> sights) const;

  /// For each probe the box that it enters first, or seems to within the tolerance.
  void first(std::span<const Probe> probes, std::span<std::optional<KeyBox>> boxes) const;

 private:
  struct Embree;

  VoxelKey origin_;
  Eigen::AlignedBox3d bounds_;
  static constexpr double kLeastTolerance = 1e-4;  // castRay's own rounding is below
  double reach_ = 0.0;                             // largest coordinate that the tolerance allows for
  double tolerance_ = kLeastTolerance;
  std::unique_ptr<Embree> embree_;
};

}  // namespace frontlux::detail
