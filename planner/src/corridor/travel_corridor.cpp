#include "corridor/erosion.hpp"
#include "corridor/path_distances.hpp"
#include "corridor/path_search.hpp"
#include "corridor/terrain.hpp"
#include "corridor/whole_voxels.hpp"
#include "mapping/sort_once.hpp"

#include <frontlux/planner/body_stencil.hpp>
#include <frontlux/planner/travel_corridor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::gap_width, detail::ground_extents, detail::half_width, detail::kMaxWindow, detail::kSlack,
    detail::layers_below, detail::reached_from_below, detail::voxels_in;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSteepest = 80.0 * kDegree;
constexpr int kNearby = 40;  // [cells] along each axis
constexpr std::uint64_t kMaxCells = std::uint64_t{1} << 29;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("travel corridor: " + what); }

void check_ground(const TravelOptions& options, double resolution) {
  if (!(options.step <= kMaxWindow * resolution && voxels_in(options.step, resolution) >= 1))
    refuse("step is " + std::to_string(options.step) + " m, but has to be from a voxel, " +
           std::to_string(resolution) + " m, to " + std::to_string(kMaxWindow) +
           " of them: what is lower than a voxel cannot be told from flat floor; use smaller voxels, or let "
           "it take higher steps");
  if (!(options.slope >= 0.0 && options.slope <= kSteepest))
    refuse("slope is " + std::to_string(options.slope) + " rad, but has to be from 0 to " +
           std::to_string(kSteepest) + " rad");
  if (options.ground_intrusion() > std::min(options.sensor_height, options.extents.z()))
    refuse("steps and slopes would reach " + std::to_string(options.ground_intrusion()) +
           " m up, above the sensor or all of the body");
}

void check(const TravelOptions& options, double resolution, const KeyBox& bounds) {
  const auto size = [&](const char* name, double value, double low) {
    if (!(value >= low && value / resolution <= kMaxWindow))
      refuse(std::string(name) + " is " + std::to_string(value) + " m, but has to be from " +
             std::to_string(low) + " m to " + std::to_string(kMaxWindow) + " voxels of " +
             std::to_string(resolution) + " m");
  };
  constexpr double kSmallest = 1e-6;
  for (const auto& [name, i] : {std::pair{"extents.x", 0}, {"extents.y", 1}, {"extents.z", 2}})
    size(name, options.extents[i], kSmallest);
  size("margin", options.margin, 0.0);
  if (options.drives()) {
    size("sensor_height", options.sensor_height, 0.0);
    if (options.ground_extents) {
      size("ground_extents.x", options.ground_extents->x(), kSmallest);
      size("ground_extents.y", options.ground_extents->y(), kSmallest);
    }
    if (options.ground_reach < 0 || options.ground_reach > kMaxWindow)
      refuse("ground_reach is " + std::to_string(options.ground_reach) + " voxels, but has to be 0 to " +
             std::to_string(kMaxWindow));
    if (options.node_edge != 0.0)
      refuse("node_edge is for motion in space, and has to be 0 for a robot that drives");
    if (options.motion == Motion::kGround) check_ground(options, resolution);
  } else {
    if (!std::isfinite(options.floor)) refuse("floor is not finite");
    if (!std::isfinite(options.min_height)) refuse("min_height is not finite");
    if (options.node_edge != 0.0) {
      size("node_edge", options.node_edge, 0.0);
      if (options.node_edge < options.extents.maxCoeff())
        refuse("node_edge is " + std::to_string(options.node_edge) + " m, less than the body, " +
               std::to_string(options.extents.maxCoeff()) + " m");
    }
  }
  if (bounds.min.x > bounds.max.x || bounds.min.y > bounds.max.y || bounds.min.z > bounds.max.z)
    refuse("the bounds are empty");
  KeyBox box = bounds;
  if (options.motion == Motion::kPlane) box.max.z = box.min.z;
  if (const std::uint64_t cells = size_of(box); cells > kMaxCells)
    refuse("the bounds hold " + std::to_string(cells) + " cells, but at most " + std::to_string(kMaxCells) +
           " are possible; give smaller bounds");
}

VoxelKey aligned(const TravelOptions& options, const BodyStencil& stencil, const VoxelKey& voxel) {
  if (options.node_edge == 0.0) return voxel;
  const int low = stencil.low()[0], edge = stencil.high()[0] - low + 1;
  const auto along = [&](int key) { return (key & ~(edge - 1)) - low; };
  return make_key(along(voxel.x), along(voxel.y), along(voxel.z));
}

std::uint16_t clamped(int key) { return static_cast<std::uint16_t>(std::clamp(key, 0, 0xFFFF)); }

}  // namespace

VoxelKey cell_of(const TravelOptions& options, const Lattice& lattice, const VoxelKey& voxel) {
  return aligned(options, BodyStencil(options, lattice.resolution()), voxel);
}

