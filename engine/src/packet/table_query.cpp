#include "packet/table_query.hpp"

#include "walk/end_ray.hpp"

#include <frontlux/key_box.hpp>

#include <array>
#include <numeric>
#include <optional>

namespace frontlux::detail {
std::size_t TableQuery::visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                                std::span<std::uint16_t> left) const {
  if (walk_ != nullptr) {
    // A segment may end in the border if this stops it as the unknown voxels there do.
    const KeyBox& known = table_.bounds();
    const KeyBox ends_in = unknown_ == UnknownPolicy::kBlock
                               ? intersection(grown(known, 8), table_.window()).value_or(known)
                               : known;
    return walk_->segments(table_, ends_in, segments, visible.data(), left.data());
  }
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
  if (walk_ == nullptr) {
    for (std::size_t i = 0; i < rays.size(); ++i) leave_unless(false, i);
    return left_size;
  }
  const auto finish_alone = [&](std::size_t i) {
    leave_unless(finish(rays[i], walk_->alone(grid_.lattice(), table_, rays[i]), hits[i]), i);
  };
  if (rays.size() < kWorthAPacket) {
    for (std::size_t i = 0; i < rays.size(); ++i) finish_alone(i);
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
      finish_alone(i);
    } else if (stopped_at == kNeverStarted) {
      leave_unless(false, i);
    } else {
      const auto d = per_axis(batch.direction);
      const VoxelKey start = *grid_.lattice().key(rays[i].origin);
      leave_unless(finish(rays[i], {stopped_at, start, {d[0], d[1], d[2]}}, hits[i]), i);
    }
  }
  return left_size;
}

std::optional<RayStop> TableQuery::end_alone(const Ray& ray, Eigen::Vector3f& end) const {
  if (walk_ == nullptr) return std::nullopt;
  const Lattice& lattice = grid_.lattice();
  const LoneWalk walk = walk_->alone(lattice, table_, ray);
  // Most rays, without what takes longer than they: a key is written in parts and read as a whole.
  if (unknown_ == UnknownPolicy::kPass && walk.stopped_at < kFirstWalkEnd) {
    const std::array<int, 3> cell = table_.layout().key(walk.stopped_at);
    if (is_inside(cell)) {
      const Eigen::Vector3f center = lattice.center(as_key(cell));
      if (is_surely_in_range(ray, center)) {
        end = center;
        return RayStop::kOccupied;
      }
    }
  }
  const auto found = end_after(ray, walk);
  if (!found) return std::nullopt;
  end = lattice.center(found->key);
  return found->stop;
}

bool TableQuery::finish(const Ray& ray, const LoneWalk& walk, Hit& hit) const {
  const auto end = end_after(ray, walk);
  if (end) make_hit(grid_, ray, walk.start, walk.direction, *end, hit);
  return end.has_value();
}

// None if the walk never started, ended before the ray did, or went on out of the window.
std::optional<RayEnd> TableQuery::end_after(const Ray& ray, const LoneWalk& walk) const {
  const auto end = [&](const std::optional<VoxelKey>& blocker) {
    return end_of(grid_, ray, walk.start, walk.direction, unknown_, blocker);
  };
  if (walk.stopped_at == kNeverStarted) return std::nullopt;
  if (walk.stopped_at == kWentThrough) {
    if (!is_walked_whole(ray.max_range, grid_.resolution())) return std::nullopt;
    return end(std::nullopt);
  }
  const std::array<int, 3> cell = table_.layout().key(walk.stopped_at);
  const VoxelKey key = as_key(cell);
  if (is_inside(cell)) return end(key);
  const bool in_key_range = as_array(key) == cell;
  if (in_key_range && !table_.window().contains(key)) return std::nullopt;
  // The border stops every walk, but its voxels are unknown ones like others: under kPass they do not block.
  if (unknown_ == UnknownPolicy::kPass) return end(std::nullopt);
  if (in_key_range) return end(key);
  const Hit hit = walk_ray(grid_, ray, unknown_);
  return RayEnd{hit.stop, hit.key};
}

bool TableQuery::is_inside(const std::array<int, 3>& cell) const {
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a)
    inside &= cell[a] >= table_.bounds_min(a) && cell[a] <= table_.bounds_max(a);
  return inside;
}

}  // namespace frontlux::detail
