#include "paths/random_path.hpp"

#include "random.hpp"

#include <cmath>
#include <numbers>

namespace frontlux::bench {
namespace {

constexpr int kStarts = 10'000;
constexpr int kTurns = 24;  // directions tried at each step

class Walk {
 public:
  Walk(const VoxelGrid& grid, const KeyBox& box, std::uint64_t seed, const RandomPathOptions& options)
      : grid_(grid), box_(box), seed_(seed), options_(options) {}

  std::optional<std::vector<planner::Pose>> try_once() {
    const Lattice& lattice = grid_.lattice();
    const auto along = [&](std::uint16_t low, std::uint16_t high) {
      return lattice.center(low) + draw() * (lattice.center(high) - lattice.center(low));
    };
    planner::Pose pose;
    pose.position = {along(box_.min.x, box_.max.x), along(box_.min.y, box_.max.y),
                     along(box_.min.z, box_.max.z)};
    if (!is_clear(pose.position)) return std::nullopt;
    pose.yaw = (2.0 * draw() - 1.0) * std::numbers::pi;
    std::vector<planner::Pose> path{pose};
    while (path.size() < options_.viewpoints)
      if (!step(path)) return std::nullopt;
    path.back().yaw = path[path.size() - 2].yaw;
    return path;
  }

 private:
  double draw() { return uniform(seed_, drawn_++); }

  // Sets the yaw of the last viewpoint to where the next one lies, and adds that.
  bool step(std::vector<planner::Pose>& path) {
    for (int turn = 0; turn < kTurns; ++turn) {
      const double spread = 0.5 + turn * (std::numbers::pi - 0.5) / (kTurns - 1);
      const double yaw = path.back().yaw + (2.0 * draw() - 1.0) * spread;
      const double climb = (2.0 * draw() - 1.0) * 0.2;
      const Eigen::Vector3d ahead(std::cos(climb) * std::cos(yaw), std::cos(climb) * std::sin(yaw),
                                  std::sin(climb));
      if (!is_clear_along(path.back().position, ahead)) continue;
      path.back().yaw = std::remainder(yaw, 2.0 * std::numbers::pi);
      path.push_back({path.back().position + options_.spacing * ahead, path.back().yaw});
      return true;
    }
    return false;
  }

  [[nodiscard]] bool is_clear_along(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    const int parts = static_cast<int>(std::ceil(options_.spacing / (grid_.resolution() / 2)));
    for (int i = 1; i <= parts; ++i)
      if (!is_clear(from + options_.spacing * i / parts * direction)) return false;
    return true;
  }

  [[nodiscard]] bool is_clear(const Eigen::Vector3d& center) const {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(options_.clearance / 2);
    const auto min = grid_.lattice().key(Eigen::Vector3f((center - half).cast<float>()));
    const auto max = grid_.lattice().key(Eigen::Vector3f((center + half).cast<float>()));
    const auto is_free = [&](const VoxelKey& key) { return grid_.at(key) == Occupancy::kFree; };
    return min && max && all_of(KeyBox{*min, *max}, is_free);
  }

  const VoxelGrid& grid_;
  KeyBox box_;
  std::uint64_t seed_, drawn_ = 0;
  RandomPathOptions options_;
};

}  // namespace

std::optional<std::vector<planner::Pose>> random_path(const VoxelGrid& grid, std::uint64_t seed,
                                                      const RandomPathOptions& options) {
  const auto box = grid.known_bounds();
  if (!box) return std::nullopt;
  Walk walk(grid, *box, seed, options);
  for (int start = 0; start < kStarts; ++start)
    if (auto path = walk.try_once()) return path;
  return std::nullopt;
}

}  // namespace frontlux::bench
