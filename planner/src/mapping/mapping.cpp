#include "mapping/scan_voxels.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/mapping.hpp>

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::BrickUpdate;
using detail::Octants;
using octomap::OcTreeNode;

struct Change {
  VoxelKey key;
  Occupancy state;
};

// The part of a set of voxels that lies in one octant: of a brick's eight words a word, of a word a byte, of
// a byte a bit.
std::uint64_t part(const Octants& set, unsigned octant) { return set[octant]; }
std::uint8_t part(std::uint64_t set, unsigned octant) {
  return static_cast<std::uint8_t>(set >> (8 * octant));
}
bool part(std::uint8_t set, unsigned octant) { return ((set >> octant) & 1U) != 0; }

bool empty(const Octants& set) {
  return std::all_of(set.begin(), set.end(), [](std::uint64_t word) { return word == 0; });
}
bool full(const Octants& set) {
  return std::all_of(set.begin(), set.end(), [](std::uint64_t word) { return ~word == 0; });
}
bool empty(std::uint64_t set) { return set == 0; }
bool full(std::uint64_t set) { return ~set == 0; }
bool empty(std::uint8_t set) { return set == 0; }
bool full(std::uint8_t set) { return set == 0xFF; }
bool empty(bool set) { return !set; }

template <class Set>
constexpr unsigned kVoxels = std::is_same_v<Set, bool> ? 1 : 8 * sizeof(Set);

// An OcTree that takes all updates of a scan in one descent, which passes inner nodes once instead of once
// for each voxel below. What it leaves behind is what `updateNode` for each voxel would, pruning included.
class ScanTree : public octomap::OcTree {
 public:
  explicit ScanTree(double in_resolution) : octomap::OcTree(in_resolution) {}

  // Bricks in octree order.
  void update(std::span<const BrickUpdate> bricks, std::vector<Change>& changes) {
    if (bricks.empty()) return;
    changes_ = &changes;
    const bool created = root == nullptr;
    if (created) {
      root = new OcTreeNode();
      tree_size++;
    }
    update_above_bricks(*root, created, kLevelsAboveBricks, bricks);
  }

  // The state of the voxel becomes free, by at least one miss.
  void set_free(const VoxelKey& key, std::vector<Change>& changes) {
    const octomap::OcTreeKey octomap_key(key.x, key.y, key.z);
    const OcTreeNode* node = search(octomap_key);
    if (node != nullptr && node->getLogOdds() <= prob_miss_log) return;
    if (node == nullptr || isNodeOccupied(node)) changes.push_back({key, Occupancy::kFree});
    setNodeValue(octomap_key, prob_miss_log);
  }

 private:
  static constexpr int kLevelsAboveBricks = 13;

  [[nodiscard]] float updated(float log_odds, bool hit) const {
    return std::clamp(log_odds + (hit ? prob_hit_log : prob_miss_log), clamping_thres_min,
                      clamping_thres_max);
  }

  [[nodiscard]] bool changes_nothing(const OcTreeNode& leaf, bool misses, bool hits) const {
    return (!misses || leaf.getLogOdds() <= clamping_thres_min) &&
           (!hits || leaf.getLogOdds() >= clamping_thres_max);
  }

  // The child with this number, and whether it is new.
  std::pair<OcTreeNode*, bool> child_to_update(OcTreeNode& node, bool created, unsigned number) {
    if (nodeChildExists(&node, number)) return {getNodeChild(&node, number), false};
    if (!created && !nodeHasChildren(&node)) {  // pruned
      expandNode(&node);
      return {getNodeChild(&node, number), false};
    }
    return {createNodeChild(&node, number), true};
  }

  void follow_children(OcTreeNode& node) {
    if (!pruneNode(&node)) node.updateOccupancyChildren();
  }

  // All three return whether the node, or one below it, changed.

