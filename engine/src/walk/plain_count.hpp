#pragma once

#include "walk/cube_skip.hpp"
#include "walk/walk.hpp"

#include <frontlux/ray.hpp>

#include <array>
#include <cstdint>

namespace frontlux::detail {

/// Counts step by step, looking up the state of each voxel: how a tree without a grid is counted, and the
/// baseline of `count_path`.
/// @param state_at     the state of a voxel
/// @param in_range     whether the path may enter a voxel
/// @param at_overstep  why the path ends if it takes a step too many: `kLeftMap` for a ray, `kOutOfRange` for
/// a
///                     segment, which also ends where all steps are taken
template <class Time, class StateAt, class InRange>
PathCount count_plainly(const PathState<Time>& start, UnknownPolicy unknown, const StateAt& state_at,
                        const InRange& in_range, RayStop at_overstep) {
  const bool to_target = at_overstep == RayStop::kOutOfRange;
  Crossings<Time> line = start.line;
  std::array<int, 3> key = as_array(start.key), left = start.steps_left;
  std::array<std::uint32_t, 3> crossed{};
  Occupancy state = state_at(start.key);
  const auto ended = [&](RayStop stop) { return PathCount{crossed[0], crossed[1], crossed[2], stop}; };
  while (true) {
    ++crossed[static_cast<std::size_t>(state)];
    const auto& t = line.t_max;
    const std::size_t axis = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);  // rule 5
    if (--left[axis] < 0) return ended(at_overstep);
    if (to_target && left == std::array{0, 0, 0}) return ended(RayStop::kReached);
    key[axis] += line.step[axis];
    line.t_max[axis] += line.t_delta[axis];
    const VoxelKey voxel = as_key(key);
    if (!in_range(voxel)) return ended(RayStop::kOutOfRange);
    state = state_at(voxel);
    if (blocks(state, unknown)) return ended(stop_in(state));
  }
}

}  // namespace frontlux::detail