KeyBox voxels_of_cell(const TravelOptions& options, const Lattice& lattice, const VoxelKey& cell) {
  return BodyStencil(options, lattice.resolution()).box_around(cell);
}

std::string_view describe(CorridorState state) {
  constexpr std::array<std::string_view, 8> kTexts = {"has a corridor",
                                                      "has no map yet",
                                                      "is outside the bounds",
                                                      "is in a cell below its minimum height",
                                                      "is in an unknown voxel",
                                                      "is in an occupied voxel",
                                                      "needs more space than is known to be free around it",
                                                      "stands where no ground is known"};
  return kTexts.at(static_cast<std::size_t>(state));
}

// What depends on the plane is made again when the robot is on another one; in space it is made once.
struct TravelCorridor::State {
  State(const TravelOptions& options_of_robot, const Lattice& map_lattice, const KeyBox& map_bounds)
      : options(options_of_robot), lattice(map_lattice), bounds(map_bounds) {}

  const TravelOptions options;
  const Lattice lattice;
  const KeyBox bounds;
  const BodyStencil stencil{options, lattice.resolution()};
  const int down = layers_below(options, lattice.resolution()) + 1;  // layers from a cell to its floor

  std::optional<std::uint16_t> plane;
  detail::CellFrame frame;
  std::optional<detail::VoxelColumns> free;
  std::optional<detail::Erosion> erosion;
  std::optional<detail::Terrain> terrain;
  std::optional<detail::PathDistances> distances;  // of all cells, or of those near by
  std::optional<VoxelKey> start;                   // the robot's cell
  std::vector<VoxelKey> found;                     // the path that `find_path` searched last
  CorridorExtent extent = CorridorExtent::kAllCells;
  std::vector<VoxelKey> cells;
  std::vector<VoxelKey> blocked;  // sorted
  std::vector<KeyBox> kept_out;   // of other robots
  CorridorState state = CorridorState::kNotUpdated;

  [[nodiscard]] VoxelKey cell_of(const VoxelKey& voxel) const { return aligned(options, stencil, voxel); }
  void lay_out(const VoxelKey& robot);
  void lay_ground(KeyBox box, const VoxelKey& robot);
  void read(const MapChange& change, const VoxelKey& robot);
  [[nodiscard]] bool needs_ground() const {
    return options.motion == Motion::kGround || (options.motion == Motion::kPlane && options.require_ground);
  }
  [[nodiscard]] bool stands(const VoxelKey& cell) const {
    if (!needs_ground()) return true;
    return terrain && cell.z >= down && terrain->carries(make_key(cell.x, cell.y, cell.z - down));
  }
  [[nodiscard]] bool fits(const VoxelKey& cell) const {
    return erosion->whole(cell) && stands(cell) &&
           (blocked.empty() || !std::binary_search(blocked.begin(), blocked.end(), cell));
  }
  [[nodiscard]] bool passable(const VoxelKey& cell) const {
    return fits(cell) &&
           std::ranges::none_of(kept_out, [&](const KeyBox& box) { return box.contains(cell); });
  }
  void open_own_cell(const VoxelKey& own);
  void open_distances();
  [[nodiscard]] CorridorState find_state(const VoxelGrid& grid, const VoxelKey& robot) const;
};

void TravelCorridor::State::lay_out(const VoxelKey& robot) {
  KeyBox box = bounds;
  KeyBox middles = bounds;  // where the keys of cells may lie
  if (options.motion == Motion::kPlane) {
    plane = robot.z;
    box.min.z = clamped(robot.z + stencil.low()[2]);
    box.max.z = clamped(robot.z + stencil.high()[2]);
    middles.min.z = middles.max.z = robot.z;
  }
  frame.stride = options.node_edge > 0.0 ? stencil.high()[0] - stencil.low()[0] + 1 : 1;
  if (frame.stride > 1) {
    middles.min = cell_of(bounds.min);
    middles.max = cell_of(bounds.max);
  }
  int lowest = middles.min.z;
  if (options.motion == Motion::kSpace) {
    const double part = frame.stride > 1 ? 0.0 : 0.5;  // of a voxel, from its lower face to the cell's centre
    const double height = (options.floor + options.min_height) / lattice.resolution() - part - kSlack;
    const double key = std::clamp(std::ceil(height) + Lattice::kOrigin, -1.0, 2.0 * Lattice::kKeysPerAxis);
    while (lowest < key && lowest <= middles.max.z) lowest += frame.stride;
  }
  frame.first = {middles.min.x, middles.min.y, clamped(lowest)};
  const auto count = [this](int low, int high) { return high < low ? 0 : (high - low) / frame.stride + 1; };
  frame.size = {count(middles.min.x, middles.max.x), count(middles.min.y, middles.max.y),
                count(lowest, middles.max.z)};
  free.emplace(box);
  erosion.emplace(box, stencil);
  distances.reset();
  terrain.reset();
  if (needs_ground()) lay_ground(box, robot);
}

