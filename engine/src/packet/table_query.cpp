#include "packet/table_query.hpp"

#include "packet/single_walk.hpp"
#include "walk/end_ray.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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
  const auto settle = [&](std::size_t i, const std::optional<Hit>& hit) {
    if (hit)
      hits[i] = *hit;
    else
      left[left_size++] = static_cast<std::uint16_t>(i);
  };
  constexpr std::size_t kWorthAPacket = 3;
  if (walk_ == nullptr || rays.size() < kWorthAPacket) {
    for (std::size_t i = 0; i < rays.size(); ++i) settle(i, cast_alone(rays[i]));
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
    if (stopped_at < kFirstWalkEnd && batch.in_range[i] != 0 && is_inside(cell)) {
      const VoxelKey key = as_key(cell);
      const Occupancy state = unknown_ == UnknownPolicy::kPass ? Occupancy::kOccupied : grid_.at(key);
      const auto end = per_axis(batch.end), entry = per_axis(batch.entry);
      hits[i] = {stop_in(state),   state, key, {end[0], end[1], end[2]}, {entry[0], entry[1], entry[2]},
                 batch.distance[i]};
    } else if (stopped_at == kTooCloseToTell) {
      settle(i, cast_alone(rays[i]));
    } else if (stopped_at == kNeverStarted) {
      settle(i, std::nullopt);
    } else {
      const auto d = per_axis(batch.direction);
      settle(i, finish(rays[i], *grid_.lattice().key(rays[i].origin), {d[0], d[1], d[2]}, stopped_at));
    }
  }
  return left_size;
}

std::optional<Hit> TableQuery::cast_alone(const Ray& ray) const {
  const auto entered = enter(grid_.lattice(), table_, ray);
  if (!entered) return std::nullopt;
  const double length = walked_length(ray.max_range, grid_.resolution());
  return finish(ray, entered->key, entered->direction, walk_alone(table_, *entered, length));
}

// None if the walk ended before the ray did, or went on out of the window.
std::optional<Hit> TableQuery::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                                      std::uint32_t stopped_at) const {
  if (stopped_at == kWentThrough) {
    if (!is_walked_whole(ray.max_range, grid_.resolution())) return std::nullopt;
    return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  }
  const std::array<int, 3> cell = table_.layout().key(stopped_at);
  const VoxelKey key = as_key(cell);
  if (is_inside(cell)) return end_ray(grid_, ray, start, direction, unknown_, key);
  const bool in_key_range = as_array(key) == cell;
  if (in_key_range && !table_.window().contains(key)) return std::nullopt;
  // The border stops every walk, but its voxels are unknown ones like others: under kPass they do not block.
  if (unknown_ == UnknownPolicy::kPass) return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  if (!in_key_range) return walk_ray(grid_, ray, unknown_);
  return end_ray(grid_, ray, start, direction, unknown_, key);
}

bool TableQuery::is_inside(const std::array<int, 3>& cell) const {
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a)
    inside &= cell[a] >= table_.bounds_min(a) && cell[a] <= table_.bounds_max(a);
  return inside;
}

}  // namespace frontlux::detail
