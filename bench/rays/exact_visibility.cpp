#include "rays/exact_visibility.hpp"

#include <frontlux/parallel.hpp>

#include <array>
#include <cstddef>
#include <cstdlib>

namespace frontlux::bench {
namespace {

std::array<int, 3> numbers_of(const VoxelKey& key) { return {key.x, key.y, key.z}; }

bool is_visible(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown) {
  auto at = numbers_of(segment.from);
  const auto end = numbers_of(segment.to);
  std::array<std::int64_t, 3> distance{}, crossed{};
  for (std::size_t axis = 0; axis < 3; ++axis) distance[axis] = std::abs(end[axis] - at[axis]);
  // The time of an axis' next crossing is (2 crossed + 1) / (2 distance).
  const auto is_earlier = [&](std::size_t a, std::size_t b) {
    return (2 * crossed[a] + 1) * distance[b] < (2 * crossed[b] + 1) * distance[a];
  };
  while (true) {
    constexpr std::size_t kNone = 3;
    std::size_t next = kNone;
    for (const std::size_t axis : {2U, 1U, 0U})  // z first of equal times, x last
      if (crossed[axis] < distance[axis] && (next == kNone || is_earlier(axis, next))) next = axis;
    if (next == kNone) return true;
    ++crossed[next];
    at[next] += end[next] > at[next] ? 1 : -1;
    if (at == end) return true;
    const Occupancy state = grid.at(make_key(at[0], at[1], at[2]));
    if (state == Occupancy::kOccupied || (state == Occupancy::kUnknown && unknown == UnknownPolicy::kBlock))
      return false;
  }
}

}  // namespace

void exact_visibility(const VoxelGrid& grid, std::span<const KeySegment> segments,
                      std::span<std::uint8_t> visible, UnknownPolicy unknown) {
  for_each_chunk(segments.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) visible[i] = is_visible(grid, segments[i], unknown) ? 1 : 0;
  });
}

}  // namespace frontlux::bench
