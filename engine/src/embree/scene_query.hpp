#pragma once

#include "embree/box_scene.hpp"
#include "embree/box_snapshot.hpp"

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <span>

namespace frontlux::detail {

/// Answers queries about one map under one policy: by the scene where its answer is sure, else by the walk.
class SceneQuery {
 public:
  SceneQuery(const BoxSnapshot& snapshot, UnknownPolicy unknown)
      : grid_(snapshot.grid()),
        lattice_(grid_.lattice()),
        scene_(snapshot.scene(unknown)),
        unknown_(unknown) {
    reach_ = scene_.bounds();
    if (!reach_.isEmpty()) {
      reach_.min().array() -= 1.0;
      reach_.max().array() += 1.0;
    }
  }

  void cast(std::span<const Ray> rays, std::span<Hit> hits) const;
  template <class Segment>
  void visible(std::span<const Segment> segments, std::span<std::uint8_t> visible) const;

 private:
  struct Line {  // a ray in the scene's frame, in double precision
    Eigen::Array3d origin, direction;
  };

  [[nodiscard]] Line line_of(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    const VoxelKey& base = scene_.origin();
    const Eigen::Array3d shift = Eigen::Array3d(base.x, base.y, base.z) - Lattice::kOrigin;
    return {origin.cast<double>().array() / lattice_.resolution() - shift, direction.cast<double>().array()};
  }

  [[nodiscard]] std::optional<Probe> probe(const Line& line, double t_far) const;
  [[nodiscard]] std::optional<VoxelKey> entered_voxel(const Line& line, const KeyBox& box) const;
  void finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
              const std::optional<KeyBox>& box, Hit& hit) const;

  // Marks the segments whose last voxel before the target blocks.
  void hide_behind_last(std::span<const KeySegment> segments, std::span<bool> hidden) const;
  // What answers a segment.
  enum class By : std::uint8_t { kHidden, kVisible, kProbe, kWalk };
  // Sets the probe in place, since a copy would have to wait for it, and whether it enters the target's voxel
  // so close to an edge that it may pass another one, which was not looked at.
  [[nodiscard]] By prepare(const KeySegment& segment, Probe& sight, bool& target_is_grazed) const;
  [[nodiscard]] By prepare(const Segment& segment, Probe& sight, bool& target_is_grazed) const;

  const VoxelGrid& grid_;
  const Lattice& lattice_;
  const BoxScene& scene_;
  UnknownPolicy unknown_;
  Eigen::AlignedBox3d reach_;  // where the scene's tolerance holds for a probe's origin; empty without boxes
};

}  // namespace frontlux::detail
