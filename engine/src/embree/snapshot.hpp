#pragma once

#include "parallel/batch.hpp"
#include "embree/blocker_boxes.hpp"
#include "embree/box_scene.hpp"
#include "packet/open_voxels.hpp"

#include <frontlux/ray.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace frontlux::detail {

/// Scenes that no query looks at any more, to be brought up to date instead of built anew.
class SpareScenes {
 public:
  explicit SpareScenes(std::shared_ptr<BoxSceneDevice> device) : device_(std::move(device)) {}

  [[nodiscard]] std::unique_ptr<BoxScene> take() {
    const std::lock_guard lock(mutex_);
    if (scenes_.empty()) return std::make_unique<BoxScene>(device_);
    auto scene = std::move(scenes_.back());
    scenes_.pop_back();
    return scene;
  }
  void give_back(std::unique_ptr<BoxScene> scene) {
    const std::lock_guard lock(mutex_);
    if (scenes_.empty()) scenes_.push_back(std::move(scene));  // one is enough: updates do not overlap
  }

 private:
  std::shared_ptr<BoxSceneDevice> device_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<BoxScene>> scenes_;
};

/// The blockers under one policy: in a list, in a scene, and as what is not open.
class Obstacles {
 public:
  Obstacles(Blockers blockers, std::shared_ptr<SpareScenes> spares, OpenVoxels open)
      : blockers_(std::move(blockers)),
        spares_(std::move(spares)),
        scene_(spares_->take()),
        open_(std::move(open)) {
    scene_->follow(blockers_);
  }
  ~Obstacles() { spares_->give_back(std::move(scene_)); }
  Obstacles(const Obstacles&) = delete;
  Obstacles& operator=(const Obstacles&) = delete;

  [[nodiscard]] const BoxScene& scene() const { return *scene_; }
  [[nodiscard]] const OpenVoxels& open() const { return open_; }
  [[nodiscard]] const Blockers& blockers() const { return blockers_; }
  [[nodiscard]] const std::shared_ptr<SpareScenes>& spares() const { return spares_; }

 private:
  Blockers blockers_;
  std::shared_ptr<SpareScenes> spares_;
  std::unique_ptr<BoxScene> scene_;
  OpenVoxels open_;
};

/// A map as it was at one moment, ready to be queried.
class Snapshot {
 public:
  Snapshot(const VoxelGrid& grid, const std::shared_ptr<BoxSceneDevice>& device) : grid_(grid) {
    for_both_policies([&](std::size_t i, UnknownPolicy unknown) {
      obstacles_[i].emplace(make_blockers(grid_, unknown), std::make_shared<SpareScenes>(device),
                            OpenVoxels(grid_, unknown));
    });
  }

  Snapshot(const VoxelGrid& grid, const Snapshot& before) : grid_(grid) {
    for_both_policies([&](std::size_t i, UnknownPolicy unknown) {
      const Obstacles& old = *before.obstacles_[i];
      obstacles_[i].emplace(follow_blockers(old.blockers(), before.grid_, grid_, unknown), old.spares(),
                            OpenVoxels(grid_, unknown));
    });
  }

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  [[nodiscard]] const BoxScene& scene(UnknownPolicy unknown) const {
    return obstacles_[static_cast<std::size_t>(unknown)]->scene();
  }
  [[nodiscard]] const OpenVoxels& open(UnknownPolicy unknown) const {
    return obstacles_[static_cast<std::size_t>(unknown)]->open();
  }
  /// Beside the grid, and beside what Embree holds.
  [[nodiscard]] std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const auto& obstacles : obstacles_)
      bytes += obstacles->blockers().box_count() * sizeof(PackedBox) + obstacles->open().memory_bytes();
    return bytes;
  }

 private:
  template <class Work>
  static void for_both_policies(const Work& work) {
    for_each_piece(2, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i, static_cast<UnknownPolicy>(i));
    });
  }

  VoxelGrid grid_;
  std::array<std::optional<Obstacles>, 2> obstacles_;  // by UnknownPolicy
};

}  // namespace frontlux::detail
