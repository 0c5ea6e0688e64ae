#include "embree/blocker_boxes.hpp"

#include "embree/unit_boxes.hpp"
#include "walk/walk.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace frontlux::detail {
namespace {

// Calls visit(corner) for the cubes of an edge that make up a larger aligned cube.
template <class Visit>
void for_each_cube(const VoxelKey& corner, int size, int edge, const Visit& visit) {
  for (int z = 0; z < size; z += edge)
    for (int y = 0; y < size; y += edge)
      for (int x = 0; x < size; x += edge) visit(as_key({corner.x + x, corner.y + y, corner.z + z}));
}

// Storage nodes seen by the edge of their children.
const Shared<Sector>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Sector*) {
  return grid.storage()->child(key);
}
const Shared<Region>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Region*) {
  return grid.storage()->child(key)->child(key);
}
const Shared<Tile>& node_at(const VoxelGrid& grid, const VoxelKey& key, const Tile*) {
  return grid.storage()->child(key)->child(key)->child(key);
}

// Finds where the shell can be: in tiles of mixed states, and in whole nodes of blockers beside anything
// else.
class Survey {
 public:
  Survey(const VoxelGrid& grid, UnknownPolicy unknown) : grid_(grid), unknown_(unknown) {
    whole_nodes.log2_cell = Tile::kLog2;
    descend(*grid.storage(), {});
  }

  BoxGroup whole_nodes;
  std::vector<VoxelKey> mixed_tiles;

 private:
  template <class Node>
  [[nodiscard]] bool blocks_everywhere(const Shared<Node>& node) const {
    return node == uniform_node<Node>(Occupancy::kOccupied) ||
           (unknown_ == UnknownPolicy::kBlock && node == uniform_node<Node>(Occupancy::kUnknown));
  }

  // Whether something beside an all-blocking node may be free.
  template <class Node>
  [[nodiscard]] bool is_shell(const VoxelKey& corner) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        auto beside = as_array(corner);
        beside[axis] += side * (1 << Node::kLog2);
        if (beside[axis] < 0 || beside[axis] >= Lattice::kKeysPerAxis) continue;
        if (!blocks_everywhere(node_at(grid_, as_key(beside), static_cast<const Node*>(nullptr))))
          return true;
      }
    return false;
  }

  template <class Node>
  void descend(const Node& node, const VoxelKey& corner) {
    using Child = typename Node::Child;
    for (int i = 0; i < Node::kChildren; ++i) {
      const auto& child = node.child(i);
      const VoxelKey at = child_corner<Child::kLog2, Node::kChildBits>(corner, i);
      if (blocks_everywhere(child)) {
        if (!is_shell<Child>(at)) continue;
        constexpr int kCells = 1 << (Child::kLog2 - Tile::kLog2);
        const std::array first{at.x >> Tile::kLog2, at.y >> Tile::kLog2, at.z >> Tile::kLog2};
        whole_nodes.boxes.push_back(
            pack(first, {first[0] + kCells - 1, first[1] + kCells - 1, first[2] + kCells - 1}));
      } else if (child == uniform_node<Child>(Occupancy::kFree) ||
                 child == uniform_node<Child>(Occupancy::kUnknown)) {
        continue;
      } else if constexpr (std::is_same_v<Child, Tile>) {
        mixed_tiles.push_back(at);
      } else {
        descend(*child, at);
      }
    }
  }

  const VoxelGrid& grid_;
  UnknownPolicy unknown_;
};

// The units at and beside the changes between two grids, by their lower corners; everything after changes of
// large blocks.
class StaleUnits {
 public:
  StaleUnits(const VoxelGrid& before, const VoxelGrid& after) {
    for_each_change(before, after, [&](const Block& block) {
      if (block.log2_edge > Tile::kLog2) {
        everything_ = true;
        return;
      }
      const int edge = 1 << block.log2_edge;
      add({block.corner.x, block.corner.y, block.corner.z}, {edge, edge, edge});
      const auto corner = as_array(block.corner);
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int offset : {-1, edge}) {
          std::array<int, 3> face = corner, size{edge, edge, edge};
          face[axis] += offset;
          size[axis] = 1;
          if (face[axis] >= 0 && face[axis] < Lattice::kKeysPerAxis) add(face, size);
        }
    });
    std::sort(units_.begin(), units_.end());
    units_.erase(std::unique(units_.begin(), units_.end()), units_.end());
  }
  [[nodiscard]] bool everything() const { return everything_; }
  [[nodiscard]] bool contains(const VoxelKey& unit) const {
    return std::binary_search(units_.begin(), units_.end(), unit);
  }
  [[nodiscard]] bool touches(const VoxelKey& group) const {
    bool any = false;
    for_each_cube(group, BoxGroup::kEdge, BoxGroup::kUnitEdge,
                  [&](const VoxelKey& unit) { any = any || contains(unit); });
    return any;
  }

 private:
  void add(const std::array<int, 3>& low, const std::array<int, 3>& size) {
    constexpr int kEdge = BoxGroup::kUnitEdge;
    for (int z = low[2] / kEdge * kEdge; z < low[2] + size[2]; z += kEdge)
      for (int y = low[1] / kEdge * kEdge; y < low[1] + size[1]; y += kEdge)
        for (int x = low[0] / kEdge * kEdge; x < low[0] + size[0]; x += kEdge)
          units_.push_back(as_key({x, y, z}));
  }

  bool everything_ = false;
  std::vector<VoxelKey> units_;  // sorted
};

