#include "embree/scene_query.hpp"

#include "walk/end_ray.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

namespace frontlux::detail {
namespace {

// Such a component of a direction moves a ray by less than the tolerance all through the key range.
constexpr double kParallel = 1e-12;

// Looks up voxels most of which lie in the tile of the one before.
class TileLookup {
 public:
  explicit TileLookup(const VoxelGrid& grid) : grid_(grid) {}
  Occupancy operator()(const VoxelKey& key) {
    const VoxelKey corner = make_key(key.x & kMask, key.y & kMask, key.z & kMask);
    if (tile_ == nullptr || corner != corner_) {
      corner_ = corner;
      tile_ = &grid_.tile(key);
    }
    return tile_->brick(key).at(key);
  }

 private:
  static constexpr int kMask = ~((1 << Tile::kLog2) - 1);
  const VoxelGrid& grid_;
  const Tile* tile_ = nullptr;
  VoxelKey corner_{};
};

}  // namespace

// The part of a line that can meet a box, from at most a voxel outside the scene's bounds: coordinates there
// are small enough for the scene's tolerance. None if there is no such part.
std::optional<Probe> SceneQuery::probe(const Line& line, double t_far) const {
  if (reach_.isEmpty()) return std::nullopt;
  double t_near = 0.0;
  const Eigen::Array3d low = reach_.min().array(), high = reach_.max().array();
  for (int i = 0; i < 3; ++i) {
    const double o = line.origin[i], d = line.direction[i];
    if (std::fabs(d) < kParallel) {
      if (o < low[i] || o > high[i]) return std::nullopt;
      continue;
    }
    const double a = (low[i] - o) / d, b = (high[i] - o) / d;
    t_near = std::max(t_near, std::min(a, b));
    t_far = std::min(t_far, std::max(a, b));
  }
  if (!(t_near <= t_far)) return std::nullopt;
  const Eigen::Array3f origin = (line.origin + t_near * line.direction).cast<float>();
  // Inverses of tinier components overflow inside Embree, and there spoil the rays of the same packet.
  const Eigen::Array3f direction =
      (line.direction.abs() < kParallel).select(0.0, line.direction).cast<float>();
  return Probe{{origin[0], origin[1], origin[2]},
               0.0F,
               {direction[0], direction[1], direction[2]},
               static_cast<float>(t_far - t_near)};
}

// The voxel through whose face a line enters a box, unless single precision, or castRay's rounding, may have
// seen it otherwise. Where the line is off by the tolerance, it enters up to tolerance / |d| earlier along
// the axis of the face; had it entered another blocker in that time, it would have crossed into it along
// another axis, and would now be no further beyond that crossing than it moves along that axis in that time.
std::optional<VoxelKey> SceneQuery::entered_voxel(const Line& line, const KeyBox& box) const {
  const auto base = as_array(scene_.origin());
  const auto min = as_array(box.min), max = as_array(box.max);
  int axis = -1;
  double entry = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(i);
    if (std::fabs(line.direction[i]) < kParallel) continue;
    const int face = line.direction[i] > 0.0 ? min[a] : max[a] + 1;
    const double t = (face - base[a] - line.origin[i]) / line.direction[i];
    if (t > entry) {
      entry = t;
      axis = i;
    }
  }
  if (axis < 0) return std::nullopt;
  std::array<int, 3> key{};
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(i);
    if (i == axis) {
      key[a] = line.direction[i] > 0.0 ? min[a] : max[a];
      continue;
    }
    const double margin =
        4.0 * scene_.tolerance() * (1.0 + std::fabs(line.direction[i] / line.direction[axis]));
    const double at = line.origin[i] + entry * line.direction[i];
    const double cell = std::floor(at);
    if (at - cell < margin || cell + 1.0 - at < margin) return std::nullopt;
    key[a] = static_cast<int>(cell) + base[a];
    if (key[a] < min[a] || key[a] > max[a]) return std::nullopt;
  }
  return as_key(key);
}

