#include "batch.hpp"
#include "blocker_boxes.hpp"
#include "box_scene.hpp"
#include "free_end.hpp"
#include "published.hpp"
#include "walk.hpp"

#include <frontlux/ray_caster.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace frontlux {
namespace {

using detail::Blockers;
using detail::BoxScene;
using detail::Probe;
using detail::Sight;

// Scenes that no query looks at any more, to be brought up to date instead of built anew.
class SpareScenes {
 public:
  explicit SpareScenes(std::shared_ptr<detail::BoxSceneDevice> device) : device_(std::move(device)) {}

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
  std::shared_ptr<detail::BoxSceneDevice> device_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<BoxScene>> scenes_;
};

// The blockers under one policy, in a list and in a scene.
class Obstacles {
 public:
  Obstacles(Blockers blockers, std::shared_ptr<SpareScenes> spares)
      : blockers_(std::move(blockers)), spares_(std::move(spares)), scene_(spares_->take()) {
    scene_->follow(blockers_);
  }
  ~Obstacles() { spares_->give_back(std::move(scene_)); }
  Obstacles(const Obstacles&) = delete;
  Obstacles& operator=(const Obstacles&) = delete;

  [[nodiscard]] const BoxScene& scene() const { return *scene_; }
  [[nodiscard]] const Blockers& blockers() const { return blockers_; }
  [[nodiscard]] const std::shared_ptr<SpareScenes>& spares() const { return spares_; }

 private:
  Blockers blockers_;
  std::shared_ptr<SpareScenes> spares_;
  std::unique_ptr<BoxScene> scene_;
};

// A map as it was at one moment, ready to be queried.
class Snapshot {
 public:
  Snapshot(const VoxelGrid& grid, const std::shared_ptr<detail::BoxSceneDevice>& device) : grid_(grid) {
    for_both_policies([&](std::size_t i, UnknownPolicy unknown) {
      obstacles_[i].emplace(detail::make_blockers(grid_, unknown), std::make_shared<SpareScenes>(device));
    });
  }

  Snapshot(const VoxelGrid& grid, const Snapshot& before) : grid_(grid) {
    for_both_policies([&](std::size_t i, UnknownPolicy unknown) {
      const Obstacles& old = *before.obstacles_[i];
      obstacles_[i].emplace(detail::follow_blockers(old.blockers(), before.grid_, grid_, unknown),
                            old.spares());
    });
  }

  [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
  [[nodiscard]] const BoxScene& scene(UnknownPolicy unknown) const {
    return obstacles_[static_cast<std::size_t>(unknown)]->scene();
  }
  [[nodiscard]] std::size_t box_bytes() const {
    return (obstacles_[0]->blockers().box_count() + obstacles_[1]->blockers().box_count()) *
           sizeof(detail::PackedBox);
  }

 private:
  template <class Work>
  static void for_both_policies(const Work& work) {
    detail::for_each_piece(2, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i, static_cast<UnknownPolicy>(i));
    });
  }

  VoxelGrid grid_;
  std::array<std::optional<Obstacles>, 2> obstacles_;  // by UnknownPolicy
};

// Answers queries about one map under one policy: what surely holds by the scene, everything else by the
// walk.
class Query {
 public:
  Query(const Snapshot& snapshot, UnknownPolicy unknown)
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
  [[nodiscard]] Hit finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                           const std::optional<KeyBox>& box) const;

  struct Sighting {
    Probe probe;
    bool target_is_grazed =
        false;  // the line enters the target's voxel so close to an edge that it may miss it
  };
  // What settles a segment at once (true, false), or what there is to look at, or nothing if only the walk
  // knows.
  struct Prepared {
    std::optional<bool> answer;
    std::optional<Sighting> sighting;
  };
  [[nodiscard]] Prepared prepare(const KeySegment& segment) const;
  [[nodiscard]] Prepared prepare(const Segment& segment) const;

  const VoxelGrid& grid_;
  const Lattice& lattice_;
  const BoxScene& scene_;
  UnknownPolicy unknown_;
  Eigen::AlignedBox3d
      reach_;  // where the scene's tolerance holds for a probe's origin; empty if there are no boxes
};

// A component of a direction that moves a ray by less than the tolerance on its whole way through the key
// range.
constexpr double kParallel = 1e-12;

