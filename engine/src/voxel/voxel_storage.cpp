#include <frontlux/voxel_storage.hpp>

#include <algorithm>

namespace frontlux::detail {
namespace {

Brick uniform_brick(Occupancy state) {
  Brick brick;
  if (state == Occupancy::kFree) brick.free.fill(~std::uint64_t{0});
  if (state == Occupancy::kOccupied) brick.occupied.fill(~std::uint64_t{0});
  return brick;
}

// Calls visit(index) for the children that an aligned cube covers, where children have edge 2^child_log2.
template <int kChildLog2, int kBits, class Visit>
void for_each_covered_child(const VoxelKey& corner, int log2_edge, const Visit& visit) {
  const int side = 1 << (log2_edge - kChildLog2);
  const int first = child_index<kChildLog2, kBits>(corner);
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) visit(first + (z << (2 * kBits)) + (y << kBits) + x);
}

void fill_voxels(Brick& brick, const VoxelKey& corner, int log2_edge, Occupancy state) {
  const int side = 1 << log2_edge;
  const std::uint64_t row = (std::uint64_t{1} << side) - 1;
  std::uint64_t square = 0;
  for (int y = 0; y < side; ++y) square |= row << (8 * y);
  square <<= Brick::bit(corner);
  for (int z = corner.z & 7; z < (corner.z & 7) + side; ++z) {
    const auto word = static_cast<std::size_t>(z);
    brick.free[word] &= ~square;
    brick.occupied[word] &= ~square;
    if (state == Occupancy::kFree) brick.free[word] |= square;
    if (state == Occupancy::kOccupied) brick.occupied[word] |= square;
  }
}

template <std::size_t kSize>
bool all_are(const std::array<std::uint16_t, kSize>& slots, Occupancy state) {
  return std::all_of(slots.begin(), slots.end(),
                     [&](auto slot) { return slot == static_cast<std::uint16_t>(state); });
}

// The slot in which a new element is kept. Grows by half and not to the double: among voxels far apart most
// nodes keep a single one beside the uniform ones.
// @param most  elements that there can be
template <class Element>
std::uint16_t take(std::vector<Element>& elements, std::vector<std::uint16_t>& unused, std::size_t most,
                   const Element& element) {
  if (unused.empty()) {
    if (elements.size() == elements.capacity())
      elements.reserve(std::min(elements.size() + elements.size() / 2, most));
    elements.push_back(element);
    return static_cast<std::uint16_t>(elements.size() - 1);
  }
  const std::uint16_t slot = unused.back();
  unused.pop_back();
  elements[slot] = element;
  return slot;
}

}  // namespace

Tile::Tile(Occupancy state) {
  slots.fill(static_cast<std::uint16_t>(state));
  for (const Occupancy s : kStates) bricks.push_back(uniform_brick(s));
}

bool Tile::uniform(Occupancy state) const { return all_are(slots, state); }

bool Tile::fill(const VoxelKey& corner, int log2_edge, Occupancy state) {
  const auto uniform_slot = static_cast<std::uint16_t>(state);
  const auto release = [&](std::uint16_t& slot) {
    if (slot >= kStates.size()) unused.push_back(slot);
    slot = uniform_slot;
  };
  if (log2_edge >= Brick::kLog2) {
    for_each_covered_child<Brick::kLog2, 3>(corner, log2_edge,
                                            [&](int i) { release(slots[static_cast<std::size_t>(i)]); });
    return uniform(state);
  }
  std::uint16_t& slot = slots[static_cast<std::size_t>(index(corner))];
  if (slot == uniform_slot) return uniform(state);
  if (slot < kStates.size()) {
    const Brick before = bricks[slot];
    slot = take(bricks, unused, slots.size() + kStates.size(), before);
  }
  fill_voxels(bricks[slot], corner, log2_edge, state);
  if (bricks[slot] != bricks[uniform_slot]) return false;
  release(slot);
  return uniform(state);
}

template <class Child, int kBits>
Branch<Child, kBits>::Branch(Occupancy state) {
  slots.fill(static_cast<std::uint16_t>(state));
  for (const Occupancy s : kStates) nodes.push_back(uniform_node<Child>(s));
}

template <class Child, int kBits>
bool Branch<Child, kBits>::uniform(Occupancy state) const {
  return all_are(slots, state);
}

template <class Child, int kBits>
bool Branch<Child, kBits>::fill(const VoxelKey& corner, int log2_edge, Occupancy state) {
  const auto uniform_slot = static_cast<std::uint16_t>(state);
  const auto release = [&](std::uint16_t& slot) {
    if (slot >= kStates.size()) {
      nodes[slot] = nodes[uniform_slot];
      unused.push_back(slot);
    }
    slot = uniform_slot;
  };
  if (log2_edge >= Child::kLog2) {
    for_each_covered_child<Child::kLog2, kBits>(
        corner, log2_edge, [&](int number) { release(slots[static_cast<std::size_t>(number)]); });
    return uniform(state);
  }
  std::uint16_t& slot = slots[static_cast<std::size_t>(index(corner))];
  if (slot == uniform_slot) return false;
  if (slot < kStates.size()) {
    const Shared<Child> before = nodes[slot];
    slot = take(nodes, unused, slots.size() + kStates.size(), before);
  }
  if (!nodes[slot].own().fill(corner, log2_edge, state)) return false;
  release(slot);
  return uniform(state);
}

template <class Node>
const Shared<Node>& uniform_node(Occupancy state) {
  // Never destroyed, so that grids may outlive every other static object.
  static const auto* const nodes = new std::array<Shared<Node>, 3>{
      Shared<Node>(Node(kStates[0])), Shared<Node>(Node(kStates[1])), Shared<Node>(Node(kStates[2]))};
  return (*nodes)[static_cast<std::size_t>(state)];
}

template const Shared<Tile>& uniform_node<Tile>(Occupancy);
template const Shared<Region>& uniform_node<Region>(Occupancy);
template const Shared<Sector>& uniform_node<Sector>(Occupancy);
template const Shared<World>& uniform_node<World>(Occupancy);
template struct Branch<Tile, 3>;
template struct Branch<Region, 3>;
template struct Branch<Sector, 4>;

}  // namespace frontlux::detail
