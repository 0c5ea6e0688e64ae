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

// Where a BVH becomes about as fast as the walk (docs/benchmarking.md).
constexpr int kLongSegment = 1000;  // voxels along the longest axis
constexpr double kLongRay = 400.0;  // [voxels]
static_assert(kLongSegment <= PacketWalk::kMaxOffset);

// A ray that starts in an open voxel of the table.
struct Entrance {
  VoxelKey key;  // of the origin
  Eigen::Vector3f direction;
  Crossings<double> line;
  std::uint32_t index, flip;  // as PacketLines has them
  double end;
  bool whole;  // the walk goes as far as the ray may
};

std::optional<Entrance> enter(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto key = lattice.key(ray.origin);
  if (!key || !table.contains(*key)) return std::nullopt;
  const OpenVoxels::Layout& layout = table.layout();
  const std::uint32_t index = layout.index(*key);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return std::nullopt;
  Entrance e{*key, direction, crossings_of(lattice, ray.origin, *key, direction), 0, 0, 0.0, false};
  for (std::size_t a = 0; a < 3; ++a) e.flip |= e.line.step[a] < 0 ? layout.bits[a] : 0U;
  e.index = index ^ e.flip;
  // A voxel in range is entered before its centre's distance plus half a diagonal.
  const double resolution = lattice.resolution(), longest = kLongRay * resolution;
  e.whole = ray.max_range > 0.0 && ray.max_range + resolution <= longest;
  e.end = e.whole ? ray.max_range + resolution : longest;
  return e;
}

#ifdef __SSE2__
// The walk of a packet, for one ray, where a packet would have one lane in use. Neither step nor look-up
// branches on which axis is next, and times stay in vector registers.
std::uint32_t walk_alone(const OpenVoxels& table, const Entrance& ray) {
  const auto& bits = table.layout().bits;
  const auto load = [](double t) { return _mm_set_sd(t); };
  __m128d tx = load(ray.line.t_max[0]), ty = load(ray.line.t_max[1]), tz = load(ray.line.t_max[2]);
  const __m128d dx = load(ray.line.t_delta[0]), dy = load(ray.line.t_delta[1]),
                dz = load(ray.line.t_delta[2]);
  const __m128d end = load(ray.end);
  const std::array<std::uint32_t, 4> axis_of = {bits[2], bits[2], bits[1], bits[0]};  // by x_before_y, not_z
  std::uint32_t index = ray.index;
  while (true) {
    const __m128d x_before_y = _mm_cmplt_sd(tx, ty), first = _mm_min_sd(tx, ty),
                  not_z = _mm_cmplt_sd(first, tz);
    if (_mm_comigt_sd(_mm_min_sd(first, tz), end) != 0) return PacketWalk::kWentThrough;
    tx = _mm_add_sd(tx, _mm_and_pd(_mm_and_pd(not_z, x_before_y), dx));
    ty = _mm_add_sd(ty, _mm_and_pd(_mm_andnot_pd(x_before_y, not_z), dy));
    tz = _mm_add_sd(tz, _mm_andnot_pd(not_z, dz));
    const auto choice = static_cast<std::size_t>(_mm_movemask_pd(_mm_unpacklo_pd(x_before_y, not_z)));
    const std::uint32_t axis = axis_of[choice];
    index = (((index | ~axis) + 1) & axis) | (index & ~axis);
    if (!table.open(index ^ ray.flip)) return index ^ ray.flip;
  }
}
#endif

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
#ifdef __SSE2__
  constexpr std::size_t kWorthAPacket = 3;
  if (walk_ != nullptr && rays.size() < kWorthAPacket) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto ray = enter(grid_.lattice(), table_, rays[i]);
      settle(i, ray ? finish(rays[i], ray->key, ray->direction, walk_alone(table_, *ray), ray->whole)
                    : std::nullopt);
    }
    return left_size;
  }
#endif
  struct Walking {
    std::uint32_t ray, origin;  // index of its voxel
    float direction[3];
    bool whole;
  };
  PacketLines<double> lines;
  std::array<Walking, kMaxBatch> walking;
  std::array<std::uint32_t, kMaxBatch> stopped_at;
  lines.size = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto ray = walk_ == nullptr ? std::nullopt : enter(grid_.lattice(), table_, rays[i]);
    if (!ray) {
      left[left_size++] = static_cast<std::uint16_t>(i);
      continue;
    }
    const std::size_t n = lines.size++;
    for (std::size_t a = 0; a < 3; ++a) {
      lines.t_max[a][n] = ray->line.t_max[a];
      lines.t_delta[a][n] = ray->line.t_delta[a];
    }
    lines.end[n] = ray->end;
    lines.index[n] = ray->index;
    lines.flip[n] = ray->flip;
    const Eigen::Vector3f& d = ray->direction;
    walking[n] = {static_cast<std::uint32_t>(i), ray->index ^ ray->flip, {d.x(), d.y(), d.z()}, ray->whole};
  }
  if (lines.size == 0) return left_size;
  walk_->rays(table_, lines, stopped_at.data());
  for (std::size_t n = 0; n < lines.size; ++n) {
    const auto& [i, origin, d, whole] = walking[n];
    settle(i, finish(rays[i], as_key(table_.layout().key(origin)), {d[0], d[1], d[2]}, stopped_at[n], whole));
  }
  return left_size;
}

// None if the walk ended before the ray did.
std::optional<Hit> TableQuery::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                                      std::uint32_t stopped_at, bool whole) const {
  if (stopped_at == PacketWalk::kWentThrough) {
    if (!whole) return std::nullopt;
    return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  }
  const std::array<int, 3> cell = table_.layout().key(stopped_at);
  const bool is_key =
      std::all_of(cell.begin(), cell.end(), [](int k) { return k >= 0 && k < Lattice::kKeysPerAxis; });
  const bool in_border = !is_key || !table_.contains(as_key(cell));
  // The border stops every walk, but its voxels are unknown ones like others: under kPass they do not block.
  if (in_border && unknown_ == UnknownPolicy::kPass)
    return end_ray(grid_, ray, start, direction, unknown_, std::nullopt);
  if (!is_key) return walk_ray(grid_, ray, unknown_);
  return end_ray(grid_, ray, start, direction, unknown_, as_key(cell));
}

}  // namespace frontlux::detail