// Floors are numbered as voxels are: that of a cell lies some layers below it.
void TravelCorridor::State::lay_ground(KeyBox box, const VoxelKey& robot) {
  const double resolution = lattice.resolution();
  const Eigen::Vector2d extents = ground_extents(options);
  detail::Terrain::Options ground{.box = box,
                                  .half_x = half_width(extents.x(), resolution),
                                  .half_y = half_width(extents.y(), resolution),
                                  .reach = options.ground_reach,
                                  .gap_width = gap_width(options, resolution),
                                  .exempt = options.without_ground};
  if (options.motion == Motion::kPlane) {
    if (robot.z < down) return;
    ground.box.min.z = ground.box.max.z = clamped(robot.z - down);
  } else {
    ground.above = ground.below = reached_from_below(options, resolution);
    ground.depth = voxels_in(options.step, resolution) - 1;
  }
  for (KeyBox& exempt : ground.exempt) {
    const bool flat = options.motion == Motion::kPlane;
    exempt.min.z = flat ? ground.box.min.z : clamped(exempt.min.z - down);
    exempt.max.z = flat ? ground.box.max.z : clamped(exempt.max.z - down);
  }
  terrain.emplace(std::move(ground));
}

void TravelCorridor::State::read(const MapChange& change, const VoxelKey& robot) {
  const auto& [grid, changed] = change;
  if (!erosion || (options.motion == Motion::kPlane && plane != robot.z)) {
    lay_out(robot);
    free->read(grid, Occupancy::kFree);
    if (terrain) terrain->read(grid);
  } else {
    free->read(grid, Occupancy::kFree, changed);
    if (terrain) terrain->read(grid, changed);
  }
  erosion->erode(*free);
  free->clear_stale();
}

CorridorState TravelCorridor::State::find_state(const VoxelGrid& grid, const VoxelKey& robot) const {
  KeyBox within = bounds;
  if (options.motion == Motion::kPlane) within.min.z = within.max.z = robot.z;
  if (!within.contains(robot)) return CorridorState::kOutside;
  if (grid.at(robot) == Occupancy::kUnknown) return CorridorState::kUnknown;
  if (grid.at(robot) == Occupancy::kOccupied) return CorridorState::kOccupied;
  const VoxelKey cell = cell_of(robot);
  if (!frame.place(cell))
    return cell.z < frame.first.z || frame.size[2] == 0 ? CorridorState::kTooLow : CorridorState::kOutside;
  if (!erosion->whole(cell)) return CorridorState::kBoxNotFree;
  if (std::binary_search(blocked.begin(), blocked.end(), cell)) return CorridorState::kBoxNotFree;
  if (!stands(cell)) return CorridorState::kWithoutGround;
  return CorridorState::kReady;
}

// A robot that is too near to another one may stay there and go away, but come no nearer: of a box around its
// cell there remains what lies beyond the cell, seen from the nearest face.
void TravelCorridor::State::open_own_cell(const VoxelKey& own) {
  const auto opened = [&](KeyBox& box) {
    if (!box.contains(own)) return true;
    std::uint16_t* face = nullptr;
    int nearest = Lattice::kKeysPerAxis, beyond = 0;
    const auto consider = [&](std::uint16_t& limit, int at, int step) {
      if (std::abs(limit - at) >= nearest) return;
      nearest = std::abs(limit - at);
      face = &limit;
      beyond = at + step;
    };
    consider(box.min.x, own.x, 1);
    consider(box.max.x, own.x, -1);
    consider(box.min.y, own.y, 1);
    consider(box.max.y, own.y, -1);
    if (!options.drives()) {
      consider(box.min.z, own.z, 1);
      consider(box.max.z, own.z, -1);
    }
    if (beyond < 0 || beyond >= Lattice::kKeysPerAxis) return false;
    *face = static_cast<std::uint16_t>(beyond);
    return box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z;
  };
  std::erase_if(kept_out, [&](KeyBox& box) { return !opened(box); });
}

// Where ground does not matter, columns of cells at once, and then the few that are closed all the same.
void TravelCorridor::State::open_distances() {
  if (needs_ground() || frame.stride > 1) {
    distances->reset([this](const VoxelKey& cell) { return passable(cell); });
    return;
  }
  distances->reset(erosion->whole());
  for (const VoxelKey& cell : blocked) distances->close(cell);
  if (frame.size[0] == 0 || frame.size[1] == 0 || frame.size[2] == 0) return;
  const KeyBox all{frame.first, frame.key(frame.size[0] - 1, frame.size[1] - 1, frame.size[2] - 1)};
  for (const KeyBox& box : kept_out)
    if (const auto within = intersection(box, all))
      for_each_key(*within, [this](const VoxelKey& cell) { distances->close(cell); });
}

