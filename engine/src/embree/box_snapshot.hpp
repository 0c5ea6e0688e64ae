#pragma once

#include "embree/blocker_boxes.hpp"
#include "embree/box_scene.hpp"
#include "parallel/by_policy.hpp"
#include "parallel/spare.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <memory>
#include <utility>

namespace frontlux::detail {

/// The blockers under one policy, as a list and in a scene.
class BlockerScene {
 public:
  BlockerScene(Blockers blockers, const std::shared_ptr<BoxSceneDevice>& device,
               std::shared_ptr<Spare<BoxScene>> spare)
      : blockers_(std::move(blockers)), spare_(std::move(spare)), scene_(spare_->take()) {
    if (!scene_) scene_ = std::make_unique<BoxScene>(device);
    scene_->update(blockers_);
  }
  ~BlockerScene() { spare_->give_back(std::move(scene_)); }
  BlockerScene(const BlockerScene&) = delete;
  BlockerScene& operator=(const BlockerScene&) = delete;

  [[nodiscard]] const Blockers& blockers() const { return blockers_; }
  [[nodiscard]] const std::shared_ptr<Spare<BoxScene>>& spare() const { return spare_; }
  [[nodiscard]] const BoxScene& scene() const { return *scene_; }

 private:
  Blockers blockers_;
  std::shared_ptr<Spare<BoxScene>> spare_;
  std::unique_ptr<BoxScene> scene_;
};

/// A map as it was at one moment, with its blockers in scenes.
class BoxSnapshot {
 public:
  /// @throws std::runtime_error if Embree cannot make a device or a scene
  explicit BoxSnapshot(const VoxelGrid& grid)
      : grid_(grid), device_(make_box_scene_device()), scenes_([this](UnknownPolicy unknown) {
          return std::make_unique<BlockerScene>(make_blockers(grid_, unknown), device_,
                                                std::make_shared<Spare<BoxScene>>());
        }) {}

  /// The same as BoxSnapshot(grid), but only what changed since `before` is built.
  BoxSnapshot(const VoxelGrid& grid, const BoxSnapshot& before)
      : grid_(grid), device_(before.device_), scenes_([&](UnknownPolicy unknown) {
          const BlockerScene& old = before.scenes_[unknown];
          return std::make_unique<BlockerScene>(update_blockers(old.blockers(), before.grid_, grid_, unknown),
                                                device_, old.spare());
        }) {}

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  [[nodiscard]] const BoxScene& scene(UnknownPolicy unknown) const { return scenes_[unknown].scene(); }

  /// Bytes beside the grid, with all that Embree holds.
  [[nodiscard]] std::size_t memory_bytes() const {
    std::size_t boxes = 0;
    for (const UnknownPolicy unknown : {UnknownPolicy::kBlock, UnknownPolicy::kPass})
      boxes += scenes_[unknown].blockers().box_count();
    return detail::memory_bytes(*device_) + boxes * sizeof(PackedBox);
  }

 private:
  VoxelGrid grid_;
  std::shared_ptr<BoxSceneDevice> device_;
  ByPolicy<BlockerScene> scenes_;
};

}  // namespace frontlux::detail