bool is_unit(const Eigen::Vector3f& direction) { return std::fabs(direction.squaredNorm() - 1.0F) < 1e-4F; }

// The part of a line that can meet a box, from at most a voxel outside the scene's bounds: coordinates there
// are small enough for the scene's tolerance. Nothing if there is no such part.
std::optional<Probe> Query::probe(const Line& line, double t_far) const {
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
std::optional<VoxelKey> Query::entered_voxel(const Line& line, const KeyBox& box) const {
  const auto base = detail::as_array(scene_.origin());
  const auto min = detail::as_array(box.min), max = detail::as_array(box.max);
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
  return detail::as_key(key);
}

Hit Query::finish(const Ray& ray, const VoxelKey& start, const Eigen::Vector3f& direction,
                  const std::optional<KeyBox>& box) const {
  if (box) {
    const auto key = entered_voxel(line_of(ray.origin, direction), *box);
    if (!key) return detail::walk_ray(grid_, ray, unknown_);
    if (!(ray.max_range > 0.0) || !detail::out_of_range(ray.origin, lattice_.center(*key), ray.max_range)) {
      const Occupancy state = grid_.at(*key);
      return detail::make_hit(lattice_, ray, start, direction, detail::stop_in(state), state, *key);
    }
  }
  // No blocker within range, since centres only get further away along a ray.
  const auto end = detail::find_free_end(lattice_, ray, start, direction);
  if (!end) return detail::walk_ray(grid_, ray, unknown_);
  return detail::make_hit(lattice_, ray, start, direction, end->stop, grid_.at(end->key), end->key);
}

void Query::cast(std::span<const Ray> rays, std::span<Hit> hits) const {
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
    const Eigen::Vector3f direction = detail::normalized_as_octomap(ray.direction);
    // Directions that castRay cannot normalise, and origins that end the ray at once, are the walk's.
    if (!is_unit(direction) || detail::blocks(grid_.at(*start), unknown_)) {
      hits[i] = detail::walk_ray(grid_, ray, unknown_);
      continue;
    }
    // A voxel in range is entered before its centre's distance plus half a diagonal.
    const double t_far = ray.max_range > 0.0 ? ray.max_range / lattice_.resolution() + 1.0
                                             : std::numeric_limits<double>::infinity();
    const auto probed = probe(line_of(ray.origin, direction), t_far);
    if (!probed) {
      hits[i] = finish(ray, *start, direction, std::nullopt);
      continue;
    }
    probes[size] = *probed;
    pending[size++] = {i, *start, direction};
  }
  scene_.first({probes.data(), size}, {boxes.data(), size});
  for (std::size_t i = 0; i < size; ++i) {
    const Pending& p = pending[i];
    hits[p.index] = finish(rays[p.index], p.start, p.direction, boxes[i]);
  }
}

// Between voxel centres the line is offset + t * difference with t from 0 to 1, all exact in float. It enters
// the target where the axis of the largest difference crosses into it.
Query::Prepared Query::prepare(const KeySegment& segment) const {
  if (segment.from == segment.to) return {true, {}};
  if (detail::blocks(grid_.at(segment.from), unknown_)) return {};
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
  const float t_far = 1.0F - 0.5F * inverse - 3.0F * tolerance * inverse;
  Sighting sighting{
      {{origin[0], origin[1], origin[2]}, 0.0F, {difference[0], difference[1], difference[2]}, t_far}, false};
  // At its entry the line is this far from the target's other faces; twice the axis itself makes zero.
  int grazed = 0;
  for (int i = 0; i < 3; ++i)
    grazed += static_cast<int>(0.5F * (longest - length[i]) * inverse < 4.0F * tolerance);
  sighting.target_is_grazed = grazed > 1;
  if (!reach_.contains(origin.matrix().cast<double>())) {
    const auto probed = probe({origin.cast<double>(), difference.cast<double>()}, static_cast<double>(t_far));
    if (!probed) return sighting.target_is_grazed ? Prepared{} : Prepared{true, {}};
    sighting.probe = *probed;
  }
  return {{}, sighting};
}

