#include <frontlux/octomap.hpp>

// OctoMap reports rays that leave its key range on stderr, from inside the header that holds castRay. A
// library must not print, so in this file, where castRay is compiled in, the two macros say nothing.
#include <octomap/octomap_types.h>
#undef OCTOMAP_WARNING
#undef OCTOMAP_ERROR
#undef OCTOMAP_WARNING_STR
#undef OCTOMAP_ERROR_STR
#define OCTOMAP_WARNING(...) ((void)0)
#define OCTOMAP_ERROR(...) ((void)0)
#define OCTOMAP_WARNING_STR(args) ((void)0)
#define OCTOMAP_ERROR_STR(args) ((void)0)
#include "parallel/batch.hpp"
#include "octomap/octree_file.hpp"
#include "walk/path_count.hpp"
#include "walk/plain_count.hpp"
#include "walk/walk.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace frontlux {
namespace {

octomap::point3d to_octomap(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }
Eigen::Vector3f from_octomap(const octomap::point3d& p) { return {p.x(), p.y(), p.z()}; }
octomap::OcTreeKey to_octomap(const VoxelKey& key) { return {key.x, key.y, key.z}; }
VoxelKey from_octomap(const octomap::OcTreeKey& key) { return {key[0], key[1], key[2]}; }

template <class Tree>
Occupancy state_of(const Tree& tree, const typename Tree::NodeType* node) {
  if (node == nullptr) return Occupancy::kUnknown;
  return tree.isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
}

template <class Tree>
void mirror_node(const Tree& tree, const typename Tree::NodeType* node, const Block& block, VoxelGrid& grid) {
  if (block.log2_edge == 0 || !tree.nodeHasChildren(node)) {
    grid.fill(block, state_of(tree, node));
    return;
  }
  const int log2_edge = block.log2_edge - 1;
  for (unsigned i = 0; i < 8; ++i) {
    if (!tree.nodeChildExists(node, i)) continue;
    const auto along = [&](std::uint16_t base, unsigned bit) {
      return static_cast<std::uint16_t>(base + (((i >> bit) & 1U) << log2_edge));
    };
    const VoxelKey corner{along(block.corner.x, 0), along(block.corner.y, 1), along(block.corner.z, 2)};
    mirror_node(tree, tree.getNodeChild(node, i), {corner, log2_edge}, grid);
  }
}

template <class Tree>
VoxelGrid mirror(const Tree& tree) {
  if (tree.getTreeDepth() != 16)
    throw std::invalid_argument(
        "only trees of OctoMap's standard depth 16 are supported, this one has depth " +
        std::to_string(tree.getTreeDepth()));
  VoxelGrid grid(tree.getResolution());
  if (tree.getRoot() != nullptr) mirror_node(tree, tree.getRoot(), {{}, 16}, grid);
  return grid;
}

template <class Tree>
class OctomapRayCaster final : public RayCaster {
 public:
  explicit OctomapRayCaster(const Tree& tree) : RayCaster(Lattice(tree.getResolution())), tree_(tree) {}

 private:
  static constexpr std::size_t kGrain = 256;

  // Flattened, so that what is compiled here, with this project's flags, is what runs: castRay is a weak
  // template symbol and a call could end in anybody's copy.
  [[gnu::flatten]] bool cast_ray(const octomap::point3d& origin, const octomap::point3d& direction,
                                 octomap::point3d& end, UnknownPolicy unknown, double max_range) const {
    return tree_.Tree::castRay(origin, direction, end, unknown == UnknownPolicy::kPass, max_range);
  }