  bool update_above_bricks(OcTreeNode& node, bool created, int levels, std::span<const BrickUpdate> bricks) {
    if (levels == 0) {
      corner_ = bricks.front().corner;
      return update_set(node, created, 0, bricks.front().misses, bricks.front().hits);
    }
    if (!created && !nodeHasChildren(&node) &&
        std::all_of(bricks.begin(), bricks.end(), [&](const BrickUpdate& brick) {
          return changes_nothing(node, !empty(brick.misses), !empty(brick.hits));
        }))
      return false;
    const int shift = 3 * (levels - 1);
    bool changed = false;
    while (!bricks.empty()) {
      const std::uint64_t prefix = bricks.front().number >> shift;
      const auto end = std::find_if(bricks.begin(), bricks.end(), [&](const BrickUpdate& brick) {
        return brick.number >> shift != prefix;
      });
      const auto count = static_cast<std::size_t>(end - bricks.begin());
      const auto [child, is_new] = child_to_update(node, created, static_cast<unsigned>(prefix & 7U));
      changed = update_above_bricks(*child, is_new, levels - 1, bricks.first(count)) || is_new || changed;
      bricks = bricks.subspan(count);
    }
    if (changed) follow_children(node);
    return changed;
  }

  // `first`: the number in octree order of the node's first voxel in its brick.
  template <class Set>
  bool update_set(OcTreeNode& node, bool created, unsigned first, const Set& misses, const Set& hits) {
    if (!nodeHasChildren(&node)) {
      if (!created && changes_nothing(node, !empty(misses), !empty(hits))) return false;
      if (full(misses) || full(hits)) return update_leaf(node, created, first, kVoxels<Set>, full(hits));
    }
    bool changed = false;
    for (unsigned i = 0; i < 8; ++i) {
      using Part = decltype(part(misses, i));
      const Part child_misses = part(misses, i), child_hits = part(hits, i);
      if (empty(child_misses) && empty(child_hits)) continue;
      const auto [child, is_new] = child_to_update(node, created, i);
      const unsigned child_first = first + i * kVoxels<Part>;
      bool child_changed = false;
      if constexpr (std::is_same_v<Part, bool>)
        child_changed = update_leaf(*child, is_new, child_first, 1, child_hits);
      else
        child_changed = update_set(*child, is_new, child_first, child_misses, child_hits);
      changed = changed || child_changed || is_new;
    }
    if (changed) follow_children(node);
    return changed;
  }

  bool update_leaf(OcTreeNode& node, bool created, unsigned first, unsigned voxels, bool hit) {
    const float before = node.getLogOdds(), after = updated(before, hit);
    const bool was_occupied = isNodeOccupied(node);
    node.setLogOdds(after);
    if (created || was_occupied != isNodeOccupied(node))
      for (unsigned i = first; i < first + voxels; ++i) {
        const VoxelKey at = detail::in_brick(i);
        const auto along = [](std::uint16_t a, std::uint16_t b) { return static_cast<std::uint16_t>(a + b); };
        changes_->push_back({{along(corner_.x, at.x), along(corner_.y, at.y), along(corner_.z, at.z)},
                             isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree});
      }
    return created || after != before;
  }

  VoxelKey corner_;                         // of the brick at work
  std::vector<Change>* changes_ = nullptr;  // of the update at work
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_length(const char* name, double length) {
  if (!(std::isfinite(length) && length >= 0.0))
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(length) +
                                " m, but has to be finite and not negative");
}

std::string shortest(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

}  // namespace

struct Mapping::State {
  ScanTree tree;
  VoxelGrid grid;
  KeyBox bounds;
  double surface_depth;
  InsertionTime time{};
  std::vector<detail::RayEnd> rays{};  // kept for their memory
  std::vector<Change> changes{};
  std::vector<VoxelKey> keys{};  // of the last change

  explicit State(const MappingOptions& options)
      : tree(options.resolution),
        grid(options.resolution),
        bounds(options.bounds),
        surface_depth(options.surface_depth) {}