// Derives bounds and area from a group's boxes.
void finish(BoxGroup& group) {
  group.boxes.shrink_to_fit();
  for (std::size_t i = 0; i < group.boxes.size(); ++i) {
    const KeyBox box = group.box(i);
    group.bounds = i == 0 ? box : hull(group.bounds, box);
    std::array<std::uint64_t, 3> edges{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      edges[axis] = static_cast<std::uint64_t>(as_array(box.max)[axis] - as_array(box.min)[axis] + 1);
    std::sort(edges.begin(), edges.end());
    group.face_area += edges[1] * edges[2];
  }
}

// The boxes of a cube; those of its units that `reusable` has and `stale` does not name are copied.
std::shared_ptr<const BoxGroup> make_group(const VoxelGrid& grid, UnknownPolicy unknown,
                                           const VoxelKey& corner, const BoxGroup* reusable,
                                           const StaleUnits* stale) {
  auto group = std::make_shared<BoxGroup>();
  group->corner = corner;
  group->unit_end.reserve(BoxGroup::kUnits);
  for_each_cube(corner, BoxGroup::kEdge, BoxGroup::kUnitEdge, [&](const VoxelKey& unit) {
    if (reusable != nullptr && !stale->contains(unit)) {
      const std::size_t u = group->unit_end.size();
      const auto begin = reusable->boxes.begin() + (u == 0 ? 0 : reusable->unit_end[u - 1]);
      group->boxes.insert(group->boxes.end(), begin, reusable->boxes.begin() + reusable->unit_end[u]);
    } else {
      append_unit_boxes(grid, unknown, unit, group->boxes);
    }
    group->unit_end.push_back(static_cast<std::uint32_t>(group->boxes.size()));
  });
  finish(*group);
  return group;
}

}  // namespace

KeyBox BoxGroup::box(std::size_t index) const {
  const PackedBox b = boxes[index];
  const int edge = 1 << log2_cell;
  return {make_key(corner.x + first_cell(b, 0) * edge, corner.y + first_cell(b, 1) * edge,
                   corner.z + first_cell(b, 2) * edge),
          make_key(corner.x + (last_cell(b, 0) + 1) * edge - 1, corner.y + (last_cell(b, 1) + 1) * edge - 1,
                   corner.z + (last_cell(b, 2) + 1) * edge - 1)};
}

std::size_t Blockers::box_count() const {
  return std::accumulate(groups.begin(), groups.end(), std::size_t{0},
                         [](std::size_t sum, const auto& group) { return sum + group->boxes.size(); });
}

namespace {

// What was built of an earlier grid.
struct Earlier {
  const Blockers& blockers;
  const VoxelGrid& grid;
  const StaleUnits& stale;

  [[nodiscard]] std::shared_ptr<const BoxGroup> group(const VoxelKey& corner) const {
    const auto found =
        std::lower_bound(blockers.groups.begin() + 1, blockers.groups.end(), corner,
                         [](const auto& group, const VoxelKey& key) { return group->corner < key; });
    return found != blockers.groups.end() && (*found)->corner == corner ? *found : nullptr;
  }
  // Whether it had cubes where this one is: else whole nodes stood for it.
  [[nodiscard]] bool had_cubes(const VoxelKey& corner) const {
    return !uniform_state(node_at(grid, corner, static_cast<const Tile*>(nullptr)));
  }
};

Blockers assemble(const VoxelGrid& grid, UnknownPolicy unknown, const Earlier* earlier) {
  Survey survey(grid, unknown);
  std::vector<VoxelKey> corners;
  for (const VoxelKey& tile : survey.mixed_tiles)
    for_each_cube(tile, 1 << Tile::kLog2, BoxGroup::kEdge,
                  [&](const VoxelKey& corner) { corners.push_back(corner); });
  std::sort(corners.begin(), corners.end());

  Blockers blockers;
  finish(survey.whole_nodes);
  blockers.groups.resize(1 + corners.size());
  blockers.groups[0] = std::make_shared<BoxGroup>(std::move(survey.whole_nodes));
  for_each_chunk(corners.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::shared_ptr<const BoxGroup>& group = blockers.groups[i + 1];
      if (earlier != nullptr) group = earlier->group(corners[i]);
      if (earlier == nullptr || earlier->stale.touches(corners[i]) ||
          (!group && !earlier->had_cubes(corners[i])))
        group = make_group(grid, unknown, corners[i], group.get(), earlier ? &earlier->stale : nullptr);
      if (group && group->boxes.empty()) group.reset();
    }
  });
  std::erase(blockers.groups, nullptr);
  return blockers;
}

}  // namespace

Blockers make_blockers(const VoxelGrid& grid, UnknownPolicy unknown) {
  return assemble(grid, unknown, nullptr);
}

Blockers update_blockers(const Blockers& blockers, const VoxelGrid& before, const VoxelGrid& after,
                         UnknownPolicy unknown) {
  const StaleUnits stale(before, after);
  const Earlier earlier{blockers, before, stale};
  return assemble(after, unknown, stale.everything() ? nullptr : &earlier);
}

}  // namespace frontlux::detail