  Hit cast_one(const Ray& ray, UnknownPolicy unknown) const {
    const auto start = lattice().key(ray.origin);
    if (!start) return {};
    octomap::point3d end(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
    const bool hit = cast_ray(to_octomap(ray.origin), to_octomap(ray.direction), end, unknown, ray.max_range);
    if (!(end.x() == end.x())) return {};  // castRay left it untouched

    // castRay tells no more than "hit" or "no hit, and the last voxel": the rest follows from its rules 6
    // to 8.
    const Eigen::Vector3f center = from_octomap(end);
    const VoxelKey key = lattice().key(center).value();
    const Occupancy state = state_of(tree_, tree_.search(to_octomap(key)));
    RayStop stop = RayStop::kLeftMap;
    if (hit)
      stop = RayStop::kOccupied;
    else if (key != *start && ray.max_range > 0.0 && detail::out_of_range(ray.origin, center, ray.max_range))
      stop = RayStop::kOutOfRange;
    else if (state == Occupancy::kUnknown && unknown == UnknownPolicy::kBlock)
      stop = RayStop::kUnknown;
    return detail::make_hit(lattice(), ray, *start, detail::normalized_as_octomap(ray.direction), stop, state,
                            key);
  }

  // True if castRay from `from` stops in the voxel of `to`, or passes its distance unblocked.
  bool visible_one(const Eigen::Vector3f& from, const Eigen::Vector3f& to, UnknownPolicy unknown) const {
    const auto start = lattice().key(from), target = lattice().key(to);
    if (!start || !target) return false;
    if (*start == *target) return true;
    const octomap::point3d origin = to_octomap(from);
    const octomap::point3d target_center = to_octomap(lattice().center(*target));
    double distance_sq = 0.0;  // as castRay sums it, so that the target itself is never out of range
    for (unsigned i = 0; i < 3; ++i) {
      const float squared = (target_center(i) - origin(i)) * (target_center(i) - origin(i));
      distance_sq += static_cast<double>(squared);
    }
    const double range = std::sqrt(distance_sq) * (1.0 + 1e-12);
    octomap::point3d end = origin;
    if (cast_ray(origin, to_octomap(to) - origin, end, unknown, range))
      return lattice().key(from_octomap(end)) == target;
    const auto last = lattice().key(from_octomap(end));
    if (last == target) return true;
    return detail::out_of_range(from, from_octomap(end), range);
  }

  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    detail::for_each_piece(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) hits[i] = cast_one(rays[i], unknown);
    });
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    detail::for_each_piece(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        visible[i] = static_cast<std::uint8_t>(visible_one(segments[i].from, segments[i].to, unknown));
    });
  }
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    detail::for_each_piece(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        visible[i] = static_cast<std::uint8_t>(
            visible_one(lattice().center(segments[i].from), lattice().center(segments[i].to), unknown));
    });
  }

  Occupancy state_at(const VoxelKey& key) const { return state_of(tree_, tree_.search(to_octomap(key))); }

  [[nodiscard]] auto looker() const {
    return [this](const VoxelKey& key) { return state_at(key); };
  }
  static bool anywhere(const VoxelKey&) { return true; }

  PathCount count_one(const Ray& ray, UnknownPolicy unknown) const {
    const auto start = lattice().key(ray.origin);
    if (!start) return {};
    const Occupancy state = state_at(*start);
    if (detail::blocks(state, unknown)) return {0, 0, 0, detail::stop_in(state)};
    const auto course =
        detail::course_along(lattice(), ray.origin, *start, detail::normalized_as_octomap(ray.direction));
    if (!course) return {};
    const auto in_range = [&](const VoxelKey& key) {
      return !(ray.max_range > 0.0 && detail::out_of_range(ray.origin, lattice().center(key), ray.max_range));
    };
    return detail::count_plainly(*course, unknown, looker(), in_range, RayStop::kLeftMap);
  }
  PathCount count_one(const Segment& segment, UnknownPolicy unknown) const {
    const auto from = lattice().key(segment.from), to = lattice().key(segment.to);
    if (!from || !to) return {};
    if (*from == *to) return {0, 0, 0, RayStop::kReached};
    const auto course = detail::course_between(lattice(), segment, *from, *to);
    if (!course) return {};
    return detail::count_plainly(*course, unknown, looker(), anywhere, RayStop::kOutOfRange);
  }
  PathCount count_one(const KeySegment& segment, UnknownPolicy unknown) const {
    if (segment.from == segment.to) return {0, 0, 0, RayStop::kReached};
    return detail::count_plainly(detail::course_between(segment), unknown, looker(), anywhere,
                                 RayStop::kOutOfRange);
  }

  template <class Path>
  void count_paths(std::span<const Path> paths, std::span<PathCount> counts, UnknownPolicy unknown) const {
    detail::for_each_piece(paths.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) counts[i] = count_one(paths[i], unknown);
    });
  }
  void do_count(std::span<const Ray> rays, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(rays, counts, unknown);
  }
  void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(segments, counts, unknown);
  }
  void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    count_paths(segments, counts, unknown);
  }

  void do_update(const VoxelGrid&) override {}

  const Tree& tree_;
};

using WatchedTree = std::variant<const octomap::OcTree*, const octomap::ColorOcTree*>;

VoxelGrid mirror(const WatchedTree& tree) {
  return std::visit([](const auto* t) { return mirror(*t); }, tree);
}

}  // namespace

Octree read_octree(const std::filesystem::path& file) {
  detail::OctreeFile checked = detail::read_checked_octree_file(file);
  std::istringstream nodes(checked.bytes.substr(checked.data_offset));
  const auto read = [&](auto tree) -> Octree {
    if (checked.node_count == 0) return tree;
    if (checked.format == detail::OctreeFormat::kBinary)
      tree->readBinaryData(nodes);
    else
      tree->readData(nodes);
    return tree;
  };
  if (checked.tree_type == "ColorOcTree")
    return read(std::make_shared<octomap::ColorOcTree>(checked.resolution));
  return read(std::make_shared<octomap::OcTree>(checked.resolution));
}

VoxelGrid make_voxel_grid(const octomap::OcTree& tree) { return mirror(tree); }
VoxelGrid make_voxel_grid(const octomap::ColorOcTree& tree) { return mirror(tree); }

