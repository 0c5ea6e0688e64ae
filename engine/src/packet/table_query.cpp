#include "packet/table_query.hpp"

#include "walk/ray_end.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace frontlux::detail {
namespace {

constexpr int kLongSegment = 1000;  // voxels along the longest axis
static_assert(kLongSegment <= PacketWalk::kMaxOffset);

// A ray that starts in an open voxel of the table.
struct Entrance {
  VoxelKey key;  // of the origin
  Eigen::Vector3f direction;
  Crossings<double> line;
  std::uint32_t index, flip;  // as PacketLines has them
};

std::optional<Entrance> enter(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto key = lattice.key(ray.origin);
  if (!key || !table.contains(*key)) return std::nullopt;
  const OpenVoxels::Layout& layout = table.layout();
  const std::uint32_t index = layout.index(*key);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return std::nullopt;
  Entrance e{*key, direction, crossings_of(lattice, ray.origin, *key, direction), 0, 0};
  for (std::size_t a = 0; a < 3; ++a) e.flip |= e.line.step[a] < 0 ? layout.bits[a] : 0U;
  e.index = index ^ e.flip;
  return e;
}

// One ray's walk, in castRay's own times. Neither step nor look-up branches on which axis is next, and where
// there are vector registers times stay in them.
std::uint32_t walk_alone(const OpenVoxels& table, const Entrance& ray, double length) {
  const auto& bits = table.layout().bits;
  const std::array<std::uint32_t, 4> axis_of = {bits[2], bits[2], bits[1], bits[0]};  // by x_before_y, not_z
  std::uint32_t index = ray.index;
  const auto& t = ray.line.t_max;
  const auto& d = ray.line.t_delta;
#ifdef __SSE2__
  __m128d tx = _mm_set_sd(t[0]), ty = _mm_set_sd(t[1]), tz = _mm_set_sd(t[2]);
  const __m128d dx = _mm_set_sd(d[0]), dy = _mm_set_sd(d[1]), dz = _mm_set_sd(d[2]), end = _mm_set_sd(length);
#else
  double tx = t[0], ty = t[1], tz = t[2];
#endif
  while (true) {
#ifdef __SSE2__
    const __m128d x_before_y = _mm_cmplt_sd(tx, ty), first = _mm_min_sd(tx, ty),
                  not_z = _mm_cmplt_sd(first, tz);
    if (_mm_comigt_sd(_mm_min_sd(first, tz), end) != 0) return kWentThrough;
    tx = _mm_add_sd(tx, _mm_and_pd(_mm_and_pd(not_z, x_before_y), dx));
    ty = _mm_add_sd(ty, _mm_and_pd(_mm_andnot_pd(x_before_y, not_z), dy));
    tz = _mm_add_sd(tz, _mm_andnot_pd(not_z, dz));
    const auto choice = static_cast<std::size_t>(_mm_movemask_pd(_mm_unpacklo_pd(x_before_y, not_z)));
#else
    const bool x_before_y = tx < ty;
    const double first = x_before_y ? tx : ty;
    const bool not_z = first < tz;
    if ((not_z ? first : tz) > length) return kWentThrough;
    tx += not_z && x_before_y ? d[0] : 0.0;
    ty += not_z && !x_before_y ? d[1] : 0.0;
    tz += not_z ? 0.0 : d[2];
    const std::size_t choice = (x_before_y ? 1U : 0U) | (not_z ? 2U : 0U);
#endif
    const std::uint32_t axis = axis_of[choice];
    index = (((index | ~axis) + 1) & axis) | (index & ~axis);
    if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
  }
}

}  // namespace

bool TableQuery::walks(const KeySegment& s) const {
  const int x = std::abs(s.to.x - s.from.x), y = std::abs(s.to.y - s.from.y), z = std::abs(s.to.z - s.from.z);
  return table_.contains(s.from) && table_.contains(s.to) && std::max({x, y, z}) <= kLongSegment &&
         x + y + z > 0;
}

std::size_t TableQuery::visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                                std::span<std::uint16_t> left) const {
  if (walk_ == nullptr) {
    std::iota(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(segments.size()), std::uint16_t{0});
    return segments.size();
  }
  std::size_t left_size = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    left[left_size] = static_cast<std::uint16_t>(i);
    left_size += walks(segments[i]) ? 0 : 1;
  }
  if (left_size == 0) {
    walk_->segments(table_, segments.data(), segments.size(), visible.data());
    return 0;
  }
  std::array<KeySegment, kMaxBatch> ours;
  std::array<std::uint16_t, kMaxBatch> index;
  std::array<std::uint8_t, kMaxBatch> seen;
  std::size_t size = 0;
  for (std::size_t i = 0, next = 0; i < segments.size(); ++i) {
    if (next < left_size && left[next] == i) {
      ++next;
      continue;
    }
    ours[size] = segments[i];
    index[size++] = static_cast<std::uint16_t>(i);
  }
  walk_->segments(table_, ours.data(), size, seen.data());
  for (std::size_t i = 0; i < size; ++i) visible[index[i]] = seen[i];
  return left_size;
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
    if (stopped_at < kFirstRayEnd && batch.in_range[i] != 0 && is_inside(cell)) {
      const VoxelKey key = as_key(cell);
      const Occupancy state = unknown_ == UnknownPolicy::kPass ? Occupancy::kOccupied : grid_.at(key);
      const auto end = per_axis(batch.end), entry = per_axis(batch.entry);
      hits[i] = {stop_in(state), state, key, {end[0], end[1], end[2]}, {entry[0], entry[1], entry[2]},
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
  const auto entrance = enter(grid_.lattice(), table_, ray);
  if (!entrance) return std::nullopt;
  const double length = walked_length(ray.max_range, grid_.resolution());
  return finish(ray, entrance->key, entrance->direction, walk_alone(table_, *entrance, length));
}

// None if the walk ended before the ray did.
std::optional<Hit> TableQuery::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                                      std::uint32_t stopped_at) const {
  if (stopped_at == kWentThrough) {
    if (!is_walked_whole(ray.max_range, grid_.resolution())) return std::nullopt;
    return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  }
  const std::array<int, 3> cell = table_.layout().key(stopped_at);
  if (is_inside(cell)) return end_ray(grid_, ray, start, direction, unknown_, as_key(cell));
  // The border stops every walk, but its voxels are unknown ones like others: under kPass they do not block.
  if (unknown_ == UnknownPolicy::kPass)
    return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  if (as_array(as_key(cell)) != cell) return walk_ray(grid_, ray, unknown_);  // outside the key range
  return end_ray(grid_, ray, start, direction, unknown_, as_key(cell));
}

bool TableQuery::is_inside(const std::array<int, 3>& cell) const {
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a)
    inside &= cell[a] >= table_.bounds_min(a) && cell[a] <= table_.bounds_max(a);
  return inside;
}

}  // namespace frontlux::detail
