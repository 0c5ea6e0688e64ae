#pragma once

#include "isa/instruction_set.hpp"
#include "packet/open_voxels.hpp"
#include "packet/single_walk.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// castRay's traversal for many rays at a time, a ray to a lane of the processor's vector unit, through a
/// table of open voxels. Time is a whole number of 32 bits. Between voxel centres it is exact (`Crossings`).
/// Along castRay's rays it is rounded, and a ray that comes so close to an edge that rounding might have
/// changed its path is told from the others (docs/ray_contract.md).
namespace frontlux::detail {

/// Most lines that are walked in one call.
inline constexpr std::size_t kMaxLines = 256;

template <class T>
using PerLine = std::array<T, kMaxLines>;
template <class T>
using PerAxisAndLine = std::array<PerLine<T>, 3>;

/// Lines waiting for a lane, as arrays: the crossings of each, and where it starts and ends.
struct PacketLines {
  std::size_t size = 0;
  alignas(64) PerAxisAndLine<std::int32_t> t_max, t_delta;
  /// Steps in a unit of time, or a little more: one in `t_delta`.
  alignas(64) PerAxisAndLine<float> rate;
  /// The number of steps to the line's end. Rays end by time, `kEndOfTime`, and have none.
  alignas(64) PerLine<std::int32_t> steps;
  /// Of the voxel where it starts, in the table's layout, flipped so that every step adds.
  alignas(64) PerLine<std::uint32_t> index;
  /// The bits of all axes along which the line descends.
  alignas(64) PerLine<std::uint32_t> flip;
  /// Lanes are filled from whole registers, which may reach beyond the last line.
  std::array<std::uint32_t, 16> unused;
};

/// Where the walk of a ray ended: the table's index of the closed voxel that stopped it, or one of these.
enum WalkEnd : std::uint32_t {
  kWentThrough = ~0U,     ///< nothing stopped it within `walked_length`, and where it ends could not be told
  kTooCloseToTell = ~1U,  ///< it passed an edge closer than the rounding of times
  kNeverStarted = ~2U,    ///< it does not start in an open voxel of the table, or has no unit direction
  kFreeEnd = ~3U,         ///< nothing stopped it before its first voxel out of range, where it ends
  kFirstWalkEnd = kFreeEnd
};

/// Whether the range of a ray holds the centre of the voxel that stopped it.
enum InRange : std::uint8_t {
  kOutOfRange,
  kInRange,       ///< and those of all voxels before it
  kCloseToLimit,  ///< it does, but a voxel before it may be out of range
};

/// Rays and what comes of them, as arrays. What the walk of a ray found is of use only if it was stopped, or
/// has a free end.
struct RayBatch {
  std::size_t size = 0;
  alignas(64) PerAxisAndLine<float> origin;     ///< [m]
  alignas(64) PerAxisAndLine<float> direction;  ///< as `normalized_as_octomap` returns it
  alignas(64) PerLine<double> max_range;        ///< [m]

  alignas(64) PerLine<std::uint32_t> stopped_at;  ///< an index or a `WalkEnd`
  alignas(64) PerAxisAndLine<std::int32_t> cell;  ///< of the voxel, from key 0; may lie outside the key range
  alignas(64) PerAxisAndLine<float> end;          ///< [m] its centre
  alignas(64) PerAxisAndLine<float> entry;        ///< [m] where the ray enters it
  alignas(64) PerLine<float> distance;            ///< [m] from the origin to there
  alignas(64) PerLine<std::uint8_t> in_range;     ///< an `InRange`, of those that a voxel stopped
};

/// How far rays are walked [voxels]. This is where a BVH becomes about as fast (docs/benchmarking.md); times
/// of longer ones would be too coarse.
inline constexpr double kLongestWalk = 400.0;
/// How far a ray is walked [m]: further than any voxel in its range reaches, if that is not too far. A voxel
/// in range is entered before the range plus half a voxel's diagonal, and left before another diagonal.
[[nodiscard]] inline double walked_length(double max_range, double resolution) {
  const double longest = kLongestWalk * resolution, length = max_range + 3.0 * resolution;
  return max_range > 0.0 && length < longest ? length : longest;
}
/// Whether it is walked as far as it may go.
[[nodiscard]] inline bool is_walked_whole(double max_range, double resolution) {
  return walked_length(max_range, resolution) < kLongestWalk * resolution;
}

/// The walks of one instruction set.
struct PacketWalk {
  InstructionSet needs;

  /// `RayCaster::visible` between voxel centres, of at most `kMaxLines` segments.
  /// @param ends_in  where they may end; they begin where the table `contains` them
  /// @param left     gets the numbers of those not answered, in order: they lie elsewhere, are longer than
  ///                 `kMaxOffset` along an axis, or lie in one voxel
  /// @return how many these are
  std::size_t (*segments)(const OpenVoxels& table, const KeyBox& ends_in,
                          std::span<const KeySegment> segments, std::uint8_t* visible, std::uint16_t* left);
  static constexpr int kMaxOffset = 1000;  // (2 n + 1) dy dz has to fit into 31 bits

  /// Walks at most `kMaxLines` rays until a voxel stops them or they have gone `walked_length`, and tells
  /// where those end that nothing stops in their range.
  void (*rays)(const Lattice& lattice, const OpenVoxels& table, std::span<const Ray> rays, RayBatch& batch);

  /// Walks one of them.
  LoneWalk (*alone)(const Lattice& lattice, const OpenVoxels& table, const Ray& ray);
};

/// Those that may run, the widest first.
[[nodiscard]] std::span<const PacketWalk> packet_walks();
/// The widest.
[[nodiscard]] inline const PacketWalk& packet_walk() { return packet_walks().front(); }

}  // namespace frontlux::detail