struct OctreeMirror::Watch {
  WatchedTree tree;
  VoxelGrid grid;
  bool detecting = false;
  const void* root = nullptr;
  double occupancy_threshold = 0.0;
  std::vector<VoxelKey>
      reported{};  // a key that changes back vanishes from the tree's own list: look at it once more

  explicit Watch(WatchedTree watched) : tree(watched), grid(mirror(watched)) { remember(); }

  void remember() {
    std::visit(
        [this](const auto* t) {
          detecting = t->isChangeDetectionEnabled();
          root = t->getRoot();
          occupancy_threshold = static_cast<double>(t->getOccupancyThresLog());
        },
        tree);
  }

  [[nodiscard]] bool changes_are_complete() const {
    return std::visit(
        [this](const auto* t) {
          return detecting && t->isChangeDetectionEnabled() && root != nullptr && root == t->getRoot() &&
                 occupancy_threshold == static_cast<double>(t->getOccupancyThresLog()) &&
                 grid.resolution() == t->getResolution();
        },
        tree);
  }

  void rebuild() {
    grid = mirror(tree);
    reported.clear();
    remember();
  }

  void follow() {
    std::visit(
        [this](const auto* t) {
          const auto refresh = [&](const VoxelKey& key) {
            grid.set(key, state_of(*t, t->search(to_octomap(key))));
          };
          for (const VoxelKey& key : reported) refresh(key);
          reported.clear();
          for (auto it = t->changedKeysBegin(); it != t->changedKeysEnd(); ++it)
            reported.push_back(from_octomap(it->first));
          std::sort(reported.begin(), reported.end());
          for (const VoxelKey& key : reported) refresh(key);
        },
        tree);
    remember();
  }
};

OctreeMirror::OctreeMirror(const octomap::OcTree& tree) : watch_(std::make_unique<Watch>(&tree)) {}
OctreeMirror::OctreeMirror(const octomap::ColorOcTree& tree) : watch_(std::make_unique<Watch>(&tree)) {}
OctreeMirror::~OctreeMirror() = default;
OctreeMirror::OctreeMirror(OctreeMirror&&) noexcept = default;
OctreeMirror& OctreeMirror::operator=(OctreeMirror&&) noexcept = default;

const VoxelGrid& OctreeMirror::grid() const { return watch_->grid; }

bool OctreeMirror::update() {
  const bool incremental = watch_->changes_are_complete();
  if (incremental)
    watch_->follow();
  else
    watch_->rebuild();
  return incremental;
}

void OctreeMirror::rebuild() { watch_->rebuild(); }

std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::OcTree& tree) {
  return std::make_unique<OctomapRayCaster<octomap::OcTree>>(tree);
}
std::unique_ptr<RayCaster> make_octomap_ray_caster(const octomap::ColorOcTree& tree) {
  return std::make_unique<OctomapRayCaster<octomap::ColorOcTree>>(tree);
}

struct OctreeRayCaster::Snapshot {
  WatchedTree tree;
  std::unique_ptr<RayCaster> caster;

  explicit Snapshot(WatchedTree read_from)
      : tree(read_from), caster(make_embree_ray_caster(mirror(read_from))) {}
};

OctreeRayCaster::OctreeRayCaster(const octomap::OcTree& tree)
    : snapshot_(std::make_unique<Snapshot>(&tree)) {}
OctreeRayCaster::OctreeRayCaster(const octomap::ColorOcTree& tree)
    : snapshot_(std::make_unique<Snapshot>(&tree)) {}
OctreeRayCaster::~OctreeRayCaster() = default;
OctreeRayCaster::OctreeRayCaster(OctreeRayCaster&&) noexcept = default;
OctreeRayCaster& OctreeRayCaster::operator=(OctreeRayCaster&&) noexcept = default;

bool OctreeRayCaster::castRay(const octomap::point3d& origin, const octomap::point3d& direction,
                              octomap::point3d& end, bool ignoreUnknownCells, double maxRange) const {
  const Ray ray{from_octomap(origin), from_octomap(direction), maxRange};
  const Hit hit =
      snapshot_->caster->cast(ray, ignoreUnknownCells ? UnknownPolicy::kPass : UnknownPolicy::kBlock);
  if (hit.stop != RayStop::kInvalid) end = to_octomap(hit.end);
  return hit.occupied();
}

void OctreeRayCaster::castRays(std::span<const Ray> rays, std::span<Hit> hits,
                               bool ignoreUnknownCells) const {
  snapshot_->caster->cast(rays, hits, ignoreUnknownCells ? UnknownPolicy::kPass : UnknownPolicy::kBlock);
}

void OctreeRayCaster::refresh() { *snapshot_ = Snapshot(snapshot_->tree); }

const RayCaster& OctreeRayCaster::caster() const { return *snapshot_->caster; }

}  // namespace frontlux
