#include "octomap/octomap_adapter.hpp"
#include "octomap/own_castray.hpp"
#include "parallel/answer_each.hpp"
#include "walk/path_count.hpp"
#include "walk/plain_count.hpp"
#include "walk/walk.hpp"

#include <frontlux/file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>

namespace frontlux {
namespace {

using detail::answer_each;
using detail::from_octomap;
using detail::to_octomap;

template <class Tree>
class OctomapRayCaster final : public RayCaster {
 public:
  explicit OctomapRayCaster(std::shared_ptr<const Tree> tree)
      : RayCaster(Lattice(tree->getResolution())), shared_(std::move(tree)), tree_(*shared_) {}

 private:
  Hit cast_one(const Ray& ray, UnknownPolicy unknown) const {
    const auto start = lattice().key(ray.origin);
    if (!start) return {};
    octomap::point3d end(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
    const bool hit = detail::own_castray(tree_, to_octomap(ray.origin), to_octomap(ray.direction), end,
                                         unknown == UnknownPolicy::kPass, ray.max_range);
    if (!(end.x() == end.x())) return {};  // castRay left it untouched

    // castRay answers no more than "hit" or "no hit", and the last voxel. The rest follows from its rules 6
    // to 8.
    const Eigen::Vector3f center = from_octomap(end);
    const VoxelKey key = lattice().key(center).value();
    const Occupancy state = state_at(key);
    RayStop stop = RayStop::kLeftMap;
    if (hit)
      stop = RayStop::kOccupied;
    else if (key != *start && ray.max_range > 0.0 && detail::out_of_range(ray.origin, center, ray.max_range))
      stop = RayStop::kOutOfRange;
    else if (state == Occupancy::kUnknown && unknown == UnknownPolicy::kBlock)
      stop = RayStop::kUnknown;
    Hit answer;
    detail::make_hit(lattice(), ray, *start, detail::normalized_as_octomap(ray.direction), stop, state, key,
                     answer);
    return answer;
  }

  bool visible_one(const Eigen::Vector3f& from, const Eigen::Vector3f& to, UnknownPolicy unknown) const {
    const auto start = lattice().key(from), target = lattice().key(to);
    if (!start || !target) return false;
    return *start == *target || reaches(from, to, *target, lattice().center(*target), unknown);
  }

  bool visible_one(const VoxelKey& from, const VoxelKey& to, UnknownPolicy unknown) const {
    const Eigen::Vector3f center = lattice().center(to);
    return from == to || reaches(lattice().center(from), center, to, center, unknown);
  }

  // Whether castRay from `from` stops in the target, the voxel of `to`, or gets further without a blocker.
  bool reaches(const Eigen::Vector3f& from, const Eigen::Vector3f& to, const VoxelKey& target,
               const Eigen::Vector3f& center, UnknownPolicy unknown) const {
    const octomap::point3d origin = to_octomap(from);
    const octomap::point3d target_center = to_octomap(center);
    double distance_sq = 0.0;  // as castRay sums it, so that the target itself is never out of range
    for (unsigned i = 0; i < 3; ++i) {
      const float squared = (target_center(i) - origin(i)) * (target_center(i) - origin(i));
      distance_sq += static_cast<double>(squared);
    }
    const double range = std::sqrt(distance_sq) * (1.0 + 1e-12);
    octomap::point3d end = origin;
    if (detail::own_castray(tree_, origin, to_octomap(to) - origin, end, unknown == UnknownPolicy::kPass,
                            range))
      return lattice().key(from_octomap(end)) == target;
    const auto last = lattice().key(from_octomap(end));
    if (last == target) return true;
    return detail::out_of_range(from, from_octomap(end), range);
  }

  // All that is not asked of the tree is asked of the lattice.
  void check_resolution() const {
    if (tree_.getResolution() != lattice().resolution())
      throw std::invalid_argument("the tree's resolution is " + decimals_of(tree_.getResolution()) +
                                  " m, but was " + decimals_of(lattice().resolution()) +
                                  " m when the caster was made; make another one");
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(rays, hits, [&](const Ray& ray) { return cast_one(ray, unknown); });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(segments, visible, [&](const Segment& s) { return visible_one(s.from, s.to, unknown); });
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(segments, visible, [&](const KeySegment& s) { return visible_one(s.from, s.to, unknown); });
  }

  Occupancy state_at(const VoxelKey& key) const { return detail::state_at(tree_, key); }
  [[nodiscard]] auto states() const {
    return [this](const VoxelKey& key) { return state_at(key); };
  }
  static bool anywhere(const VoxelKey&) { return true; }

  PathCount count_one(const Ray& ray, UnknownPolicy unknown) const {
    const auto start = lattice().key(ray.origin);
    if (!start) return {};
    const Occupancy state = state_at(*start);
    if (detail::blocks(state, unknown)) return {0, 0, 0, detail::stop_in(state)};
    const auto path =
        detail::path_along(lattice(), ray.origin, *start, detail::normalized_as_octomap(ray.direction));
    if (!path) return {};
    const auto in_range = [&](const VoxelKey& key) {
      return !(ray.max_range > 0.0 && detail::out_of_range(ray.origin, lattice().center(key), ray.max_range));
    };
    return detail::count_plainly(*path, unknown, states(), in_range, RayStop::kLeftMap);
  }
  PathCount count_one(const Segment& segment, UnknownPolicy unknown) const {
    const auto from = lattice().key(segment.from), to = lattice().key(segment.to);
    if (!from || !to) return {};
    if (*from == *to) return {0, 0, 0, RayStop::kReached};
    const auto path = detail::path_between(lattice(), segment, *from, *to);
    if (!path) return {};
    return detail::count_plainly(*path, unknown, states(), anywhere, RayStop::kOutOfRange);
  }
  PathCount count_one(const KeySegment& segment, UnknownPolicy unknown) const {
    if (segment.from == segment.to) return {0, 0, 0, RayStop::kReached};
    return detail::count_plainly(detail::path_between(segment), unknown, states(), anywhere,
                                 RayStop::kOutOfRange);
  }

  void do_count(std::span<const Ray> rays, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(rays, counts, [&](const Ray& ray) { return count_one(ray, unknown); });
  }
  void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(segments, counts, [&](const Segment& segment) { return count_one(segment, unknown); });
  }
  void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    check_resolution();
    answer_each(segments, counts, [&](const KeySegment& segment) { return count_one(segment, unknown); });
  }

  void do_update(const VoxelGrid&) override {}

  const std::shared_ptr<const Tree> shared_;
  const Tree& tree_;
};

template <class Tree>
std::unique_ptr<RayCaster> make(std::shared_ptr<const Tree> tree) {
  return std::make_unique<OctomapRayCaster<Tree>>(std::move(tree));
}

}  // namespace

std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::OcTree& tree) {
  return make(detail::borrowed(tree));
}
std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::ColorOcTree& tree) {
  return make(detail::borrowed(tree));
}
std::unique_ptr<RayCaster> make_octomap_ray_caster(const Octree& tree) {
  return std::visit([](const auto& t) { return make(t); }, detail::to_read(tree));
}

}  // namespace frontlux
