#include "packet/table_query.hpp"

#include "packet/single_walk.hpp"
#include "walk/end_ray.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace frontlux::detail {
std::size_t TableQuery::visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                                std::span<std::uint16_t> left) const {
  if (walk_ != nullptr) return walk_->segments(table_, ends_in_, segments, visible.data(), left.data());
  std::iota(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(segments.size()), std::uint16_t{0});
  return segments.size();
}

std::size_t TableQuery::cast(std::span<const Ray> rays, std::span<Hit> hits,
                             std::span<std::uint16_t> left) const {
  std::size_t left_size = 0;
  const auto leave_unless = [&](bool answered, std::size_t i) {
    if (!answered) left[left_size++] = static_cast<std::uint16_t>(i);
  };
  constexpr std::size_t kWorthAPacket = 3;
  if (walk_ == nullptr || rays.size() < kWorthAPacket) {
    for (std::size_t i = 0; i < rays.size(); ++i) leave_unless(cast_alone(rays[i], hits[i]), i);
    return left_size;
  }
  RayBatch batch;
  walk_->rays(grid_.lattice(), table_, rays, batch);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t stopped_at = batch.stopped_at[i];
    const auto per_axis = [i](const auto& values) {
      return std::array{values[0][i], values[1][i], values[2][i]};
    };
    const std::array<int, 3> cell = per_axis(batch.cell);
    const bool is_free = stopped_at == kFreeEnd;
    if (is_free || (stopped_at < kFirstWalkEnd && batch.in_range[i] == kInRange && is_inside(cell))) {
      const VoxelKey key = as_key(cell);
      const Occupancy state = is_free ? grid_.at(key) : blocker_state(grid_, key, unknown_);
      const auto end = per_axis(batch.end), entry = per_axis(batch.entry);
      hits[i] = {is_free ? RayStop::kOutOfRange : stop_in(state),
                 state,
                 key,
                 {end[0], end[1], end[2]},
                 {entry[0], entry[1], entry[2]},
                 batch.distance[i]};
    } else if (stopped_at == kTooCloseToTell) {
      leave_unless(cast_alone(rays[i], hits[i]), i);
    } else if (stopped_at == kNeverStarted) {
      leave_unless(false, i);
    } else {
      const auto d = per_axis(batch.direction);
      const VoxelKey start = *grid_.lattice().key(rays[i].origin);
      leave_unless(finish(rays[i], start, {d[0], d[1], d[2]}, stopped_at, hits[i]), i);
    }
  }
  return left_size;
}

bool TableQuery::cast_alone(const Ray& ray, Hit& hit) const {
  const auto entered = enter(grid_.lattice(), table_, ray);
  if (!entered) return false;
  const double length = walked_length(ray.max_range, grid_.resolution());
  return finish(ray, entered->key, entered->direction, walk_alone(table_, *entered, length), hit);
}

// Not if the walk ended before the ray did, or went on out of the window.
bool TableQuery::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                        std::uint32_t stopped_at, Hit& hit) const {
  const auto end = [&](const std::optional<VoxelKey>& blocker) {
    end_ray(grid_, ray, start, direction, unknown_, blocker, hit);
    return true;
  };
  if (stopped_at == kWentThrough)
    return is_walked_whole(ray.max_range, grid_.resolution()) && end(std::nullopt);
  const std::array<int, 3> cell = table_.layout().key(stopped_at);
  const VoxelKey key = as_key(cell);
  if (is_inside(cell)) return end(key);
  const bool in_key_range = as_array(key) == cell;
  if (in_key_range && !table_.window().contains(key)) return false;
  // The border stops every walk, but its voxels are unknown ones like others: under kPass they do not block.
  if (unknown_ == UnknownPolicy::kPass) return end(std::nullopt);
  if (in_key_range) return end(key);
  hit = walk_ray(grid_, ray, unknown_);
  return true;
}

bool TableQuery::is_inside(const std::array<int, 3>& cell) const {
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a)
    inside &= cell[a] >= table_.bounds_min(a) && cell[a] <= table_.bounds_max(a);
  return inside;
}

}  // namespace frontlux::detail