void SceneQuery::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                        const std::optional<KeyBox>& box, Hit& hit) const {
  std::optional<VoxelKey> blocker;
  if (box) {
    blocker = entered_voxel(line_of(ray.origin, direction), *box);
    if (!blocker) {
      hit = walk_ray(grid_, ray, unknown_);
      return;
    }
  }
  const RayEnd end = end_of(grid_, ray, start, direction, unknown_, blocker);
  make_hit(grid_, ray, start, direction, end, hit);
}

void SceneQuery::cast(std::span<const Ray> rays, std::span<Hit> hits) const {
  struct Pending {
    std::size_t index;
    VoxelKey start;
    Eigen::Vector3f direction;
  };
  std::array<Pending, BoxScene::kMaxBatch> pending;
  std::array<Probe, BoxScene::kMaxBatch> probes;
  std::array<std::optional<KeyBox>, BoxScene::kMaxBatch> boxes;
  std::size_t size = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    const auto start = lattice_.key(ray.origin);
    if (!start) {
      hits[i] = {};
      continue;
    }
    const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
    // Directions that castRay cannot normalise, and origins that end the ray at once, go to the walk.
    if (!is_unit(direction) || blocks(grid_.at(*start), unknown_)) {
      hits[i] = walk_ray(grid_, ray, unknown_);
      continue;
    }
    // A voxel in range is entered before its centre's distance plus half a diagonal.
    const double t_far = ray.max_range > 0.0 ? ray.max_range / lattice_.resolution() + 1.0
                                             : std::numeric_limits<double>::infinity();
    const auto probed = probe(line_of(ray.origin, direction), t_far);
    if (!probed) {
      finish(ray, *start, direction, std::nullopt, hits[i]);
      continue;
    }
    probes[size] = *probed;
    pending[size++] = {i, *start, direction};
  }
  scene_.first({probes.data(), size}, {boxes.data(), size});
  for (std::size_t i = 0; i < size; ++i) {
    const Pending& p = pending[i];
    finish(rays[p.index], p.start, p.direction, boxes[i], hits[p.index]);
  }
}

// Between voxel centres the line is offset + t * difference with t from 0 to 1, all exact in float. It enters
// the target where the axis of the largest difference crosses into it.
SceneQuery::By SceneQuery::prepare(const KeySegment& segment, Probe& sight, bool& target_is_grazed) const {
  if (segment.from == segment.to) return By::kVisible;
  if (blocks(grid_.at(segment.from), unknown_)) return By::kWalk;
  const VoxelKey& base = scene_.origin();
  const Eigen::Array3f origin(static_cast<float>(segment.from.x - base.x) + 0.5F,
                              static_cast<float>(segment.from.y - base.y) + 0.5F,
                              static_cast<float>(segment.from.z - base.z) + 0.5F);
  const Eigen::Array3f difference(static_cast<float>(segment.to.x - segment.from.x),
                                  static_cast<float>(segment.to.y - segment.from.y),
                                  static_cast<float>(segment.to.z - segment.from.z));
  const Eigen::Array3f length = difference.abs();
  const float longest = length.maxCoeff(), inverse = 1.0F / longest;
  const auto tolerance = static_cast<float>(scene_.tolerance());
  // In double: from far outside the boxes a float's last digit is more than the tolerance.
  const double t_far = 1.0 - (0.5 + 3.0 * scene_.tolerance()) / static_cast<double>(longest);
  sight = {{origin[0], origin[1], origin[2]},
           0.0F,
           {difference[0], difference[1], difference[2]},
           static_cast<float>(t_far)};
  // At its entry the line is this far from the target's other faces, along its longest axis by 0. By an edge
  // it passes one voxel within the tolerance, which is the last one; by a corner there is another before it.
  int grazed = 0;
  for (int i = 0; i < 3; ++i)
    grazed += static_cast<int>(0.5F * (longest - length[i]) * inverse < 4.0F * tolerance);
  target_is_grazed = grazed > 2;
  if (!reach_.contains(origin.matrix().cast<double>())) {
    const auto probed = probe({origin.cast<double>(), difference.cast<double>()}, t_far);
    if (!probed) return target_is_grazed ? By::kWalk : By::kVisible;
    sight = *probed;
  }
  return By::kProbe;
}