TravelCorridor::TravelCorridor(const TravelOptions& options, const Lattice& lattice, const KeyBox& bounds) {
  check(options, lattice.resolution(), bounds);
  state_ = std::make_unique<State>(options, lattice, bounds);
}
TravelCorridor::~TravelCorridor() = default;
TravelCorridor::TravelCorridor(TravelCorridor&&) noexcept = default;
TravelCorridor& TravelCorridor::operator=(TravelCorridor&&) noexcept = default;

void TravelCorridor::update(const MapChange& change, const VoxelKey& robot, CorridorExtent extent) {
  const VoxelGrid& grid = change.grid;
  if (grid.resolution() != state_->lattice.resolution())
    refuse("the grid has a resolution of " + std::to_string(grid.resolution()) + " m, the corridor " +
           std::to_string(state_->lattice.resolution()) + " m");
  state_->open_own_cell(state_->cell_of(robot));
  state_->read(change, robot);
  state_->state = state_->find_state(grid, robot);
  const bool all = extent == CorridorExtent::kAllCells;
  const bool all_before = std::exchange(state_->extent, extent) == CorridorExtent::kAllCells;
  state_->start = state_->cell_of(robot);
  state_->cells.clear();
  state_->found.clear();
  if (!all || !all_before || !state_->distances)
    state_->distances.emplace(all ? state_->frame : state_->frame.around(*state_->start, kNearby),
                              state_->options.metric);
  state_->open_distances();
  if (state_->state != CorridorState::kReady) return;
  state_->distances->spread(*state_->start);
  if (all) state_->distances->reached(state_->cells);
}

bool TravelCorridor::find_path(const VoxelKey& cell, const std::function<bool(const VoxelKey&)>& through) {
  State& state = *state_;
  state.found.clear();
  if (state.state != CorridorState::kReady) return false;
  if (state.distances->distance(cell)) return true;
  if (state.extent == CorridorExtent::kNearby)
    state.found =
        detail::shortest_path(state.frame, state.options.metric, *state.start, cell,
                              [&](const VoxelKey& key) { return state.passable(key) && through(key); });
  return !state.found.empty();
}

void TravelCorridor::block(std::span<const VoxelKey> cells) {
  std::vector<VoxelKey>& blocked = state_->blocked;
  blocked.insert(blocked.end(), cells.begin(), cells.end());
  detail::sort_once(blocked);
}
std::span<const VoxelKey> TravelCorridor::blocked() const { return state_->blocked; }

void TravelCorridor::keep_out_of(std::vector<KeyBox> boxes) { state_->kept_out = std::move(boxes); }

CorridorState TravelCorridor::state() const { return state_->state; }
CorridorExtent TravelCorridor::extent() const { return state_->extent; }
std::span<const VoxelKey> TravelCorridor::cells() const { return state_->cells; }

std::optional<double> TravelCorridor::distance(const VoxelKey& key) const {
  if (!state_->distances) return std::nullopt;
  const auto cells = state_->distances->distance(key);
  if (!cells) return std::nullopt;
  return *cells * state_->frame.stride * state_->lattice.resolution();
}

std::vector<VoxelKey> TravelCorridor::path_to(const VoxelKey& key) const {
  if (!state_->found.empty() && state_->found.back() == key) return state_->found;
  return state_->distances ? state_->distances->path_to(key) : std::vector<VoxelKey>{};
}

bool TravelCorridor::passable(const VoxelKey& key) const {
  if (!state_->distances) return false;
  if (state_->extent == CorridorExtent::kAllCells) return state_->distances->open(key);
  return state_->frame.place(key) && state_->passable(key);
}

bool TravelCorridor::fits(const VoxelKey& key) const {
  return state_->distances && state_->frame.place(key) && state_->fits(key);
}

Eigen::Vector3d TravelCorridor::place_in(const VoxelKey& cell) const {
  constexpr double kInside = 1e-6;  // [m] of a voxel whose face the sensor is level with
  const TravelOptions& options = state_->options;
  const double edge = state_->lattice.resolution();
  Eigen::Vector3d place = state_->lattice.exact_center(cell);
  if (options.drives()) {
    const double above = options.sensor_height - detail::layers_below(options, edge) * edge;
    place.z() += std::clamp(above, kInside, edge - kInside) - edge / 2;
  }
  return place;
}

const BodyStencil& TravelCorridor::stencil() const { return state_->stencil; }
const Eigen::Vector3d& TravelCorridor::reach() const { return state_->stencil.reach(); }

VoxelKey TravelCorridor::cell_of(const VoxelKey& voxel) const { return state_->cell_of(voxel); }

}  // namespace frontlux::planner