Query::Prepared Query::prepare(const Segment& segment) const {
  const auto from = lattice_.key(segment.from), to = lattice_.key(segment.to);
  if (!from || !to) return {false, {}};
  if (*from == *to) return {true, {}};
  const Eigen::Vector3f direction = detail::normalized_as_octomap(segment.to - segment.from);
  if (!is_unit(direction) || detail::blocks(grid_.at(*from), unknown_)) return {};
  const Line line = line_of(segment.from, direction);
  const auto base = detail::as_array(scene_.origin()), target = detail::as_array(*to);
  std::array<double, 3> enter{}, leave{}, error{};
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const double d = line.direction[i];
    if (std::fabs(d) < kParallel) {
      if (detail::as_array(*from)[a] != target[a]) return {};
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
  Sighting sighting;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i != axis && enter[i] + error[i] > enter[axis] - error[axis]) sighting.target_is_grazed = true;
    if (leave[i] - error[i] < enter[axis] + error[axis]) sighting.target_is_grazed = true;
  }
  const auto probed = probe(line, enter[axis] - error[axis]);
  if (!probed) return sighting.target_is_grazed ? Prepared{} : Prepared{true, {}};
  sighting.probe = *probed;
  return {{}, sighting};
}

template <class Segment>
void Query::visible(std::span<const Segment> segments, std::span<std::uint8_t> visible) const {
  std::array<std::size_t, BoxScene::kMaxBatch> index;
  std::array<Probe, BoxScene::kMaxBatch> probes;
  std::array<bool, BoxScene::kMaxBatch> target_is_grazed;
  std::array<Sight, BoxScene::kMaxBatch> sights;
  const auto walk = [&](std::size_t i) {
    visible[i] = static_cast<std::uint8_t>(detail::walk_visible(grid_, segments[i], unknown_));
  };
  std::size_t size = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Prepared prepared = prepare(segments[i]);
    if (prepared.answer) {
      visible[i] = static_cast<std::uint8_t>(*prepared.answer);
    } else if (prepared.sighting) {
      probes[size] = prepared.sighting->probe;
      target_is_grazed[size] = prepared.sighting->target_is_grazed;
      index[size++] = i;
    } else {
      walk(i);
    }
  }
  scene_.occluded({probes.data(), size}, {sights.data(), size});
  for (std::size_t i = 0; i < size; ++i) {
    if (sights[i] == Sight::kBlocked)
      visible[index[i]] = 0;
    else if (sights[i] == Sight::kTooCloseToTell || target_is_grazed[i])
      walk(index[i]);
    else
      visible[index[i]] = 1;
  }
}

class EmbreeRayCaster final : public RayCaster {
 public:
  explicit EmbreeRayCaster(const VoxelGrid& grid)
      : RayCaster(grid.lattice()),
        device_(detail::make_box_scene_device()),
        snapshot_(std::make_shared<Snapshot>(grid, device_)) {}

  [[nodiscard]] std::size_t memory_bytes() const override {
    return detail::memory_bytes(*device_) + snapshot_.snapshot()->box_bytes();
  }

 private:
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    const auto snapshot = snapshot_.snapshot();
    const Query query(*snapshot, unknown);
    detail::for_each_piece(rays.size(), BoxScene::kMaxBatch, [&](std::size_t begin, std::size_t end) {
      query.cast(rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
    });
  }

  template <class Segment>
  void look(std::span<const Segment> segments, std::span<std::uint8_t> visible, UnknownPolicy unknown) const {
    const auto snapshot = snapshot_.snapshot();
    const Query query(*snapshot, unknown);
    detail::for_each_piece(segments.size(), BoxScene::kMaxBatch, [&](std::size_t begin, std::size_t end) {
      query.visible(segments.subspan(begin, end - begin), visible.subspan(begin, end - begin));
    });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    look(segments, visible, unknown);
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    look(segments, visible, unknown);
  }

  void do_update(const VoxelGrid& grid) override {
    snapshot_.replace(std::make_shared<Snapshot>(grid, *snapshot_.snapshot()));
  }

  std::shared_ptr<detail::BoxSceneDevice> device_;
  detail::Published<Snapshot> snapshot_;
};

}  // namespace

std::unique_ptr<RayCaster> make_embree_ray_caster(const VoxelGrid& grid) {
  return std::make_unique<EmbreeRayCaster>(grid);
}

}  // namespace frontlux