SceneQuery::By SceneQuery::prepare(const Segment& segment, Probe& sight, bool& target_is_grazed) const {
  const auto from = lattice_.key(segment.from), to = lattice_.key(segment.to);
  if (!from || !to) return By::kHidden;
  if (*from == *to) return By::kVisible;
  const Eigen::Vector3f direction = normalized_as_octomap(segment.to - segment.from);
  if (!is_unit(direction) || blocks(grid_.at(*from), unknown_)) return By::kWalk;
  const Line line = line_of(segment.from, direction);
  const auto base = as_array(scene_.origin()), target = as_array(*to);
  std::array<double, 3> enter{}, leave{}, error{};
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const double d = line.direction[i];
    if (std::fabs(d) < kParallel) {
      // As close to a face as the tolerance, the line may cross it all the same.
      const double inside = line.origin[i] - (target[a] - base[a]), margin = 4.0 * scene_.tolerance();
      if (as_array(*from)[a] != target[a] || inside < margin || 1.0 - inside < margin) return By::kWalk;
      enter[a] = 0.0;
      leave[a] = std::numeric_limits<double>::infinity();
      continue;
    }
    const double low = (target[a] - base[a] - line.origin[i]) / d, high = low + 1.0 / d;
    enter[a] = std::min(low, high);
    leave[a] = std::max(low, high);
    error[a] = 4.0 * scene_.tolerance() / std::fabs(d);
  }
  const auto axis = static_cast<std::size_t>(std::max_element(enter.begin(), enter.end()) - enter.begin());
  target_is_grazed = false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i != axis && enter[i] + error[i] > enter[axis] - error[axis]) target_is_grazed = true;
    if (leave[i] - error[i] < enter[axis] + error[axis]) target_is_grazed = true;
  }
  const auto probed = probe(line, enter[axis] - error[axis]);
  if (!probed) return target_is_grazed ? By::kWalk : By::kVisible;
  sight = *probed;
  return By::kProbe;
}

// Most segments that are blocked are so right before what is to be seen. All are looked at first, without a
// branch that depends on it, so that they wait for memory together.
void SceneQuery::hide_behind_last(std::span<const KeySegment> segments, std::span<bool> hidden) const {
  TileLookup state_of(grid_);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto& [from, to] = segments[i];
    const VoxelKey last = voxel_before_end(from, to);
    hidden[i] = (static_cast<int>(blocks(state_of(last), unknown_)) & static_cast<int>(last != from) &
                 static_cast<int>(from != to)) != 0;
  }
}

template <class Segment>
void SceneQuery::visible(std::span<const Segment> segments, std::span<std::uint8_t> visible) const {
  std::array<std::size_t, BoxScene::kMaxBatch> index;
  std::array<Probe, BoxScene::kMaxBatch> probes;
  std::array<bool, BoxScene::kMaxBatch> target_is_grazed;
  std::array<Sight, BoxScene::kMaxBatch> sights;
  const auto walk = [&](std::size_t i) {
    visible[i] = static_cast<std::uint8_t>(walk_visible(grid_, segments[i], unknown_));
  };
  std::array<bool, BoxScene::kMaxBatch> hidden{};
  if constexpr (std::is_same_v<Segment, KeySegment>) hide_behind_last(segments, hidden);
  std::size_t size = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    switch (hidden[i] ? By::kHidden : prepare(segments[i], probes[size], target_is_grazed[size])) {
      case By::kHidden:
        visible[i] = 0;
        break;
      case By::kVisible:
        visible[i] = 1;
        break;
      case By::kProbe:
        index[size++] = i;
        break;
      case By::kWalk:
        walk(i);
        break;
    }
  }
  scene_.occluded({probes.data(), size}, {sights.data(), size});
  for (std::size_t i = 0; i < size; ++i) {
    if (sights[i] == Sight::kBlocked)
      visible[index[i]] = 0;
    else if (sights[i] == Sight::kTooClose || target_is_grazed[i])
      walk(index[i]);
    else
      visible[index[i]] = 1;
  }
}

template void SceneQuery::visible<Segment>(std::span<const Segment>, std::span<std::uint8_t>) const;
template void SceneQuery::visible<KeySegment>(std::span<const KeySegment>, std::span<std::uint8_t>) const;

}  // namespace frontlux::detail
