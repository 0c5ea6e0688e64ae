#include "walk/path_count.hpp"

#include "walk/grid_path.hpp"

namespace frontlux::detail {
namespace {

int sum(const std::array<int, 3>& steps) { return steps[0] + steps[1] + steps[2]; }

// Edge of the largest node of one state that holds a voxel, given that its tile is of one.
int log2_of_uniform_cube(const VoxelGrid& grid, const VoxelKey& key) {
  const auto& sector = grid.storage()->child(key);
  if (uniform_state(sector)) return Sector::kLog2;
  return uniform_state(sector->child(key)) ? Region::kLog2 : Tile::kLog2;
}

// Keeps the addresses of the uniform tiles, since every path needs them several times.
bool is_uniform_tile(const Tile& tile) {
  static const std::array<const Tile*, 3> kTiles = {&*uniform_node<Tile>(Occupancy::kUnknown),
                                                    &*uniform_node<Tile>(Occupancy::kFree),
                                                    &*uniform_node<Tile>(Occupancy::kOccupied)};
  return &tile == kTiles[0] || &tile == kTiles[1] || &tile == kTiles[2];
}

bool in_one_cube(const VoxelKey& a, const VoxelKey& b, int log2_edge) {
  return (((a.x ^ b.x) | (a.y ^ b.y) | (a.z ^ b.z)) >> log2_edge) == 0;
}

// What ends a path, beside blockers: a range, or a target.
struct RangeLimit {
  const Lattice& lattice;
  const Ray& ray;
  double matters_from;  // no voxel entered before this time is out of range
  [[nodiscard]] bool excludes(double time, const GridPath<double>& path) const {
    return time >= matters_from && out_of_range(ray.origin, lattice.center(path.key()), ray.max_range);
  }
};
template <class Time>
struct Target {
  VoxelKey key;
  Time matters_from = std::numeric_limits<Time>::max();
  [[nodiscard]] bool excludes(Time, const GridPath<Time>&) const { return false; }
};

// Counts along one path. Every step enters one voxel, so the steps taken are the voxels crossed, and only the
// free ones among them must be counted.
template <class Time, class Limit>
class Counter {
 public:
  Counter(const VoxelGrid& grid, UnknownPolicy unknown, const Limit& limit)
      : grid_(grid), unknown_(unknown), limit_(limit) {}

  // The first voxel counts, whatever its state.
  PathCount along(PathState<Time> at) {
    const int steps_allowed = sum(at.steps_left);
    const Occupancy first = grid_.at(at.key);
    free_ = first == Occupancy::kFree ? 1 : 0;
    while (!stop_) {
      if (!skip(at)) walk(at);
    }
    const auto crossed = static_cast<std::uint32_t>(steps_allowed - sum(at.steps_left));
    const std::uint32_t occupied = first == Occupancy::kOccupied ? 1 : 0;
    return {crossed - free_ - occupied, free_, occupied, *stop_};
  }

 private:
  static constexpr bool kHasTarget = std::is_same_v<Limit, Target<Time>>;
  static constexpr RayStop kOverstepped = kHasTarget ? RayStop::kOutOfRange : RayStop::kLeftMap;

  // Voxel by voxel to the end or into the next tile that can be skipped.
  void walk(PathState<Time>& at) {
    GridPath<Time> path(grid_, unknown_, at.key, at.line, at.steps_left);
    std::uint32_t free = free_;
    while (true) {
      const Time t = path.advance();
      if constexpr (kHasTarget) {
        if (path.exhausted()) {
          stop_ = RayStop::kReached;
          break;
        }
      }
      if (path.overstepped()) {
        stop_ = kOverstepped;
        break;
      }
      const bool other_tile = path.fetch_brick();
      if (limit_.excludes(t, path)) {
        stop_ = RayStop::kOutOfRange;
        break;
      }
      if (path.blocked()) {
        stop_ = stop_in(path.state());
        break;
      }
      free += path.free() ? 1 : 0;
      if (other_tile && is_uniform_tile(path.tile())) {
        at.key = path.key();
        at.line = path.line();
        break;
      }
    }
    free_ = free;
    at.steps_left = path.steps_left();
  }

  // Through a cube of one state at once, into the first voxel outside it.
  bool skip(PathState<Time>& at) {
    if (!is_uniform_tile(grid_.tile(at.key))) return false;
    int log2_edge = log2_of_uniform_cube(grid_, at.key);
    if constexpr (kHasTarget)
      while (log2_edge >= Tile::kLog2 && in_one_cube(at.key, limit_.key, log2_edge)) log2_edge -= 3;
    if (log2_edge < Tile::kLog2) return false;
    const Occupancy state = grid_.at(at.key);
    if (blocks(state, unknown_)) return false;  // a segment may begin in a blocker
    const int steps_before = sum(at.steps_left);
    const CubeSkip skipped = skip_cube(at, log2_edge, limit_.matters_from);
    if (skipped == CubeSkip::kNone) return false;
    if (state == Occupancy::kFree) free_ += static_cast<std::uint32_t>(steps_before - sum(at.steps_left) - 1);
    if (skipped == CubeSkip::kOverstep)
      stop_ = kOverstepped;
    else
      arrive(at);
    return true;
  }

  void arrive(const PathState<Time>& at) {
    if constexpr (kHasTarget) {
      if (at.key == limit_.key) {
        stop_ = RayStop::kReached;
        return;
      }
    }
    const Occupancy state = grid_.at(at.key);
    if (blocks(state, unknown_))
      stop_ = stop_in(state);
    else
      free_ += state == Occupancy::kFree ? 1 : 0;
  }

  const VoxelGrid& grid_;
  UnknownPolicy unknown_;
  const Limit& limit_;
  std::uint32_t free_ = 0;
  std::optional<RayStop> stop_;
};

}  // namespace

PathCount count_path(const VoxelGrid& grid, const Ray& ray, UnknownPolicy unknown) {
  const Lattice& lattice = grid.lattice();
  const auto start = lattice.key(ray.origin);
  if (!start) return {};
  const Occupancy state = grid.at(*start);
  if (blocks(state, unknown)) return {0, 0, 0, stop_in(state)};
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  const auto start_of_path = path_along(lattice, ray.origin, *start, direction);
  if (!start_of_path) return {};
  const RangeLimit limit{lattice, ray, time_surely_in_range(ray.max_range, lattice.resolution(), direction)};
  return Counter<double, RangeLimit>(grid, unknown, limit).along(*start_of_path);
}

PathCount count_path(const VoxelGrid& grid, const Segment& segment, UnknownPolicy unknown) {
  const auto from = grid.lattice().key(segment.from), to = grid.lattice().key(segment.to);
  if (!from || !to) return {};
  if (*from == *to) return {0, 0, 0, RayStop::kReached};
  const auto start_of_path = path_between(grid.lattice(), segment, *from, *to);
  if (!start_of_path) return {};
  const Target<double> target{*to};
  return Counter<double, Target<double>>(grid, unknown, target).along(*start_of_path);
}

PathCount count_path(const VoxelGrid& grid, const KeySegment& segment, UnknownPolicy unknown) {
  if (segment.from == segment.to) return {0, 0, 0, RayStop::kReached};
  const Target<std::int64_t> target{segment.to};
  return Counter<std::int64_t, Target<std::int64_t>>(grid, unknown, target).along(path_between(segment));
}

}  // namespace frontlux::detail