  void add_ray(const Eigen::Vector3f& end, bool hit) {
    const auto key = grid.lattice().key(end);
    rays.push_back({end, key.value_or(VoxelKey{}), key.has_value(), hit});
  }

  MapChange insert_rays(const Eigen::Vector3f& origin) {
    const auto start = std::chrono::steady_clock::now();
    const auto updates = detail::voxels_of_scan(grid.lattice(), bounds, origin, rays);
    time.rays = seconds_since(start);
    const auto before_tree = std::chrono::steady_clock::now();
    tree.update(updates, changes);
    time.tree = seconds_since(before_tree);
    return write_to_grid();
  }

  MapChange write_to_grid() {
    const auto start = std::chrono::steady_clock::now();
    keys.clear();
    for (const auto& [key, state] : changes) {
      grid.set(key, state);
      keys.push_back(key);
    }
    changes.clear();
    std::sort(keys.begin(), keys.end());
    time.mirror = seconds_since(start);
    return {grid, keys};
  }

  // Voxels of the box whose centre is inside the shape.
  template <class Inside>
  MapChange mark_free(const Eigen::AlignedBox3d& box, const Inside& inside) {
    const auto clipped = [&](const Eigen::Vector3d& corner, std::size_t axis) {
      const double cell =
          std::floor(corner[static_cast<Eigen::Index>(axis)] / grid.resolution()) + Lattice::kOrigin;
      return static_cast<int>(std::clamp(cell, -1.0, static_cast<double>(Lattice::kKeysPerAxis)));
    };
    const auto first = [&](std::size_t axis, std::uint16_t bound) {
      return std::max(clipped(box.min(), axis) - 1, static_cast<int>(bound));
    };
    const auto last = [&](std::size_t axis, std::uint16_t bound) {
      return std::min(clipped(box.max(), axis) + 1, static_cast<int>(bound));
    };
    const auto key = [](int k) { return static_cast<std::uint16_t>(k); };
    for (int x = first(0, bounds.min.x); x <= last(0, bounds.max.x); ++x)
      for (int y = first(1, bounds.min.y); y <= last(1, bounds.max.y); ++y)
        for (int z = first(2, bounds.min.z); z <= last(2, bounds.max.z); ++z) {
          const Lattice& lattice = grid.lattice();
          if (inside(Eigen::Vector3d(lattice.center(key(x)), lattice.center(key(y)), lattice.center(key(z)))))
            tree.set_free({key(x), key(y), key(z)}, changes);
        }
    return write_to_grid();
  }
};

Mapping::Mapping(const MappingOptions& options) {
  check_length("surface_depth", options.surface_depth);
  const auto& [min, max] = options.bounds;
  if (min.x > max.x || min.y > max.y || min.z > max.z)
    throw std::invalid_argument(
        "the bounds of the map hold no voxel: their lowest key lies above their highest");
  static_cast<void>(Lattice(options.resolution));  // refuses what is no length before OctoMap sees it
  state_ = std::make_unique<State>(options);
}
Mapping::~Mapping() = default;
Mapping::Mapping(Mapping&&) noexcept = default;
Mapping& Mapping::operator=(Mapping&&) noexcept = default;

MapChange Mapping::insert(const Scan& scan) {
  check(scan);
  if (!state_->grid.lattice().key(scan.origin))
    throw std::invalid_argument("the scan begins outside the key range of the map");
  state_->rays.clear();
  const auto depth = static_cast<float>(state_->surface_depth),
             max_range = static_cast<float>(scan.max_range);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const float range = scan.ranges[i];
    if (std::isnan(range)) continue;
    const bool hit = std::isfinite(range);
    state_->add_ray(scan.origin + scan.directions[i] * (hit ? range + depth : max_range), hit);
  }
  return state_->insert_rays(scan.origin);
}

