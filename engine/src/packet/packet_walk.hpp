#pragma once

#include "isa/instruction_set.hpp"
#include "packet/open_voxels.hpp"

#include <frontlux/ray.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

/// castRay's traversal for many rays at a time, a ray to a lane of the processor's vector unit, through a
/// table of open voxels. Each lane does what `Crossings` and `GridPath` do, operation by operation, so its
/// path is theirs to the last voxel; only the look-ups differ.
namespace frontlux::detail {

/// Lines waiting for a lane, as arrays: `Crossings<Time>` of each, and where it starts and ends.
template <class Time>
struct PacketLines {
  static constexpr std::size_t kMaxSize = 256;
  using Index = std::conditional_t<sizeof(Time) == 8, std::uint64_t, std::uint32_t>;

  std::size_t size = 0;
  alignas(64) std::array<std::array<Time, kMaxSize>, 3> t_max, t_delta;
  /// The last time at which a step is taken; for whole numbers the number of steps.
  alignas(64) std::array<Time, kMaxSize> end;
  /// Of the voxel where it starts, in the table's layout, flipped so that every step adds.
  alignas(64) std::array<Index, kMaxSize> index;
  /// The bits of all axes along which the line descends.
  alignas(64) std::array<Index, kMaxSize> flip;
};

/// The walks of one instruction set.
struct PacketWalk {
  InstructionSet needs;

  /// `RayCaster::visible` between voxel centres. Ends lie in the table, at most `kMaxOffset` apart along each
  /// axis and not in one voxel; at most `PacketLines::kMaxSize` of them.
  void (*segments)(const OpenVoxels& table, const KeySegment* segments, std::size_t size,
                   std::uint8_t* visible);
  static constexpr int kMaxOffset = 1000;  // (2 n + 1) dy dz has to fit into 31 bits

  /// For each line the table's index of the closed voxel that stopped it, or `kWentThrough` if it ended
  /// before.
  void (*rays)(const OpenVoxels& table, const PacketLines<double>& lines, std::uint32_t* stopped_at);
  static constexpr std::uint32_t kWentThrough = ~std::uint32_t{0};
};

/// Those that may run, the widest first.
[[nodiscard]] std::span<const PacketWalk> packet_walks();
/// The widest.
[[nodiscard]] inline const PacketWalk& packet_walk() { return packet_walks().front(); }

}  // namespace frontlux::detail
