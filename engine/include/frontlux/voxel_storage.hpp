#pragma once

#include <frontlux/ray.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

/// The storage behind VoxelGrid: a shallow tree with shared, copy-on-write nodes. Not part of the public
/// interface.
namespace frontlux::detail {

/// A pointer to a shared value, which is copied before one of its owners writes to it.
template <class T>
class Shared {
 public:
  explicit Shared(T value) : block_(new Block{{1}, std::move(value)}) {}
  Shared(const Shared& other) noexcept : block_(other.block_) {
    block_->owners.fetch_add(1, std::memory_order_relaxed);
  }
  Shared(Shared&& other) noexcept : Shared(std::as_const(other)) {}  // never empty, so a move is a copy
  Shared& operator=(Shared other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~Shared() {
    if (block_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete block_;
  }

  const T& operator*() const { return block_->value; }
  const T* operator->() const { return &block_->value; }

  /// The value for writing; copied first if it has other owners.
  T& own() {
    if (block_->owners.load(std::memory_order_acquire) != 1) *this = Shared(block_->value);
    return block_->value;
  }

  /// True if both are one and the same object.
  friend bool operator==(const Shared& a, const Shared& b) { return a.block_ == b.block_; }

 private:
  struct Block {
    std::atomic<std::uint32_t> owners;
    T value;
  };
  Block* block_;
};

/// 8 x 8 x 8 voxels as two bit planes: word z, bit 8 y + x. A voxel in neither plane is unknown.
struct alignas(64) Brick {
  static constexpr int kLog2 = 3;
  std::array<std::uint64_t, 8> free{};
  std::array<std::uint64_t, 8> occupied{};

  [[nodiscard]] static constexpr int bit(const VoxelKey& key) { return (key.y & 7) * 8 + (key.x & 7); }
  [[nodiscard]] Occupancy at(const VoxelKey& key) const {
    const int b = bit(key);
    const std::size_t z = key.z & 7U;
    return static_cast<Occupancy>(((free[z] >> b) & 1U) | (((occupied[z] >> b) & 1U) << 1U));
  }
  friend bool operator==(const Brick&, const Brick&) = default;
};

/// Number of the child, of 2^kBits a side, that holds a key in a node whose children have edge 2^kChildLog2.
template <int kChildLog2, int kBits>
[[nodiscard]] constexpr int child_index(const VoxelKey& key) {
  constexpr int kMask = (1 << kBits) - 1;
  return (((key.z >> kChildLog2) & kMask) << (2 * kBits)) | (((key.y >> kChildLog2) & kMask) << kBits) |
         ((key.x >> kChildLog2) & kMask);
}

/// Corner of the child with number `index` in a node whose children, 2^kBits a side, have edge 2^kChildLog2.
template <int kChildLog2, int kBits>
[[nodiscard]] constexpr VoxelKey child_corner(const VoxelKey& corner, int index) {
  constexpr int kMask = (1 << kBits) - 1;
  const auto along = [](std::uint16_t base, int i) {
    return static_cast<std::uint16_t>(base + (i << kChildLog2));
  };
  return {along(corner.x, index & kMask), along(corner.y, (index >> kBits) & kMask),
          along(corner.z, index >> (2 * kBits))};
}

/// 8 x 8 x 8 bricks. A slot below 3 is that of one of the three uniform bricks, which every tile keeps in
/// front, so that a look-up needs no branch.
struct Tile {
  static constexpr int kLog2 = 6;
  std::array<std::uint16_t, 512> slots{};
  std::vector<Brick> bricks;
  std::vector<std::uint16_t> unused;

  explicit Tile(Occupancy state);

  [[nodiscard]] static constexpr int index(const VoxelKey& key) { return child_index<Brick::kLog2, 3>(key); }
  [[nodiscard]] const Brick& brick(const VoxelKey& key) const {
    return bricks[slots[static_cast<std::size_t>(index(key))]];
  }
  [[nodiscard]] bool uniform(Occupancy state) const;
  bool fill(const VoxelKey& corner, int log2_edge, Occupancy state);
};

/// 2^kBits children a side. Slots are as a tile's: below 3 for the uniform children, which every branch keeps
/// in front. So memory grows with the children that are not uniform, and so does what a copy costs.
template <class ChildNode, int kBits>
struct Branch {
  using Child = ChildNode;
  static constexpr int kChildBits = kBits;
  static constexpr int kLog2 = Child::kLog2 + kBits;
  static constexpr int kChildren = 1 << (3 * kBits);
  std::array<std::uint16_t, static_cast<std::size_t>(kChildren)> slots{};
  std::vector<Shared<Child>> nodes;
  std::vector<std::uint16_t> unused;

  explicit Branch(Occupancy state);

  [[nodiscard]] static constexpr int index(const VoxelKey& key) {
    return child_index<Child::kLog2, kBits>(key);
  }
  [[nodiscard]] const Shared<Child>& child(int number) const {
    return nodes[slots[static_cast<std::size_t>(number)]];
  }
  [[nodiscard]] const Shared<Child>& child(const VoxelKey& key) const { return child(index(key)); }
  [[nodiscard]] bool uniform(Occupancy state) const;
  bool fill(const VoxelKey& corner, int log2_edge, Occupancy state);
};

using Region = Branch<Tile, 3>;    // 512 voxels a side
using Sector = Branch<Region, 3>;  // 4096
using World = Branch<Sector, 4>;   // 65536: the whole key range

inline constexpr std::array kStates = {Occupancy::kUnknown, Occupancy::kFree, Occupancy::kOccupied};

/// The one node of its kind in which every voxel is `state`.
template <class Node>
const Shared<Node>& uniform_node(Occupancy state);

/// The state of all voxels of a node, if it is one of the uniform ones.
template <class Node>
std::optional<Occupancy> uniform_state(const Shared<Node>& node) {
  for (const Occupancy state : kStates)
    if (node == uniform_node<Node>(state)) return state;
  return std::nullopt;
}

extern template const Shared<Tile>& uniform_node<Tile>(Occupancy);
extern template const Shared<Region>& uniform_node<Region>(Occupancy);
extern template const Shared<Sector>& uniform_node<Sector>(Occupancy);
extern template const Shared<World>& uniform_node<World>(Occupancy);

}  // namespace frontlux::detail