MapChange Mapping::insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points,
                          double max_range) {
  if (!state_->grid.lattice().key(origin))
    throw std::invalid_argument("the scan begins outside the key range of the map");
  if (!(max_range > 0.0))
    throw std::invalid_argument("max_range is " + std::to_string(max_range) + " m, but has to be above 0");
  state_->rays.clear();
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3f way = point - origin;
    const double distance = detail::octomap_norm(way);
    if (distance <= max_range)
      state_->add_ray(point, true);
    else  // as OctoMap shortens it
      state_->add_ray(origin + (way / static_cast<float>(distance)) * static_cast<float>(max_range), false);
  }
  return state_->insert_rays(origin);
}

namespace {
constexpr double kOnSurface = 1e-9;  // [m] a centre that lies on the surface is inside, whatever the rounding
}

MapChange Mapping::mark_free(const Eigen::AlignedBox3d& box) {
  if (!box.min().allFinite() || !box.max().allFinite() || box.isEmpty())
    throw std::invalid_argument("the box to mark free is empty or not finite");
  return state_->mark_free(box, [&](const Eigen::Vector3d& center) {
    return box.squaredExteriorDistance(center) <= kOnSurface * kOnSurface;
  });
}

MapChange Mapping::mark_free(const Ball& ball) {
  check_length("the radius of the ball", ball.radius);
  if (!ball.center.allFinite())
    throw std::invalid_argument("the centre of the ball to mark free is not finite");
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(ball.radius);
  return state_->mark_free({ball.center - reach, ball.center + reach}, [&](const Eigen::Vector3d& center) {
    return (center - ball.center).norm() <= ball.radius + kOnSurface;
  });
}

MapChange Mapping::mark_free(const Cylinder& cylinder) {
  check_length("the radius of the cylinder", cylinder.radius);
  check_length("the height of the cylinder", cylinder.height);
  if (!cylinder.bottom.allFinite())
    throw std::invalid_argument("the bottom of the cylinder to mark free is not finite");
  const Eigen::Vector3d reach(cylinder.radius, cylinder.radius, 0.0), up(0.0, 0.0, cylinder.height);
  return state_->mark_free(
      {cylinder.bottom - reach, cylinder.bottom + reach + up}, [&](const Eigen::Vector3d& center) {
        const Eigen::Vector3d from_bottom = center - cylinder.bottom;
        return from_bottom.head<2>().norm() <= cylinder.radius + kOnSurface &&
               from_bottom.z() >= -kOnSurface && from_bottom.z() <= cylinder.height + kOnSurface;
      });
}

MapChange Mapping::mark_free(std::span<const VoxelKey> voxels) {
  for (const VoxelKey& key : voxels)
    if (state_->bounds.contains(key)) state_->tree.set_free(key, state_->changes);
  return state_->write_to_grid();
}

const octomap::OcTree& Mapping::tree() const { return state_->tree; }
const VoxelGrid& Mapping::grid() const { return state_->grid; }
const KeyBox& Mapping::bounds() const { return state_->bounds; }
const InsertionTime& Mapping::insertion_time() const { return state_->time; }

// The headers are our own: OctoMap's functions for whole files and trees report on stderr, and round the
// resolution.
void Mapping::write(const std::filesystem::path& file) const {
  const bool binary = file.extension() == ".bt";
  if (!binary && file.extension() != ".ot")
    throw std::invalid_argument(file.string() + ": a map's file name ends in .bt or .ot");
  const auto write_tree = [&](const octomap::OcTree& tree) {
    write_file(file, [&](std::ostream& out) {
      out << (binary ? "# Octomap OcTree binary file" : "# Octomap OcTree file") << "\nid "
          << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << shortest(tree.getResolution())
          << "\ndata\n";
      if (tree.size() == 0) return;
      binary ? tree.writeBinaryNode(out, tree.getRoot()) : tree.writeData(out);
    });
  };
  if (!binary) return write_tree(state_->tree);
  // Voxels that differ in their probability only are one leaf in such a file.
  octomap::OcTree likely(state_->tree);
  likely.toMaxLikelihood();
  likely.prune();
  write_tree(likely);
}

}  // namespace frontlux::planner
